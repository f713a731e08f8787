// Runs the script of a replay page without a browser: whatever it asks of the page is there and
// does nothing. Prints where objects are at some times, and the volume within their triangles.
"use strict";
const fs = require("fs");
const vm = require("vm");
const [pageFile, ...times] = process.argv.slice(2);
const text = fs.readFileSync(pageFile, "utf8");
const scripts = [...text.matchAll(/<script([^>]*)>([\s\S]*?)<\/script>/g)];
const data = scripts.find(([, kind]) => kind.includes("json"))[2];

const anything = () => new Proxy(function () {}, {
  get: (target, key) => {
    if (key === Symbol.toPrimitive) return () => 0;
    if (key === Symbol.iterator) return function* () {};
    if (!(key in target)) target[key] = anything();
    return target[key];
  },
  apply: () => anything(),
  construct: () => anything(),
});
const document = anything();
const trace = { textContent: data };
document.getElementById = (id) => id === "trace" ? trace : anything();
document.createElement = () => anything();
document.createElementNS = () => anything();
document.querySelectorAll = () => [];
const page = {
  document, console, performance, setTimeout, clearTimeout,
  requestAnimationFrame: () => 0,
  ResizeObserver: class { observe() {} },
  navigator: { userAgent: "node" },
  addEventListener: () => {},
  devicePixelRatio: 1,
};
page.window = page.self = page.globalThis = page;
vm.createContext(page);
for (const [, kind, code] of scripts) if (!kind.includes("json")) vm.runInContext(code, page);
const seen = times.map((time) => {
  page.replay.seek(Number(time));
  page.replay.draw();
  return page.replay.state.objects;
});
// By the divergence theorem: negative where faces look inwards.
const volume = (mesh) => {
  const { array } = mesh.geometry.attributes.position, index = mesh.geometry.index;
  const corner = (i) => { const k = 3 * (index ? index.array[i] : i); return [array[k], array[k + 1], array[k + 2]]; };
  let sum = 0;
  for (let i = 0; i < (index ? index.count : array.length / 3); i += 3) {
    const [a, b, c] = [corner(i), corner(i + 1), corner(i + 2)];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
};
const volumes = page.replay.nodes.map((node) => {
  let sum = 0;
  node.traverse((part) => { if (part.isMesh && part.geometry.type !== "PlaneGeometry") sum += volume(part); });
  return sum;
});
console.log(JSON.stringify({ seen, volumes }));
