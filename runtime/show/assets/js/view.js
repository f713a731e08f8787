// One trace on one canvas, with what is written over it.

const makeView = ({ trace, scene, valuations }, box) => {
  const canvas = box.querySelector("canvas"), caption = box.querySelector(".caption"), chips = box.querySelector(".chips");
  const stage = makeStage(canvas, trace, scene), camera = makeCamera(stage, canvas);
  const tip = box.querySelector(".tip"), names = box.querySelector(".names");
  const kinds = Object.fromEntries(trace.sketch.features.map(({ name, kind }) => [name, kind]));
  const shown = (name, value) => (kinds[name] === "bool" ? (value ? "true" : "false") : String(value));
  if (!stage.renderer) {
    const failure = box.querySelector(".failure");
    failure.hidden = false;
    failure.textContent = "This browser cannot show 3D graphics (WebGL 2); the rest of the page works.";
  }
  const values = trace.sketch.features.map(({ name }) => {
    const chip = make("span", "chip"), value = make("b");
    chip.append(make("i", "", name), value);
    chips.append(chip);
    return { name, chip, value };
  });

  // -- names of things -----------------------------------------------------------------------
  const wants = {};
  const note = (goal) => {
    if (goal.kind === "any") goal.goals.forEach(note);
    else if (goal.kind === "on" || goal.kind === "at") wants[goal.body] = `to ${goal.support}`;
    else if (goal.kind === "held") wants[goal.body] = "to be held";
  };
  trace.world.goals.forEach(note);
  const onScreen = new T.Vector3();
  const project = (bone) => {
    onScreen.setFromMatrixPosition(bone.matrixWorld).project(camera.camera);
    return onScreen.z < 1 && [(onScreen.x + 1) / 2 * canvas.clientWidth, (1 - onScreen.y) / 2 * canvas.clientHeight];
  };
  const tags = trace.world.objects.map(({ name }) => {
    const tag = make("span", "tag", name);
    names.append(tag);
    return tag;
  });
  let labelled = false;
  const placeNames = () => {
    names.hidden = !labelled;
    if (!labelled) return;
    tags.forEach((tag, i) => {
      const spot = project(stage.model.objects[i]);
      tag.hidden = !spot;
      if (spot) tag.style.transform = `translate(${spot[0].toFixed(1)}px, ${spot[1].toFixed(1)}px) translate(-50%, -160%)`;
    });
  };
  const direction = new T.Vector3();
  canvas.addEventListener("pointermove", (event) => {
    tip.hidden = true;
    if (event.buttons) return;
    const area = canvas.getBoundingClientRect(), x = event.clientX - area.left, y = event.clientY - area.top;
    direction.set(2 * x / area.width - 1, 1 - 2 * y / area.height, 0.5).unproject(camera.camera).sub(camera.camera.position).normalize();
    const hit = stage.pointed(camera.camera.position, direction);
    if (!hit) return;
    tip.textContent = hit.name + (wants[hit.name] ? ` · ${wants[hit.name]}` : "");
    tip.style.transform = `translate(${x}px, ${y}px) translate(-50%, -180%)`;
    tip.hidden = false;
  });
  canvas.addEventListener("pointerleave", () => { tip.hidden = true; });

  const failure = failureOf(trace);
  const write = (t) => {
    const action = doing(trace, t), { now, pending } = truth(valuations, t);
    caption.replaceChildren(...(failure && t >= failure.time
      ? [make("b", "", "no plan"), make("span", "", failure.text)] : action
      ? [make("b", "", trace.subgoals[action.subgoal].rule), make("span", "", action.text)] : [make("span", "", "nothing to do")]));
    for (const { name, chip, value } of values) {
      const soon = name in pending && pending[name] !== now[name];
      const text = (name in now ? shown(name, now[name]) : "") + (soon ? ` → ${shown(name, pending[name])}` : "");
      if (value.textContent !== text) value.textContent = text;
      chip.classList.toggle("soon", soon);
    }
  };
  const show = (t, speed) => {
    stage.pose(t);
    camera.aim(t, speed);
    write(t);
  };
  const draw = () => {
    stage.draw(camera.camera);
    placeNames();
  };
  const fit = () => {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!stage.renderer || !width || !height) return;
    stage.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    stage.renderer.setSize(width, height, false);
    camera.fit(width, height);
  };
  const label = (on) => { labelled = on; };
  return { trace, valuations, canvas, stage, camera, show, draw, fit, label };
};
