// Two plans in figures, beside each other.

const compare = (views) => {
  const rows = [
    ["sketch", ({ sketch }) => sketch.name], ["planner", ({ planner }) => planner], ["seed", ({ seed }) => seed],
    ["robot", ({ robot }) => robot.name], ["time", ({ duration }) => `${duration.toFixed(1)} s`],
    ["subgoals", ({ subgoals }) => subgoals.length], ["actions", ({ actions }) => actions.length],
    ["grips", ({ grips }) => grips.filter(({ attach }) => attach).length],
    ["base drives", ({ base }) => `${base.values.slice(1).reduce((sum, [x, y], i) => sum + Math.hypot(x - base.values[i][0], y - base.values[i][1]), 0).toFixed(1)} m`],
    ["nodes", ({ subgoals }) => subgoals.reduce((sum, goal) => sum + goal.generated, 0)],
  ];
  const table = document.getElementById("figures"), head = table.insertRow();
  for (const text of ["", "left", "right"]) {
    const cell = make("th", "", text);
    cell.scope = "col";
    head.append(text ? cell : make("td"));
  }
  for (const [name, value] of rows) {
    const row = table.insertRow(), title = make("th", "", name);
    title.scope = "row";
    row.append(title);
    for (const { trace } of views) row.insertCell().textContent = value(trace);
  }
};
