// A replay of one trace: three.js shows the scene, plain DOM the rest. Everything on the page
// is a function of the time, `show(t)`; playing only moves the time.
"use strict";
(() => {
  const trace = JSON.parse(document.getElementById("trace").textContent);
  const $ = (id) => document.getElementById(id);
  const make = (tag, cls, text) => {
    const node = document.createElement(tag);
    if (cls) node.className = cls;
    if (text !== undefined) node.textContent = text;
    return node;
  };
  const T = THREE, Z = new T.Vector3(0, 0, 1);

  let now = 0, playing = false, speed = 4, stale = true, lit = -1;

  // -- values over time ----------------------------------------------------------------------

  // Index of the last entry of a rising list that is not above x, or 0.
  const last = (list, x) => {
    let low = 0, high = list.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (list[middle] <= x) low = middle; else high = middle - 1;
    }
    return low;
  };
  // A track at a time: the cubic with the values and velocities of both knots.
  const at = (track, t) => {
    const i = last(track.times, t), a = track.values[i];
    if (t <= track.times[0] || i === track.times.length - 1) return a;
    const h = track.times[i + 1] - track.times[i], s = (t - track.times[i]) / h;
    const b = track.values[i + 1], u = track.velocities[i], v = track.velocities[i + 1];
    return a.map((p, k) => {
      const q = b[k], m = u[k] * h, n = v[k] * h;
      return (((2 * (p - q) + m + n) * s + 3 * (q - p) - 2 * m - n) * s + m) * s + p;
    });
  };
  const current = (list, t) => Math.max(0, list.findLastIndex((entry) => entry.start <= t + 1e-9));

  // -- the scene -----------------------------------------------------------------------------

  const world = new T.Scene();
  world.background = new T.Color(0xe9eef3);
  const camera = new T.PerspectiveCamera(42, 1, 0.05, 200);
  camera.up.copy(Z);
  const material = (colour, more = {}) => new T.MeshLambertMaterial({ color: colour, ...more });
  const INK = new T.LineBasicMaterial({ color: 0x1d2733, transparent: true, opacity: 0.35 });

  const box = (size, surface, { edges = true, shadow = true } = {}) => {
    const geometry = new T.BoxGeometry(...size);
    const mesh = new T.Mesh(geometry, surface);
    mesh.castShadow = shadow;
    mesh.receiveShadow = true;
    if (edges) mesh.add(new T.LineSegments(new T.EdgesGeometry(geometry), INK));
    return mesh;
  };
  const facets = (vertices, faces, surface) => {
    const geometry = new T.BufferGeometry();
    // Corners of each face of its own, so that faces have their own normals.
    geometry.setAttribute("position", new T.Float32BufferAttribute(
      faces.flatMap((face) => face.flatMap((corner) => vertices[corner])), 3));
    geometry.computeVertexNormals();
    const mesh = new T.Mesh(geometry, surface);
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.add(new T.LineSegments(new T.EdgesGeometry(geometry, 25), INK));
    return mesh;
  };
  // What a profile of [radius, height], from below, sweeps about z.
  const turned = (profile, surface, around = 32) => {
    const vertices = [], faces = [];
    for (const [r, z] of [[0, profile[0][1]], ...profile, [0, profile.at(-1)[1]]]) {
      for (let k = 0; k < around; k++) {
        const angle = 2 * Math.PI * k / around;
        vertices.push([r * Math.cos(angle), r * Math.sin(angle), z]);
      }
    }
    for (let a = 0; a + around < vertices.length; a += around) {
      for (let k = 0; k < around; k++) {
        const n = (k + 1) % around;
        faces.push([a + k, a + n, a + around + n], [a + k, a + around + n, a + around + k]);
      }
    }
    return facets(vertices, faces, surface);
  };
  const ball = (radius, height) => {
    const rings = [];
    for (let i = 0; i <= 16; i++) {
      const angle = Math.PI * (i / 16 - 0.5);
      const ring = (lift) => rings.push([radius * Math.cos(angle), radius * Math.sin(angle) + lift]);
      if (i <= 8) ring(-height / 2);
      if (i >= 8 && (height || i > 8)) ring(height / 2);
    }
    return rings;
  };
  // A solid as the trace describes it, in its own frame.
  const solid = (spec, surface) => {
    if (spec.type === "box") return box(spec.size, surface);
    const one = Array.isArray(surface) ? surface[0] : surface;
    if (spec.type === "hull") return facets(spec.points, spec.faces, one);
    if (spec.type === "cylinder") {
      return turned([[spec.radius, -spec.height / 2], [spec.radius, spec.height / 2]], one);
    }
    return turned(ball(spec.radius, spec.type === "capsule" ? spec.height : 0), one);
  };
  // A body: its mesh where it has one, else all its solids.
  const body = (spec, surface) => {
    const group = new T.Group();
    if (spec.mesh) group.add(facets(spec.mesh.vertices, spec.mesh.faces, surface));
    else for (const part of spec.solids) {
      const mesh = solid(part, surface);
      place(mesh, part.pose);
      group.add(mesh);
    }
    return group;
  };
  // Half the size of the box around a solid, along its own axes.
  const half = (spec) => spec.type === "box" ? spec.size.map((s) => s / 2)
    : spec.type === "hull" ? [0, 1, 2].map((k) => Math.max(...spec.points.map((p) => Math.abs(p[k]))))
      : spec.type === "sphere" ? [spec.radius, spec.radius, spec.radius]
        : [spec.radius, spec.radius, spec.height / 2 + (spec.type === "capsule" ? spec.radius : 0)];
  const place = (node, pose) => {
    node.position.set(pose[0], pose[1], pose[2]);
    node.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
  };

  const addScene = (scene) => {
    const reach = Math.max(2, ...scene.fixed.map(
      ({ pose }) => Math.max(Math.abs(pose[0]), Math.abs(pose[1])) + 0.6));
    const floor = new T.Mesh(new T.PlaneGeometry(4 * reach, 4 * reach), material(0xdfe5ea));
    floor.receiveShadow = true;
    world.add(floor);
    const grid = new T.GridHelper(4 * Math.ceil(reach), 8 * Math.ceil(reach), 0xb9c3cc, 0xcdd5dc);
    grid.rotation.x = Math.PI / 2;
    grid.position.z = 0.002;
    world.add(grid);
    const SLAB = 0.04, fixed = {};
    for (const thing of scene.fixed) {
      const furniture = scene.supports.some(({ owner }) => owner === thing.name);
      const group = fixed[thing.name] = new T.Group();
      const only = thing.solids.length === 1 && thing.solids[0].type === "box" && thing.solids[0];
      if (furniture && only && only.size[2] > 4 * SLAB) {
        // The planner keeps clear of the whole body, down to the floor; drawn as a box below a top.
        const [a, b, c] = only.size;
        const low = box([a - 0.04, b - 0.04, c - SLAB], material(0xcbb391));
        const top = box([a, b, SLAB], material(0xe2cba6));
        low.position.z = -SLAB / 2;
        top.position.z = c / 2 - SLAB / 2;
        const whole = new T.Group();
        whole.add(low, top);
        place(whole, only.pose);
        group.add(whole);
      } else {
        group.add(body(thing, material(furniture ? 0xe2cba6 : 0x9aa7b3)));
      }
      place(group, thing.pose);
      world.add(group);
    }
    return { reach, fixed };
  };

  const lettered = (text, colour) => {
    const canvas = make("canvas");
    canvas.width = canvas.height = 128;
    const brush = canvas.getContext("2d");
    brush.fillStyle = colour;
    brush.fillRect(0, 0, 128, 128);
    brush.fillStyle = "#1d2733";
    brush.font = "bold 104px system-ui, 'DejaVu Sans', sans-serif";
    brush.textAlign = "center";
    brush.textBaseline = "middle";
    brush.fillText(text, 64, 70);
    const texture = new T.CanvasTexture(canvas);
    texture.colorSpace = "srgb";
    return new T.MeshLambertMaterial({ map: texture });
  };

  const COLOURS = { blue: "#2f6fd0", green: "#36a161", red: "#d2453d", yellow: "#e8bd2f" };
  const addObject = (thing) => {
    const holder = new T.Group();
    const colour = COLOURS[thing.colour] || (thing.label ? "#f2d49b" : thing.colour) || "#b07cc6";
    let surface = material(colour);
    const only = thing.solids.length === 1 && thing.solids[0].type === "box" && thing.solids[0];
    if (thing.label && only) {
      // The letter is on top, where a row of blocks is read, and on a square on each side.
      const face = lettered(thing.label, colour);
      surface = [surface, surface, surface, surface, face, surface];
    }
    holder.add(body(thing, surface));
    if (thing.label && only) addLabels(holder, only, lettered(thing.label, colour));
    world.add(holder);
    return holder;
  };
  const addLabels = (holder, { size: [a, b, c] }, face) => {
    for (let side = 0; side < 4; side++) {
      const width = side % 2 ? a : b, out = (side % 2 ? b : a) / 2 + 0.0006;
      const label = new T.Mesh(new T.PlaneGeometry(width * 0.98, width * 0.98), face);
      label.rotation.set(Math.PI / 2, 0, 0);
      const turn = new T.Group();
      label.position.set(0, -out, c - width / 2);
      turn.add(label);
      turn.rotation.z = side * Math.PI / 2 + Math.PI / 2;
      holder.add(turn);
    }
  };

  // The robot: a group a link, nested as the joints are.
  const addRobot = (robot) => {
    const links = {}, movers = {};
    const byChild = Object.fromEntries(robot.joints.map((joint) => [joint.child, joint]));
    const moving = new Set([...robot.planning_joints, ...robot.finger_joints]);
    const depth = (link) => {
      const joint = byChild[link];
      return joint ? depth(joint.parent) + (moving.has(joint.name) ? 1 : 0) : 0;
    };
    const grip = new Set(robot.gripper_links);
    for (const link of robot.links) {
      const group = links[link.name] = new T.Group();
      const level = depth(link.name);
      const colour = grip.has(link.name) ? 0x3a434d
        : level === 0 ? 0x59646f : level % 2 ? 0xf4f5f6 : 0xe3873e;
      for (const shape of link.solids) {
        const mesh = solid(shape, material(colour));
        place(mesh, shape.pose);
        group.add(mesh);
      }
    }
    // A column below what a lift raises: collision boxes alone would leave it floating.
    for (const joint of robot.joints) {
      if (joint.type !== "prismatic" || !robot.planning_joints.includes(joint.name)) continue;
      const shape = robot.links.find((link) => link.name === joint.child).solids[0];
      if (!shape || joint.axis[2] < 0.99) continue;
      const length = joint.limits[1] - joint.limits[0];
      const [a, b, c] = half(shape);
      const column = box([a, b, length], material(0x8a949e));
      column.position.set(shape.pose[0], shape.pose[1], shape.pose[2] - c - length / 2);
      links[joint.child].add(column);
    }
    for (const joint of robot.joints) {
      const origin = new T.Group();
      place(origin, joint.origin);
      origin.add(links[joint.child]);
      links[joint.parent].add(origin);
      movers[joint.name] = { node: links[joint.child], axis: new T.Vector3(...joint.axis), type: joint.type };
    }
    world.add(links[robot.root]);
    const set = (name, value) => {
      const { node, axis, type } = movers[name];
      if (type === "prismatic") node.position.copy(axis).multiplyScalar(value);
      else if (type !== "fixed") node.quaternion.setFromAxisAngle(axis, value);
    };
    for (const [name, value] of Object.entries(robot.fixed_joints)) set(name, value);
    return { links, set, root: links[robot.root] };
  };

  const { reach, fixed } = addScene(trace.world);
  const objects = trace.world.objects.map(addObject);
  const robot = addRobot(trace.robot);
  const path = new T.BufferGeometry();
  const points = [];
  for (let t = 0; t <= trace.duration; t += 0.25) {
    const [x, y] = at(trace.base, t);
    points.push(x, y, 0.006);
  }
  path.setAttribute("position", new T.Float32BufferAttribute(points, 3));
  world.add(new T.Line(path, new T.LineBasicMaterial({ color: 0x1769c2, transparent: true, opacity: 0.35 })));

  world.add(new T.HemisphereLight(0xffffff, 0xb8c0c8, 1.9));
  const sun = new T.DirectionalLight(0xffffff, 1.9);
  sun.position.set(-0.6 * reach, -0.9 * reach, 2.6 * reach);
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  Object.assign(sun.shadow.camera, { left: -1.4 * reach, right: 1.4 * reach, top: 1.4 * reach,
    bottom: -1.4 * reach, near: 0.1, far: 6 * reach });
  sun.shadow.bias = -0.0005;
  sun.shadow.normalBias = 0.01;
  world.add(sun);

  const canvas = $("view");
  let renderer;
  try {
    renderer = new T.WebGLRenderer({ canvas, antialias: true });
  } catch {
    $("failure").hidden = false;
    $("failure").textContent = "This browser cannot show 3D graphics (WebGL 2); the rest of the page works.";
  }
  if (renderer) {
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = T.PCFShadowMap;
  }
  const orbit = new T.OrbitControls(camera, canvas);
  orbit.maxPolarAngle = Math.PI / 2 - 0.02;
  orbit.addEventListener("change", () => { stale = true; });
  // Room for everything around the middle of what is on the floor.
  const owners = new Set(trace.world.supports.map(({ owner }) => owner));
  const furniture = trace.world.fixed.filter(({ name }) => owners.has(name));
  const spread = [...furniture.map(({ pose }) => pose), trace.world.robot_start];
  const middle = [0, 1].map((k) => (Math.min(...spread.map((p) => p[k])) + Math.max(...spread.map((p) => p[k]))) / 2);
  const span = Math.max(1.6, ...furniture.map(({ pose, solids }) =>
    Math.max(...solids.flatMap((part) => half(part).slice(0, 2))) + Math.hypot(pose[0] - middle[0], pose[1] - middle[1])));
  orbit.target.set(middle[0], middle[1], 0.45);
  camera.position.set(middle[0] - 0.95 * span, middle[1] - 1.55 * span, 0.5 + 1.55 * span);
  orbit.update();

  // -- the panel -----------------------------------------------------------------------------

  const clock = (t) => `${Math.floor(t / 60)}:${String(Math.floor(t % 60)).padStart(2, "0")}`;
  const kinds = Object.fromEntries(trace.sketch.features.map(({ name, kind }) => [name, kind]));
  const shown = (name, value) => (kinds[name] === "bool" ? (value ? "true" : "false") : String(value));

  document.title = `${trace.world.name} · ${trace.sketch.name}`;
  $("title").textContent = document.title;
  $("about").textContent = `${trace.source === "plan" ? "planned" : "executed"} · `
    + `${trace.planner}, seed ${trace.seed} · ${trace.subgoals.length} subgoals · ${clock(trace.duration)}`;

  // Values hold from where they were sensed to the end of the subgoal that changes them.
  const valuesAt = (t) => {
    if (!trace.subgoals.length) return {};
    const goal = trace.subgoals[current(trace.subgoals, t)];
    return t >= goal.end - 1e-9 ? goal.after : goal.before;
  };
  const rows = trace.sketch.features.map(({ name, kind }) => {
    const NS = "http://www.w3.org/2000/svg";
    const svg = document.createElementNS(NS, "svg");
    svg.setAttribute("viewBox", "0 0 1000 100");
    svg.setAttribute("preserveAspectRatio", "none");
    const values = trace.subgoals.flatMap((goal) => [goal.before[name], goal.after[name]]);
    const top = Math.max(1, ...values);
    const x = (t) => (1000 * t / (trace.duration || 1)).toFixed(1);
    const y = (v) => (92 - 84 * v / top).toFixed(1);
    let d = "M0,92";
    for (const goal of trace.subgoals) {
      d += `V${y(goal.before[name])}H${x(goal.end)}V${y(goal.after[name])}`;
    }
    const line = document.createElementNS(NS, "path");
    line.setAttribute("d", `${d}H1000V92`);
    const cursor = document.createElementNS(NS, "line");
    cursor.setAttribute("y1", 0);
    cursor.setAttribute("y2", 100);
    svg.append(line, cursor);
    svg.addEventListener("click", (event) => {
      const area = svg.getBoundingClientRect();
      seek(trace.duration * (event.clientX - area.left) / area.width);
    });
    const value = make("span", "value");
    $("features").append(make("span", "name", name), value, svg);
    return { name, value, cursor, top, kind };
  });

  const ruleNodes = {};
  const addSource = ({ text }, number) => {
    const rules = trace.sketch.rules.filter((rule) => rule.text === number).sort((a, b) => a.start - b.start);
    const characters = [...text]; // offsets count code points, as Python does
    const piece = (from, to, into) => {
      for (const part of characters.slice(from, to).join("").split(/(#[^\n]*|\w+--)/)) {
        // Browsers break lines after a hyphen: not within `m--`.
        if (part.startsWith("#")) into.append(make("span", "comment", part));
        else into.append(part.endsWith("--") ? make("span", "word", part) : part);
      }
    };
    let done = 0;
    for (const rule of rules) {
      piece(done, rule.start, $("source"));
      const node = ruleNodes[rule.name] = make("span", "rule");
      piece(rule.start, rule.end, node);
      $("source").append(node);
      done = rule.end;
    }
    piece(done, characters.length, $("source"));
    $("source").append("\n");
  };
  trace.sketch.texts.forEach(addSource);

  const describe = (action) => action.text;
  const items = trace.subgoals.map((goal, number) => {
    const item = make("li");
    const own = trace.actions.filter((action) => action.subgoal === number && action.object);
    item.append(make("span", "time", clock(goal.start)), make("span", "rule-name", goal.rule),
      `  ${own.map(describe).join(", ") || "drive"}`);
    const names = Object.keys(goal.after).filter((name) => goal.before[name] !== goal.after[name]);
    item.append(make("span", "change", names.map((name) =>
      `${name}: ${shown(name, goal.before[name])} → ${shown(name, goal.after[name])}`).join(", ")));
    const rejected = Object.entries(goal.rejected).filter(([, count]) => count)
      .map(([step, count]) => `${count} by ${step.replaceAll("_", " ")}`).join(", ");
    item.append(make("span", "effort", `IW(${goal.width}), attempt ${goal.attempt + 1}: ${goal.expanded} expanded, `
      + `${goal.generated} generated; rejected ${rejected || "none"}`));
    item.addEventListener("click", () => seek(goal.start));
    $("subgoals").append(item);
    const tick = make("i");
    tick.style.left = `${100 * goal.start / (trace.duration || 1)}%`;
    $("ticks").append(tick);
    return item;
  });
  $("events-box").hidden = !trace.events.length;
  const isFailed = (event) => event.kind === "verdict" && event.text !== "goal reached";
  const failure = trace.source === "plan" ? trace.events.find(isFailed) : undefined; // of a partial plan
  for (const event of trace.events) {
    const failed = isFailed(event);
    const item = make("li", failed ? "verdict failure" : event.kind, `${clock(event.time)}  ${event.text}`);
    item.addEventListener("click", () => seek(event.time));
    $("events").append(item);
  }

  // -- time ----------------------------------------------------------------------------------

  for (const factor of [0.5, 1, 2, 4, 8, 16, 32]) {
    const option = make("option", "", `${factor}×`);
    option.value = factor;
    option.selected = factor === speed;
    $("speed").append(option);
  }
  $("seek").max = trace.duration;

  const light = (number) => {
    if (number === lit) return;
    lit = number;
    const goal = trace.subgoals[number];
    for (const [name, node] of Object.entries(ruleNodes)) node.classList.toggle("lit", Boolean(goal) && goal.rule === name);
    items.forEach((item, i) => item.classList.toggle("lit", i === number));
    // Scrolls only the two lists; scrollIntoView would move the page as well.
    const reveal = (list, node) => {
      if (!node) return;
      const up = node.offsetTop - list.offsetTop;
      if (up < list.scrollTop || up + node.offsetHeight > list.scrollTop + list.clientHeight) {
        list.scrollTop = up - list.clientHeight / 2 + node.offsetHeight / 2;
      }
    };
    reveal($("source"), goal && ruleNodes[goal.rule]);
    reveal($("subgoals"), items[number]);
  };

  // Values of the finger joints, interpolated in the table of openings.
  const fingers = (opening) => {
    const { openings, finger_values: table } = trace.robot;
    const i = Math.min(last(openings, opening), openings.length - 2);
    if (i < 0) return table[0];
    const share = Math.min(1, Math.max(0, (opening - openings[i]) / (openings[i + 1] - openings[i] || 1)));
    return table[i].map((value, k) => value + share * (table[i + 1][k] - value));
  };

  const show = (t) => {
    const [x, y, yaw] = at(trace.base, t);
    if ($("follow").checked) {
      const dx = x - robot.root.position.x, dy = y - robot.root.position.y;
      camera.position.x += dx; camera.position.y += dy;
      orbit.target.x += dx; orbit.target.y += dy;
    }
    robot.root.position.set(x, y, 0);
    robot.root.rotation.z = yaw;
    at(trace.joints, t).forEach((value, i) => robot.set(trace.robot.planning_joints[i], value));
    const [opening] = at(trace.opening, t);
    fingers(opening).forEach((value, i) => robot.set(trace.robot.finger_joints[i], value));
    world.updateMatrixWorld(true);
    const carry = (spans, node) => {
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
        node.matrix.premultiply(robot.links[stretch.frame].matrixWorld);
        node.matrix.decompose(node.position, node.quaternion, node.scale);
      }
    };
    trace.objects.forEach((spans, i) => carry(spans, objects[i]));
    for (const [name, spans] of Object.entries(trace.guided)) carry(spans, fixed[name]);
    const number = trace.subgoals.length ? current(trace.subgoals, t) : -1;
    light(number);
    const values = valuesAt(t);
    for (const { name, value, cursor } of rows) {
      value.textContent = name in values ? shown(name, values[name]) : "";
      const mark = 1000 * t / (trace.duration || 1);
      cursor.setAttribute("x1", mark);
      cursor.setAttribute("x2", mark);
    }
    const action = trace.actions[current(trace.actions, t)];
    $("caption").replaceChildren(...(failure && t >= failure.time
      ? [make("b", "", "no plan"), ` · ${failure.text}`] : action
      ? [make("b", "", trace.subgoals[number].rule), ` · ${describe(action)}`] : ["nothing to do"]));
    $("clock").textContent = `${clock(t)} / ${clock(trace.duration)}`;
    $("seek").value = t;
  };

  const seek = (t) => {
    now = Math.min(Math.max(0, t), trace.duration);
    stale = true;
  };
  const play = (on = true) => {
    if (on && now >= trace.duration) seek(0);
    playing = on;
    $("play").textContent = on ? "❚❚" : "▶";
  };
  const jump = (step) => {
    const i = current(trace.subgoals, now), here = trace.subgoals[i];
    const back = step < 0 && here && now - here.start > 1.5; // first to the start of this one
    const goal = trace.subgoals[i + (back ? 0 : step)];
    seek(goal ? goal.start : step < 0 ? 0 : trace.duration);
  };
  $("play").addEventListener("click", () => play(!playing));
  $("back").addEventListener("click", () => jump(-1));
  $("forward").addEventListener("click", () => jump(1));
  $("seek").addEventListener("input", () => seek(Number($("seek").value)));
  $("speed").addEventListener("change", () => { speed = Number($("speed").value); });
  // What was clicked does not keep the focus: space plays and pauses, it does not click again.
  // A click by keyboard (detail 0) keeps it, or tab would start anew.
  $("controls").addEventListener("click", (event) => {
    if (event.detail && event.target.matches("button, input[type=checkbox]")) event.target.blur();
  });
  document.addEventListener("keydown", (event) => {
    const { key, target } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || target.matches("select")) return;
    if (key === " " && target.matches("button, input[type=checkbox]")) return; // presses it
    const act = { " ": () => play(!playing), PageUp: () => jump(-1), PageDown: () => jump(1) }[key];
    if (act) { act(); event.preventDefault(); }
  });

  const fit = () => {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!renderer || !width || !height) return;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    stale = true;
  };
  new ResizeObserver(fit).observe(canvas);
  fit();
  let before = performance.now(), frames = 0;
  const frame = (stamp) => {
    const passed = Math.min(0.1, Math.max(0, (stamp - before) / 1000)); // no leap after a pause of the page
    before = stamp;
    if (playing) {
      seek(now + speed * passed);
      if (now >= trace.duration) play(false);
    }
    if (stale) { // a page that stands still costs nothing
      stale = false;
      show(now);
      if (renderer) renderer.render(world, camera);
      frames += 1;
    }
    requestAnimationFrame(frame);
  };
  if (failure) seek(failure.time);
  show(now);
  requestAnimationFrame(frame);
  // For tests and for screenshots.
  window.replay = {
    seek, play, speed: (factor) => { speed = factor; $("speed").value = factor; },
    get time() { return now; }, get playing() { return playing; }, get frames() { return frames; },
    get fresh() { return !stale; }, draw: () => show(now), world, nodes: objects,
    get state() {
      return { rule: trace.subgoals[lit] ? trace.subgoals[lit].rule : null, subgoal: lit,
        lit: [...document.querySelectorAll("#source .lit")].map((node) => node.textContent),
        values: Object.fromEntries(rows.map(({ name, value }) => [name, value.textContent])),
        objects: objects.map((node) => node.position.toArray()) };
    },
  };
})();
