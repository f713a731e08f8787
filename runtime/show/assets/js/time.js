// Values over time: tracks, spans, valuations. Seconds, metres, radians.

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

// Index of the last entry that has started, or 0.
const current = (list, t) => Math.max(0, list.findLastIndex((entry) => entry.start <= t + 1e-9));

// What is being done at a time: base and arm may be at work at once, and then it is what the hand
// does, which says more than that the base drives.
const doing = (trace, t) => {
  const running = trace.actions.filter(({ start, end }) => start <= t + 1e-9 && t < end);
  return running.findLast(({ object }) => object) || running.at(-1) || trace.actions[current(trace.actions, t)];
};

// Feature values at a time, and those that the present action is about to make.
const truth = (valuations, t) => {
  const i = Math.max(0, valuations.findLastIndex((entry) => entry.time <= t + 1e-9));
  const now = valuations.length ? valuations[i].values : {}, next = valuations[i + 1];
  return { now, pending: next && next.begun <= t + 1e-9 && t < next.time ? next.values : {} };
};

// The verdict that ends a partial plan: that and where there is no more of it.
const isFailed = (event) => event.kind === "verdict" && event.text !== "goal reached";
const failureOf = (trace) => (trace.source === "plan" ? trace.events.find(isFailed) : undefined);

const clock = (t) => `${Math.floor(t / 60)}:${String(Math.floor(t % 60)).padStart(2, "0")}`;
const smooth = (x) => { const s = Math.min(1, Math.max(0, x)); return s * s * (3 - 2 * s); };
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

const make = (tag, cls, text) => {
  const node = document.createElement(tag);
  if (cls) node.className = cls;
  if (text !== undefined) node.textContent = text;
  return node;
};
