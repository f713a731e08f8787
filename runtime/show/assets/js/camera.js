// Where it is seen from. Every preset is a function of the time, so a moment always looks the
// same; whoever turns the view by hand keeps it.

const LENS = 34; // degrees from bottom to top
const VIEWS = ["auto", "overview", "follow", "gripper", "top", "free"];

const makeCamera = (stage, canvas) => {
  const { trace } = stage;
  const camera = new T.PerspectiveCamera(LENS, 1, 0.05, 300);
  camera.up.set(0, 0, 1);
  const orbit = new T.OrbitControls(camera, canvas);
  orbit.maxPolarAngle = Math.PI / 2 - 0.02;
  let mode = "auto", stale = true, offset = null;

  const chest = Math.min(0.75, 0.55 * stage.bounds.max.z + 0.2);
  const baseAt = (t) => { const [x, y] = at(trace.base, t); return [x, y, chest]; };
  const mix = (a, b, s) => a.map((v, k) => v + s * (b[k] - v));
  const look = (target, azimuth, height, distance) => {
    const flat = Math.cos(height) * distance;
    camera.position.set(target[0] + flat * Math.cos(azimuth), target[1] + flat * Math.sin(azimuth),
      target[2] + distance * Math.sin(height));
    orbit.target.set(...target);
    camera.lookAt(orbit.target);
  };

  // -- the whole scene -----------------------------------------------------------------------
  // From a direction, as near as all corners of the box around the scene allow.
  const framed = (azimuth, height, margin = 1.04) => {
    const forward = new T.Vector3(-Math.cos(azimuth) * Math.cos(height), -Math.sin(azimuth) * Math.cos(height), -Math.sin(height));
    const right = new T.Vector3().crossVectors(forward, Math.abs(height) > 1.5 ? new T.Vector3(0, 1, 0) : new T.Vector3(0, 0, 1)).normalize();
    const up = new T.Vector3().crossVectors(right, forward);
    const tangent = Math.tan(LENS * Math.PI / 360) / margin, corner = new T.Vector3(), eye = new T.Vector3();
    const { min, max } = stage.bounds;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? Math.min(max.z, 1.35) : 0]);
    let distance = 0;
    for (const [axis, slope] of [[up, tangent], [right, tangent * camera.aspect]]) {
      let high = -Infinity, low = -Infinity;
      for (const point of corners) {
        corner.set(...point);
        const depth = corner.dot(forward), side = corner.dot(axis);
        high = Math.max(high, side - slope * depth);
        low = Math.max(low, -side - slope * depth);
      }
      eye.addScaledVector(axis, (high - low) / 2);
      distance = Math.max(distance, (high + low) / (2 * slope));
    }
    camera.position.copy(eye).addScaledVector(forward, -distance);
    // What is turned about: the point of the line of sight at half the height of the scene.
    const along = Math.max(1, (camera.position.z - 0.4) / Math.max(0.1, -forward.z));
    orbit.target.copy(camera.position).addScaledVector(forward, along);
    camera.lookAt(orbit.target);
  };

  // -- following the action ------------------------------------------------------------------
  // Whether something fixed stands between a point and the eye; what moves is looked past.
  stage.model.pose(0);
  const things = stage.boxes.filter(({ fixed }) => fixed).map(({ bone, box }) => ({
    inverse: bone.matrixWorld.clone().invert(),
    box: new T.Box3(new T.Vector3(...box), new T.Vector3(...[0, 1, 2].map((k) => box[k] + box[3 + k]))) }));
  const ray = new T.Ray(), own = new T.Ray(), hit = new T.Vector3(), back = new T.Vector3();
  const hidden = (point, eye) => {
    back.subVectors(eye, ray.origin.set(...point));
    const far = back.length();
    ray.direction.copy(back.divideScalar(far));
    ray.origin.addScaledVector(ray.direction, 0.12);
    return things.some(({ inverse, box }) => own.copy(ray).applyMatrix4(inverse).intersectBox(box, hit)
      && hit.distanceTo(own.origin) < far - 0.15);
  };
  const eyeAt = ([x, y, z], azimuth, height, distance) => new T.Vector3(x + distance * Math.cos(height) * Math.cos(azimuth),
    y + distance * Math.cos(height) * Math.sin(azimuth), z + distance * Math.sin(height));
  const around = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));
  // One shot for each action that grips or lets go: the direction from which the hand is seen best.
  const shots = [];
  const chooseShots = () => {
    let before = -2.1;
    for (const action of trace.actions.filter((action) => action.object)) {
      const grip = trace.grips.findLast((g) => g.object === action.object && g.time >= action.start && g.time <= action.end);
      const t = grip ? grip.time : (action.start + action.end) / 2;
      const point = stage.toolAt(t), [x, y] = at(trace.base, t), body = [x, y, chest], head = [x, y, chest + 0.45];
      const ahead = Math.atan2(point[1] - y, point[0] - x), focus = mix(body, point, 0.55);
      let best = null;
      for (const height of [0.42, 0.26, 0.72, 1.0]) {
        for (let k = 0; k < 16; k++) {
          const azimuth = k * Math.PI / 8, eye = eyeAt(focus, azimuth, height, 3);
          const off = Math.abs(around(azimuth - ahead)), turn = Math.abs(around(azimuth - before));
          const dark = 6 * hidden(point, eye) + 3 * hidden(body, eye) + 3 * hidden(head, eye);
          // From the side, a little from behind; not through the robot; not round and round.
          const score = dark + 1.2 * Math.abs(off - 1.9) + (off > 2.7 ? 1.5 : 0) + 0.7 * turn + Math.abs(height - 0.42);
          if (!best || score < best.score) best = { score, azimuth, height };
        }
      }
      best.azimuth = before + around(best.azimuth - before);
      before = best.azimuth;
      shots.push({ start: action.start, end: action.end, ...best });
    }
  };
  const shotAt = (t) => {
    if (!shots.length) return { azimuth: -2.1, height: 0.45, near: 0 };
    const i = current(shots, t), here = shots[i], next = shots[i + 1];
    const near = (t >= here.start && t <= here.end) ? smooth(Math.min(t - here.start, here.end - t) / 2 + 0.3) : 0;
    if (!next || t <= here.end) return { ...here, near };
    const s = smooth((t - here.end) / Math.max(1e-6, next.start - here.end));
    return { azimuth: here.azimuth + s * (next.azimuth - here.azimuth), height: here.height + s * (next.height - here.height), near };
  };
  // How high the view has to be, second by second, for nothing fixed to stand before the robot: it
  // is raised over a hanging cabinet, say, and comes down behind it.
  const HEIGHTS = [0, 0.2, 0.4, 0.6, 0.8, 1], HIGHEST = 1.4; // radians
  const raised = [];
  const AHEAD = 4; // seconds before and after, since the view is smoothed over some
  const raise = () => {
    const needed = [];
    for (let t = 0; t <= trace.duration + 1; t += 1) {
      const { azimuth, height } = shotAt(t), [x, y] = at(trace.base, t), points = [[x, y, chest], [x, y, chest + 0.45], stage.toolAt(t)];
      const free = HEIGHTS.find((more) => {
        const eye = eyeAt([x, y, chest], azimuth, Math.min(HIGHEST, height + more), 4);
        return points.every((point) => !hidden(point, eye));
      });
      needed.push(free === undefined ? HEIGHTS.at(-1) : free);
    }
    needed.forEach((_, i) => raised.push(Math.max(...needed.slice(Math.max(0, i - AHEAD), i + AHEAD + 1))));
  };
  // Smoothed over a while that grows with the speed at which it is watched.
  const auto = (t, speed) => {
    const window = 0.9 * Math.max(1, speed);
    let weight = 0, target = [0, 0, 0], near = 0, azimuth = 0, height = 0;
    for (let k = -6; k <= 6; k++) {
      const s = clamp(t + k * window / 6, 0, trace.duration), w = Math.exp(-k * k / 12), shot = shotAt(s);
      const focus = mix(baseAt(s), stage.toolAt(s), 0.3 + 0.25 * shot.near);
      target = target.map((v, i) => v + w * focus[i]);
      near += w * shot.near;
      azimuth += w * shot.azimuth;
      height += w * Math.min(HIGHEST, shot.height + raised[Math.min(raised.length - 1, Math.round(s))]);
      weight += w;
    }
    look(target.map((v) => v / weight), azimuth / weight, height / weight, 4.3 - 1.5 * near / weight);
  };

  const tracked = (t) => mode === "gripper" ? stage.toolAt(t) : baseAt(t);
  const aim = (t, speed) => {
    camera.up.set(0, 0, 1);
    if (mode === "auto") {
      if (!raised.length) { chooseShots(); raise(); }
      auto(t, speed);
    } else if (mode === "follow" || mode === "gripper") {
      const target = tracked(t);
      if (stale) {
        const { azimuth } = shotAt(t);
        look(target, azimuth, mode === "gripper" ? 0.5 : 0.4, mode === "gripper" ? 1.25 : 4.2);
      } else {
        offset.subVectors(camera.position, orbit.target);
        orbit.target.set(...target);
        camera.position.copy(orbit.target).add(offset);
        camera.lookAt(orbit.target);
      }
    } else if (stale && mode === "overview") framed(-2.12, 0.62);
    else if (stale && mode === "top") framed(-Math.PI / 2, 1.5);
    offset = offset || new T.Vector3();
    stale = false;
    camera.updateMatrixWorld(true);
  };
  const fit = (width, height) => {
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (mode !== "free") stale = true;
  };
  const choose = (name) => {
    if (!VIEWS.includes(name)) return;
    if (name !== "free") stale = true;
    if (!raised.length) { chooseShots(); raise(); }
    mode = name;
  };
  return { camera, orbit, aim, fit, choose, get mode() { return mode; } };
};
