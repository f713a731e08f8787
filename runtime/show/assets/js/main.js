// Puts a page together: one plan with all that is to be said of it, or two side by side.

const payload = JSON.parse(document.getElementById("payload").textContent);
const boxes = [...document.querySelectorAll(".view")];
boxes.slice(payload.length).forEach((box) => box.remove());
document.body.classList.toggle("two", payload.length > 1);
const views = payload.map((data, i) => makeView(data, boxes[i]));
const durations = views.map(({ trace }) => trace.duration);
const whole = Math.max(...durations);
const scaled = document.getElementById("scaled");
const timeOf = (i, t) => scaled.checked ? t * durations[i] / (whole || 1) : Math.min(t, durations[i]);
const player = makePlayer(views, whole, timeOf);
document.title = payload.length > 1 ? `${views[0].trace.world.name} · two plans` : `${views[0].trace.world.name} · ${views[0].trace.sketch.name}`;
if (payload.length > 1) {
  compare(views);
  scaled.addEventListener("change", () => { player.redraw(); });
}
const panel = payload.length > 1 ? null : makePanel(views[0], player.seek);
player.start(panel);

// For tests, pictures and films.
window.replay = {
  seek: player.seek, play: player.play, speed: player.speed, camera: player.pick, theme: player.paint, draw: player.draw,
  film: (on = true) => { document.body.classList.toggle("film", on); views.forEach(({ fit }) => fit()); player.redraw(); },
  get time() { return player.time; }, get playing() { return player.playing; }, get frames() { return player.frames; },
  get fresh() { return player.fresh; }, get duration() { return whole; },
  get calls() { return views.map(({ stage }) => (stage.renderer ? stage.renderer.info.render : null)); },
  get state() {
    const [view] = views;
    return { ...(panel ? panel.state : {}), objects: view.stage.model.objects.map((node) => node.position.toArray()) };
  },
  // Volume within the triangles of each object, by the divergence theorem: negative where faces
  // look inwards.
  get volumes() {
    const [{ trace, scene }] = payload, found = {};
    for (const part of scene.parts.filter(({ layer }) => layer === "looks")) {
      const { kind, name } = scene.nodes[part.node];
      if (kind !== "object") continue;
      const points = decoded(part.points, Uint16Array), faces = decoded(part.faces, part.wide ? Uint32Array : Uint16Array);
      const corner = (i) => new T.Vector3(...[0, 1, 2].map((k) => part.box[k] + part.box[3 + k] * points[3 * i + k] / 65535));
      let sum = 0;
      for (let i = 0; i < faces.length; i += 3) sum += corner(faces[i]).dot(corner(faces[i + 1]).cross(corner(faces[i + 2]))) / 6;
      found[name] = (found[name] || 0) + sum;
    }
    return trace.world.objects.map(({ name }) => found[name]);
  },
  // Height of the robot as a share of the picture's height.
  get robotHeight() {
    const { stage, camera } = views[0], point = new T.Vector3();
    let low = Infinity, high = -Infinity;
    for (const part of payload[0].scene.parts) {
      if (part.layer !== "looks" || payload[0].scene.nodes[part.node].kind !== "link") continue;
      for (let k = 0; k < 8; k++) {
        point.set(...[0, 1, 2].map((i) => part.box[i] + part.box[3 + i] * (k >> i & 1)));
        point.applyMatrix4(stage.model.bones[part.node].matrixWorld).project(camera.camera);
        low = Math.min(low, point.y);
        high = Math.max(high, point.y);
      }
    }
    return (Math.min(1, high) - Math.max(-1, low)) / 2;
  },
};
