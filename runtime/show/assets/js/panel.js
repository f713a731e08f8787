// The column beside the scene: features over time, the sketch, its graph, subgoals, events.

const makePanel = (view, seek) => {
  const { trace, valuations } = view, $ = (id) => document.getElementById(id);
  const kinds = Object.fromEntries(trace.sketch.features.map(({ name, kind }) => [name, kind]));
  const shown = (name, value) => (kinds[name] === "bool" ? (value ? "true" : "false") : String(value));
  const long = trace.duration || 1;

  $("title").textContent = document.title;
  $("about").textContent = `${trace.source === "plan" ? "planned" : "executed"} · `
    + `${trace.planner}, seed ${trace.seed} · ${trace.subgoals.length} subgoals · ${clock(trace.duration)}`;

  // -- features ------------------------------------------------------------------------------
  const NS = "http://www.w3.org/2000/svg";
  const rows = trace.sketch.features.map(({ name, kind }) => {
    const svg = document.createElementNS(NS, "svg");
    svg.setAttribute("viewBox", "0 0 1000 100");
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("aria-hidden", "true");
    const top = Math.max(1, ...valuations.map(({ values }) => values[name]));
    const x = (t) => (1000 * t / long).toFixed(1), y = (v) => (92 - 84 * v / top).toFixed(1);
    const first = valuations.length ? valuations[0].values[name] : 0;
    const d = `M0,92V${y(first)}` + valuations.map(({ time, values }) => `H${x(time)}V${y(values[name])}`).join("") + "H1000V92";
    const line = document.createElementNS(NS, "path");
    line.setAttribute("d", d);
    const cursor = document.createElementNS(NS, "line");
    cursor.setAttribute("y1", 0);
    cursor.setAttribute("y2", 100);
    svg.append(line, cursor);
    svg.addEventListener("click", (event) => {
      const area = svg.getBoundingClientRect();
      seek(trace.duration * (event.clientX - area.left) / area.width);
    });
    const value = make("span", "value"), next = make("span", "pending");
    $("features").append(make("span", "name", name), value, next, svg);
    return { name, value, next, cursor, kind };
  });

  // -- the sketch ----------------------------------------------------------------------------
  const ruleNodes = {};
  trace.sketch.texts.forEach(({ text }, number) => {
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
  });

  // -- subgoals and events -------------------------------------------------------------------
  const listed = (time, cls) => {
    const item = make("li"), button = make("button", cls);
    button.type = "button";
    button.addEventListener("click", () => seek(time));
    item.append(button);
    return { item, button };
  };
  const items = trace.subgoals.map((goal, number) => {
    const { item, button } = listed(goal.start, "");
    const own = trace.actions.filter((action) => action.subgoal === number && action.object);
    button.append(make("span", "time", clock(goal.start)), make("span", "rule-name", goal.rule),
      `  ${own.map(({ text }) => text).join(", ") || "drive"}`);
    const names = Object.keys(goal.after).filter((name) => goal.before[name] !== goal.after[name]);
    button.append(make("span", "change", names.map((name) =>
      `${name}: ${shown(name, goal.before[name])} → ${shown(name, goal.after[name])}`).join(", ")));
    const rejected = Object.entries(goal.rejected).filter(([, count]) => count)
      .map(([step, count]) => `${count} by ${step.replaceAll("_", " ")}`).join(", ");
    button.append(make("span", "effort", `IW(${goal.width}), attempt ${goal.attempt + 1}: ${goal.expanded} expanded, `
      + `${goal.generated} generated; rejected ${rejected || "none"}`));
    $("subgoals").append(item);
    return button;
  });
  $("events-box").hidden = !trace.events.length;
  for (const event of trace.events) {
    const { item, button } = listed(event.time, isFailed(event) ? "verdict failure" : event.kind);
    button.textContent = `${clock(event.time)}  ${event.text}`;
    $("events").append(item);
  }

  // -- the graph -----------------------------------------------------------------------------
  const graph = $("graph").querySelector("svg"), tabs = [$("tab-source"), $("tab-graph")];
  const open = (which) => {
    tabs.forEach((tab, i) => {
      tab.setAttribute("aria-selected", String(i === which));
      tab.tabIndex = i === which ? 0 : -1;
    });
    $("source").hidden = which === 1;
    $("graph").hidden = which === 0;
  };
  tabs.forEach((tab, i) => tab.addEventListener("click", () => open(i)));
  $("tabs").addEventListener("keydown", (event) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    const which = event.key === "ArrowRight" ? 1 : 0;
    open(which);
    tabs[which].focus();
    event.preventDefault();
    event.stopPropagation();
  });
  tabs[1].hidden = !graph;
  open(0);
  // The box of the present valuation is lit, and the arrows of the present rule that leave it.
  const lightGraph = (values, rule) => {
    if (!graph) return;
    const key = trace.sketch.features.map(({ name }) => (values[name] > 0 ? "1" : "0")).join("");
    const here = new Set();
    for (const node of graph.querySelectorAll("[data-box]")) {
      const lit = "valuations" in node.dataset ? node.dataset.valuations.split(" ").includes(key) : node.querySelector("text").textContent === rule;
      node.classList.toggle("lit", lit);
      if (lit) here.add(node.dataset.box);
    }
    for (const edge of graph.querySelectorAll("[data-from]")) {
      edge.classList.toggle("lit", here.has(edge.dataset.from) && (edge.dataset.rules || rule).split(" ").includes(rule));
    }
  };

  // Scrolls only the two lists; scrollIntoView would move the page as well.
  const reveal = (list, node) => {
    if (!node || list.hidden) return;
    const up = node.offsetTop - list.offsetTop;
    if (up < list.scrollTop || up + node.offsetHeight > list.scrollTop + list.clientHeight) {
      list.scrollTop = up - list.clientHeight / 2 + node.offsetHeight / 2;
    }
  };
  let lit = -1;
  const light = (number) => {
    if (number === lit) return;
    lit = number;
    const goal = trace.subgoals[number];
    for (const [name, node] of Object.entries(ruleNodes)) node.classList.toggle("lit", Boolean(goal) && goal.rule === name);
    items.forEach((item, i) => {
      item.classList.toggle("lit", i === number);
      if (i === number) item.setAttribute("aria-current", "step"); else item.removeAttribute("aria-current");
    });
    reveal($("source"), goal && ruleNodes[goal.rule]);
    reveal($("subgoals"), items[number]);
  };
  const show = (t) => {
    const number = trace.subgoals.length ? current(trace.subgoals, t) : -1, { now, pending } = truth(valuations, t);
    light(number);
    for (const { name, value, next, cursor } of rows) {
      const text = name in now ? shown(name, now[name]) : "";
      if (value.textContent !== text) value.textContent = text;
      const soon = name in pending && pending[name] !== now[name] ? `→ ${shown(name, pending[name])}` : "";
      if (next.textContent !== soon) next.textContent = soon;
      const mark = 1000 * t / long;
      cursor.setAttribute("x1", mark);
      cursor.setAttribute("x2", mark);
    }
    lightGraph(now, number < 0 ? "" : trace.subgoals[number].rule);
  };
  return { show, get state() {
    return { rule: trace.subgoals[lit] ? trace.subgoals[lit].rule : null, subgoal: lit,
      lit: [...document.querySelectorAll("#source .lit")].map((node) => node.textContent),
      values: Object.fromEntries(rows.map(({ name, value }) => [name, value.textContent])) };
  } };
};
