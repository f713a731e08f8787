// The clock, the controls and the keys. All that is seen is a function of the time; playing only
// moves the time.

const makePlayer = (views, duration, timeOf) => {
  const $ = (id) => document.getElementById(id), first = views[0].trace;
  let now = 0, playing = false, speed = 4, stale = true, frames = 0, panel = null;
  const redraw = () => { stale = true; };

  const seek = (t) => {
    now = clamp(t, 0, duration);
    redraw();
    if (!playing) remember();
  };
  // The address of a page that stands still is a link to this moment.
  let noted = "";
  const remember = () => {
    const mark = `#t=${now.toFixed(1)}`;
    if (mark === noted) return;
    noted = mark;
    try { history.replaceState(null, "", mark); } catch { /* a page without an address of its own */ }
  };
  const fromAddress = () => {
    const found = /[#&]t=([\d.]+)/.exec(location.hash);
    if (found && location.hash !== noted) seek(Number(found[1]));
  };
  addEventListener("hashchange", fromAddress);

  const play = (on = true) => {
    if (on && now >= duration) seek(0);
    playing = on;
    $("play").textContent = on ? "❚❚" : "▶";
    $("play").setAttribute("aria-label", on ? "Pause" : "Play");
    if (!on) remember();
  };
  const jump = (step) => {
    const t = timeOf(0, now), i = current(first.subgoals, t), here = first.subgoals[i];
    const back = step < 0 && here && t - here.start > 1.5; // first to the start of this one
    const goal = first.subgoals[i + (back ? 0 : step)];
    seek(goal ? goal.start * (duration / (timeOf(0, duration) || 1)) : step < 0 ? 0 : duration);
  };
  const pick = (name) => {
    views.forEach(({ camera }) => camera.choose(name));
    $("camera").value = name;
    redraw();
  };
  const turn = (box, on = !box.checked) => { box.checked = on; box.dispatchEvent(new Event("change")); };

  // -- controls ------------------------------------------------------------------------------
  for (const factor of [0.5, 1, 2, 4, 8, 16, 32]) {
    const option = make("option", "", `${factor}×`);
    option.value = factor;
    option.selected = factor === speed;
    $("speed").append(option);
  }
  for (const name of VIEWS) {
    const option = make("option", "", name);
    option.value = name;
    $("camera").append(option);
  }
  $("seek").max = duration;
  for (const goal of first.subgoals) {
    const tick = make("i");
    tick.style.left = `${100 * goal.start / (timeOf(0, duration) || 1)}%`;
    $("ticks").append(tick);
  }
  $("play").addEventListener("click", () => play(!playing));
  $("back").addEventListener("click", () => jump(-1));
  $("forward").addEventListener("click", () => jump(1));
  $("seek").addEventListener("input", () => seek(Number($("seek").value)));
  $("speed").addEventListener("change", () => { speed = Number($("speed").value); redraw(); });
  $("camera").addEventListener("change", () => pick($("camera").value));
  $("labels").addEventListener("change", () => { views.forEach(({ label }) => label($("labels").checked)); redraw(); });
  $("solids").addEventListener("change", () => { views.forEach(({ stage }) => { stage.solids.visible = $("solids").checked; }); redraw(); });
  const paint = (dark) => {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    views.forEach(({ stage }) => stage.paint(dark ? "dark" : "light"));
    redraw();
  };
  $("dark").addEventListener("change", () => paint($("dark").checked));
  $("help").addEventListener("click", () => $("keys").showModal());
  for (const { camera } of views) {
    camera.orbit.addEventListener("start", () => { if (camera.mode !== "follow" && camera.mode !== "gripper") pick("free"); });
    camera.orbit.addEventListener("change", redraw);
  }
  // What was clicked does not keep the focus: space plays and pauses, it does not click again.
  // A click by keyboard (detail 0) keeps it, or tab would start anew.
  $("controls").addEventListener("click", (event) => {
    if (event.detail && event.target.matches("button, input[type=checkbox]")) event.target.blur();
  });
  document.addEventListener("keydown", (event) => {
    const { key, target } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || target.matches("select") || $("keys").open) return;
    if (key === " " && target.matches("button, input[type=checkbox]")) return; // presses it
    if (key === "Enter") return;
    const step = event.shiftKey ? 10 : 1;
    const act = {
      " ": () => play(!playing), PageUp: () => jump(-1), PageDown: () => jump(1), Home: () => seek(0), End: () => seek(duration),
      ArrowLeft: () => seek(now - step), ArrowRight: () => seek(now + step),
      "?": () => $("keys").showModal(), c: () => pick(VIEWS[(VIEWS.indexOf($("camera").value) + 1) % 5]),
      n: () => turn($("labels")), b: () => turn($("solids")), d: () => turn($("dark")),
    }[key];
    if (act) { act(); event.preventDefault(); }
  });
  $("dark").checked = matchMedia("(prefers-color-scheme: dark)").matches;
  paint($("dark").checked);

  // -- drawing -------------------------------------------------------------------------------
  const show = () => {
    views.forEach((view, i) => view.show(timeOf(i, now), speed));
    if (panel) panel.show(timeOf(0, now));
    $("clock").textContent = `${clock(now)} / ${clock(duration)}`;
    $("seek").value = now;
    const goal = first.subgoals[current(first.subgoals, timeOf(0, now))];
    $("seek").setAttribute("aria-valuetext", `${clock(now)} of ${clock(duration)}${goal ? `, ${goal.rule}` : ""}`);
    document.body.style.setProperty("--done", now / (duration || 1));
  };
  const draw = () => {
    show();
    views.forEach((view) => view.draw());
    frames += 1;
  };
  const observer = new ResizeObserver(() => { views.forEach(({ fit }) => fit()); redraw(); });
  views.forEach(({ canvas, fit }) => { observer.observe(canvas); fit(); });
  let before = performance.now();
  const frame = (stamp) => {
    const passed = clamp((stamp - before) / 1000, 0, 0.1); // no leap after a pause of the page
    before = stamp;
    if (playing) {
      now = Math.min(duration, now + speed * passed);
      stale = true;
      if (now >= duration) play(false);
    }
    if (stale) { // a page that stands still costs nothing
      stale = false;
      draw();
    }
    requestAnimationFrame(frame);
  };
  const start = (made) => {
    panel = made;
    pick("auto");
    const failure = failureOf(first);
    seek(failure ? failure.time : Number(document.body.dataset.start));
    fromAddress();
    show();
    requestAnimationFrame(frame);
  };
  return {
    start, seek, play, pick, draw, paint: (dark) => turn($("dark"), dark), redraw,
    speed: (factor) => { speed = factor; $("speed").value = factor; redraw(); },
    get time() { return now; }, get playing() { return playing; }, get frames() { return frames; }, get fresh() { return !stale; },
  };
};
