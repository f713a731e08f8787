// The world and the robot: all parts that look alike are one mesh, whose corners follow the node
// that they hang on as skin follows a bone. So a scene is a handful of draw calls, however full.
const T = THREE;

const decoded = (text, Kind) => {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Kind(bytes.buffer);
};

const place = (node, pose) => {
  node.position.set(pose[0], pose[1], pose[2]);
  node.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
};

// A mesh whose corner i follows bone `bone[i]`.
const skinned = (geometry, bone, bones, material) => {
  const index = new Uint16Array(4 * bone.length), weight = new Float32Array(4 * bone.length);
  bone.forEach((b, i) => { index[4 * i] = b; weight[4 * i] = 1; });
  geometry.setAttribute("skinIndex", new T.BufferAttribute(index, 4));
  geometry.setAttribute("skinWeight", new T.BufferAttribute(weight, 4));
  const mesh = new T.SkinnedMesh(geometry, material);
  mesh.bind(new T.Skeleton(bones, bones.map(() => new T.Matrix4())), new T.Matrix4());
  mesh.frustumCulled = false;
  return mesh;
};

const batch = (parts, bones, material) => {
  const pieces = parts.map((part) => ({
    part, points: decoded(part.points, Uint16Array), normals: decoded(part.normals, Int8Array),
    faces: decoded(part.faces, part.wide ? Uint32Array : Uint16Array),
  }));
  const corners = pieces.reduce((sum, { points }) => sum + points.length / 3, 0);
  const indices = pieces.reduce((sum, { faces }) => sum + faces.length, 0);
  const position = new Float32Array(3 * corners), normal = new Float32Array(3 * corners);
  const colours = new Float32Array(3 * corners), bone = new Uint16Array(corners);
  const index = new Uint32Array(indices), colour = new T.Color();
  let done = 0, written = 0;
  for (const { part, points, normals, faces } of pieces) {
    const count = points.length / 3;
    colour.setRGB(...part.colour.map((v) => v / 255), "srgb");
    for (let i = 0; i < points.length; i++) {
      const axis = i % 3;
      position[3 * done + i] = part.box[axis] + part.box[3 + axis] * points[i] / 65535;
      normal[3 * done + i] = normals[i] / 127;
      colours[3 * done + i] = axis === 0 ? colour.r : axis === 1 ? colour.g : colour.b;
    }
    bone.fill(part.node, done, done + count);
    for (let i = 0; i < faces.length; i++) index[written + i] = faces[i] + done;
    done += count;
    written += faces.length;
  }
  const geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.BufferAttribute(position, 3));
  geometry.setAttribute("normal", new T.BufferAttribute(normal, 3));
  geometry.setAttribute("color", new T.BufferAttribute(colours, 3));
  geometry.setIndex(new T.BufferAttribute(index, 1));
  return skinned(geometry, bone, bones, material);
};

// The nodes of a scene, and functions that move them: `pose(t)` puts everything where it is.
const makeModel = (trace, scene, world) => {
  const bones = scene.nodes.map(() => new T.Bone());
  const of = (kind) => Object.fromEntries(scene.nodes.flatMap((node, i) => node.kind === kind ? [[node.name, bones[i]]] : []));
  const links = of("link"), fixed = of("fixed"), byName = of("object");
  const objects = trace.world.objects.map(({ name }) => byName[name]);
  for (const bone of [...bones].filter((_, i) => scene.nodes[i].kind !== "link")) world.add(bone);
  trace.world.fixed.forEach((thing) => { if (fixed[thing.name]) place(fixed[thing.name], thing.pose); });

  const movers = {};
  for (const joint of trace.robot.joints) {
    const origin = new T.Group();
    place(origin, joint.origin);
    origin.add(links[joint.child]);
    links[joint.parent].add(origin);
    movers[joint.name] = { node: links[joint.child], axis: new T.Vector3(...joint.axis), type: joint.type };
  }
  const root = links[trace.robot.root];
  world.add(root);
  const set = (name, value) => {
    const { node, axis, type } = movers[name];
    if (type === "prismatic") node.position.copy(axis).multiplyScalar(value);
    else if (type !== "fixed") node.quaternion.setFromAxisAngle(axis, value);
  };
  for (const [name, value] of Object.entries(trace.robot.fixed_joints)) set(name, value);

  // Values of the finger joints, interpolated in the table of openings.
  const fingers = (opening) => {
    const { openings, finger_values: table } = trace.robot;
    const i = Math.min(last(openings, opening), openings.length - 2);
    if (i < 0) return table[0];
    const share = clamp((opening - openings[i]) / (openings[i + 1] - openings[i] || 1), 0, 1);
    return table[i].map((value, k) => value + share * (table[i + 1][k] - value));
  };
  const poseRobot = (t) => {
    const [x, y, yaw] = at(trace.base, t);
    root.position.set(x, y, 0);
    root.rotation.z = yaw;
    at(trace.joints, t).forEach((value, i) => set(trace.robot.planning_joints[i], value));
    fingers(at(trace.opening, t)[0]).forEach((value, i) => set(trace.robot.finger_joints[i], value));
    root.updateMatrixWorld(true);
  };
  const carry = (spans, node, t) => {
    const stretch = spans[current(spans, t)];
    const k = last(stretch.times, t);
    const local = stretch.poses[k], next = stretch.poses[k + 1];
    place(node, local);
    if (next && t > stretch.times[k]) {
      const share = (t - stretch.times[k]) / (stretch.times[k + 1] - stretch.times[k]);
      node.position.lerp(new T.Vector3(next[0], next[1], next[2]), share);
      node.quaternion.slerp(new T.Quaternion(next[3], next[4], next[5], next[6]), share);
    }
    if (stretch.frame !== "world") {
      node.updateMatrix();
      node.matrix.premultiply(links[stretch.frame].matrixWorld);
      node.matrix.decompose(node.position, node.quaternion, node.scale);
    }
  };
  const pose = (t) => {
    poseRobot(t);
    trace.objects.forEach((spans, i) => carry(spans, objects[i], t));
    for (const [name, spans] of Object.entries(trace.guided)) carry(spans, fixed[name], t);
    world.updateMatrixWorld(true);
  };
  const layer = (name) => scene.parts.filter((part) => part.layer === name);
  const tool = links[trace.robot.tool];
  return { bones, links, fixed, objects, root, tool, pose, poseRobot, layer };
};
