// Runs the script of a replay page without a browser: whatever it asks of the page is there and
// does nothing. Prints what `replay.state` says at some times, or the error.
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
console.log(JSON.stringify(seen));
