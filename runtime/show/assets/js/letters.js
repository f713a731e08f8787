// Letters on blocks: on top, turned so that the camera reads them upright, and on each side.

const addLetters = (world, model, scene) => {
  if (!scene.letters.length) return { face: () => {} };
  const labels = [...new Set(scene.letters.map(({ label }) => label))];
  const side = Math.ceil(Math.sqrt(labels.length)), cell = 128, canvas = make("canvas");
  canvas.width = canvas.height = side * cell;
  const brush = canvas.getContext("2d");
  brush.fillStyle = "#1d2733";
  brush.font = "bold 104px system-ui, 'DejaVu Sans', sans-serif";
  brush.textAlign = "center";
  brush.textBaseline = "middle";
  labels.forEach((label, i) => brush.fillText(label, (i % side + 0.5) * cell, (Math.floor(i / side) + 0.55) * cell, 120));
  const texture = new T.CanvasTexture(canvas);
  texture.colorSpace = "srgb";
  texture.anisotropy = 4;

  const position = [], normal = [], uv = [], bone = [], index = [], bones = [...model.bones], tops = [];
  const quad = (corners, out, label, follows) => {
    const first = bone.length, i = labels.indexOf(label), u = (i % side) / side, v = 1 - (Math.floor(i / side) + 1) / side;
    corners.forEach((corner, k) => {
      position.push(...corner);
      normal.push(...out);
      uv.push(u + (k === 1 || k === 2 ? 1 : 0) / side, v + (k > 1 ? 1 : 0) / side);
      bone.push(follows);
    });
    index.push(first, first + 1, first + 2, first, first + 2, first + 3);
  };
  for (const { node, label, size: [a, b, c], middle: [x, y, z] } of scene.letters) {
    const own = model.bones[node], top = new T.Bone(), lift = 0.0006, w = 0.45 * Math.min(a, b);
    top.position.set(x, y, z + c / 2 + lift);
    own.add(top);
    tops.push({ bone: top, own });
    bones.push(top);
    quad([[-w, -w, 0], [w, -w, 0], [w, w, 0], [-w, w, 0]], [0, 0, 1], label, bones.length - 1);
    for (let k = 0; k < 4; k++) {
      const turn = k * Math.PI / 2, cos = Math.round(Math.cos(turn)), sin = Math.round(Math.sin(turn));
      const wide = k % 2 ? b : a, out = (k % 2 ? a : b) / 2 + lift, h = 0.45 * Math.min(wide, c), up = c / 2 - h - 0.05 * wide;
      const corner = (u, v) => [x + u * cos + out * sin, y + u * sin - out * cos, z + v];
      quad([corner(-h, up - h), corner(h, up - h), corner(h, up + h), corner(-h, up + h)], [sin, -cos, 0], label, node);
    }
  }
  const geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.Float32BufferAttribute(position, 3));
  geometry.setAttribute("normal", new T.Float32BufferAttribute(normal, 3));
  geometry.setAttribute("uv", new T.Float32BufferAttribute(uv, 2));
  geometry.setIndex(index);
  const material = new T.MeshLambertMaterial({ map: texture, transparent: true, depthWrite: false,
    polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
  const mesh = skinned(geometry, Uint16Array.from(bone), bones, material);
  mesh.receiveShadow = true;
  world.add(mesh);

  const right = new T.Vector3(), inverse = new T.Matrix4();
  const face = (camera) => {
    for (const { bone: top, own } of tops) {
      right.setFromMatrixColumn(camera.matrixWorld, 0).transformDirection(inverse.copy(own.matrixWorld).invert());
      const turn = Math.round(Math.atan2(right.y, right.x) / (Math.PI / 2)) * Math.PI / 2;
      if (Math.abs(top.rotation.z - turn) > 1e-6) top.rotation.z = turn;
      top.updateMatrixWorld(true);
    }
  };
  return { face };
};
