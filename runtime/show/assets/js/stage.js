// What stands around the model: floor, light, letters, routes, and what the mouse points at.

const THEMES = {
  light: { ground: "#dfe4ea", spot: "rgba(255,255,255,0.62)", grid: "#c3ccd4", shadow: 0.24, sun: 2.1, sky: 1.75, fill: 0.75,
    past: "#4d8fd6", future: "#bcd0e6", hand: "#d9652b" },
  dark: { ground: "#171c22", spot: "rgba(58,70,84,0.9)", grid: "#333e4a", shadow: 0.5, sun: 1.7, sky: 1.05, fill: 0.5,
    past: "#4d8fd6", future: "#31475f", hand: "#ff9d5c" },
};

const STEP = 0.2; // seconds between the points of the paths
const LONGEST = 6000; // points of a path

const makeStage = (canvas, trace, scene) => {
  const world = new T.Scene();
  const model = makeModel(trace, scene, world);
  const surface = new T.MeshLambertMaterial({ vertexColors: true });
  const looks = batch(model.layer("looks"), model.bones, surface);
  looks.castShadow = looks.receiveShadow = true;
  const goals = batch(model.layer("goals"), model.bones, new T.MeshBasicMaterial({
    vertexColors: true, side: T.DoubleSide, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }));
  const solids = batch(model.layer("solids"), model.bones, new T.MeshLambertMaterial({
    vertexColors: true, transparent: true, opacity: 0.38, depthWrite: false }));
  solids.visible = false;
  world.add(looks, goals, solids);

  // -- how far it all reaches ----------------------------------------------------------------
  const boxes = scene.parts.flatMap((part) => part.layer !== "looks" || scene.nodes[part.node].kind === "link" ? []
    : [{ bone: model.bones[part.node], box: part.box, fixed: scene.nodes[part.node].kind === "fixed" }]);
  const bounds = new T.Box3();
  model.pose(0);
  for (const { bone, box } of boxes) {
    for (let corner = 0; corner < 8; corner++) {
      bounds.expandByPoint(new T.Vector3(...[0, 1, 2].map((k) => box[k] + box[3 + k] * (corner >> k & 1))).applyMatrix4(bone.matrixWorld));
    }
  }
  for (const [x, y] of trace.base.values) {
    bounds.expandByPoint(new T.Vector3(x - 0.3, y - 0.3, 0));
    bounds.expandByPoint(new T.Vector3(x + 0.3, y + 0.3, 1.3));
  }
  const middle = bounds.getCenter(new T.Vector3()), size = bounds.getSize(new T.Vector3());
  const reach = Math.max(1.2, 0.5 * Math.hypot(size.x, size.y));

  // -- floor and light -----------------------------------------------------------------------
  const disc = make("canvas");
  disc.width = disc.height = 256;
  const spot = new T.CanvasTexture(disc);
  spot.colorSpace = "srgb";
  const floor = new T.Mesh(new T.CircleGeometry(2.2 * reach, 64), new T.MeshBasicMaterial({ map: spot, transparent: true, depthWrite: false, toneMapped: false }));
  floor.position.set(middle.x, middle.y, -0.004);
  floor.renderOrder = -3;
  const shade = new T.Mesh(new T.CircleGeometry(4 * reach, 48), new T.ShadowMaterial({ depthWrite: false }));
  shade.position.set(middle.x, middle.y, -0.002);
  shade.receiveShadow = true;
  shade.renderOrder = -1;
  const far = Math.ceil(1.5 * reach), lines = [];
  for (let k = -far; k <= far; k++) {
    const half = Math.sqrt(Math.max(0, far * far - k * k)), x = Math.round(middle.x), y = Math.round(middle.y);
    lines.push(x + k, y - half, 0, x + k, y + half, 0, x - half, y + k, 0, x + half, y + k, 0);
  }
  const grid = new T.LineSegments(new T.BufferGeometry(), new T.LineBasicMaterial({ transparent: true, opacity: 0.7, depthWrite: false }));
  grid.geometry.setAttribute("position", new T.Float32BufferAttribute(lines, 3));
  grid.renderOrder = -2;
  world.add(floor, shade, grid);
  const sky = new T.HemisphereLight(0xffffff, 0xc9c6c2, 1), fill = new T.DirectionalLight(0xdfeaff, 1);
  fill.position.set(middle.x + 0.9 * reach, middle.y - 0.9 * reach, 0.9 * reach);
  fill.target.position.copy(middle);
  const sun = new T.DirectionalLight(0xfffaf2, 1);
  sun.position.set(middle.x - 0.7 * reach, middle.y - 0.45 * reach, 2.4 * reach);
  sun.target.position.copy(middle).setZ(0);
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  const wide = 1.25 * reach;
  Object.assign(sun.shadow.camera, { left: -wide, right: wide, top: wide, bottom: -wide, near: 0.1, far: 5 * reach });
  sun.shadow.bias = -0.0004;
  sun.shadow.normalBias = 0.02;
  sun.shadow.radius = 3;
  world.add(sky, sun, sun.target, fill, fill.target);

  // -- routes --------------------------------------------------------------------------------
  const step = Math.max(STEP, trace.duration / LONGEST), count = Math.max(2, Math.ceil(trace.duration / step) + 1);
  const route = new Float32Array(3 * count), hand = new Float32Array(3 * count), at3 = new T.Vector3();
  for (let i = 0; i < count; i++) {
    const t = Math.min(trace.duration, i * step);
    model.poseRobot(t);
    route.set([model.root.position.x, model.root.position.y, 0.006], 3 * i);
    hand.set(at3.setFromMatrixPosition(model.tool.matrixWorld).toArray(), 3 * i);
  }
  const line = (points, width) => {
    const geometry = new T.LineGeometry();
    geometry.setPositions(points);
    const made = new T.Line2(geometry, new T.LineMaterial({ linewidth: width, worldUnits: true }));
    made.frustumCulled = false;
    world.add(made);
    return made;
  };
  const future = line(route, 0.012), past = line(route.map((v, i) => (i % 3 === 2 ? 0.012 : v)), 0.018), swing = line(hand.slice(0, 6), 0.008);
  const drawPaths = (t) => {
    past.geometry.instanceCount = Math.floor(t / step);
    past.visible = past.geometry.instanceCount > 0;
    const action = doing(trace, t);
    const from = action ? Math.floor(action.start / step) : 0;
    const until = Math.min(count - 1, Math.ceil(t / step));
    swing.visible = Boolean(action && action.object) && until - from > 1;
    if (swing.visible) {
      swing.geometry.dispose();
      swing.geometry = new T.LineGeometry();
      swing.geometry.setPositions(hand.slice(3 * from, 3 * until + 3));
    }
  };
  const toolAt = (t) => {
    const s = clamp(t / step, 0, count - 1), i = Math.min(count - 2, Math.floor(s)), share = s - i;
    return [0, 1, 2].map((k) => hand[3 * i + k] + share * (hand[3 * i + 3 + k] - hand[3 * i + k]));
  };

  const letters = addLetters(world, model, scene);
  const pointed = pointer(trace, scene, model);

  // -- drawing -------------------------------------------------------------------------------
  let renderer = null;
  try {
    renderer = new T.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: false });
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = T.PCFShadowMap;
    renderer.toneMapping = T.NeutralToneMapping;
  } catch {
    renderer = null;
  }
  const paint = (name) => {
    const theme = THEMES[name];
    world.background = new T.Color(theme.ground);
    const brush = disc.getContext("2d");
    brush.clearRect(0, 0, 256, 256);
    const fade = brush.createRadialGradient(128, 128, 20, 128, 128, 128);
    fade.addColorStop(0, theme.spot);
    fade.addColorStop(1, theme.spot.replace(/[\d.]+\)$/, "0)"));
    brush.fillStyle = fade;
    brush.fillRect(0, 0, 256, 256);
    spot.needsUpdate = true;
    grid.material.color.set(theme.grid);
    shade.material.opacity = theme.shadow;
    sun.intensity = theme.sun;
    sky.intensity = theme.sky;
    fill.intensity = theme.fill;
    past.material.color.set(theme.past);
    future.material.color.set(theme.future);
    swing.material.color.set(theme.hand);
  };
  paint("light");
  const pose = (t) => {
    model.pose(t);
    drawPaths(t);
  };
  const draw = (camera) => {
    letters.face(camera);
    if (renderer) renderer.render(world, camera);
  };
  return { trace, world, model, renderer, bounds, middle, reach, boxes, toolAt, pointed, paint, pose, draw, solids, goals };
};
