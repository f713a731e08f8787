// The page: an editor, what is to be said of its text, a proof, a picture.
const at = (id) => document.getElementById(id);
const editor = at("editor");
const output = at("output");
const state = at("state");
const findings = at("findings");
const START = "pick_and_place";

let worker;
let examples = {};
let waiting = new Map();
let next = 0;
let timer;

function start() {
  document.body.dataset.state = "loading";
  state.textContent = "loading Python ...";
  worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
  worker.onerror = (event) => failed(event.message);
  worker.onmessage = ({ data }) => {
    if (data.ready) ready(data.examples);
    else if (data.failed) failed(data.failed);
    else {
      waiting.get(data.id)?.(data.result);
      waiting.delete(data.id);
    }
  };
}

function failed(reason) {
  document.body.dataset.state = "failed";
  state.textContent = `Python could not be loaded: ${reason}`;
}

function ready(found) {
  examples = found;
  const select = at("examples");
  if (!select.options.length) {
    for (const name of Object.keys(examples)) select.add(new Option(name, name));
    const [name, text] = wanted();
    select.value = name;
    editor.value = text;
  }
  document.body.dataset.state = "ready";
  state.textContent = "ready";
  check();
}

// A link may name an example (#pick_and_place) or hold a text (#text=...).
function wanted() {
  const hash = decodeURIComponent(location.hash.slice(1));
  if (hash.startsWith("text=")) return [START, hash.slice(5)];
  const name = hash in examples ? hash : START;
  return [name, examples[name]];
}

function ask(call, ...args) {
  return new Promise((resolve) => {
    waiting.set(next, resolve);
    worker.postMessage({ id: next, call, args });
    next += 1;
  });
}

async function busy(what, work) {
  document.body.dataset.state = "busy";
  state.textContent = `${what} ...`;
  at("stop").hidden = false;
  const result = await work;
  at("stop").hidden = true;
  document.body.dataset.state = "ready";
  state.textContent = "ready";
  return result;
}

function show(text, good) {
  output.textContent = text;
  output.className = good ? "good" : "bad";
}

function list(found) {
  findings.replaceChildren(
    ...found.map((each) => {
      const item = document.createElement("li");
      const button = document.createElement("button");
      button.className = each.severity;
      button.textContent = `${each.line}:${each.column} ${each.severity}: ${each.message}`;
      button.title = each.hint ?? "";
      button.onclick = () => {
        editor.focus();
        editor.setSelectionRange(...units(editor.value, each.start, each.end));
      };
      item.append(button);
      return item;
    }),
  );
  findings.hidden = !found.length;
}

// Python counts characters, JavaScript counts their halves where they are beyond the first 65536.
function units(text, ...places) {
  const characters = Array.from(text);
  return places.map((place) => characters.slice(0, place).join("").length);
}

async function check() {
  const text = editor.value;
  const result = await ask("check", text);
  if (text !== editor.value) return;
  list(result.findings ?? []);
}

async function format() {
  const result = await busy("formatting", ask("format_text", editor.value));
  if (result.ok) {
    editor.value = result.formatted;
    show("Formatted.", true);
    check();
  } else show(result.text, false);
}

async function prove() {
  const started = performance.now();
  const result = await busy("proving", ask("prove", editor.value));
  list(result.findings ?? []);
  show(result.text, result.ok);
  state.textContent = `ready (answered in ${((performance.now() - started) / 1000).toFixed(2)} s)`;
}

async function draw() {
  const result = await busy("drawing", ask("draw", editor.value, at("view").value));
  if (!result.ok) return show(result.text, false);
  const picture = new Image();
  picture.alt = "The graph of the sketch";
  picture.src = `data:image/svg+xml,${encodeURIComponent(result.svg)}`;
  output.className = "picture";
  output.replaceChildren(picture);
}

function stop() {
  worker.terminate();
  for (const resolve of waiting.values()) resolve({ ok: false, text: "Stopped." });
  waiting = new Map();
  start();
}

async function share() {
  location.hash = `text=${encodeURIComponent(editor.value)}`;
  await navigator.clipboard?.writeText(location.href).catch(() => {});
  show("The address of this page now holds the sketch.", true);
}

at("prove").onclick = prove;
at("format").onclick = format;
at("draw").onclick = draw;
at("stop").onclick = stop;
at("share").onclick = share;
at("examples").onchange = (event) => {
  editor.value = examples[event.target.value];
  show("", true);
  check();
};
editor.oninput = () => {
  clearTimeout(timer);
  timer = setTimeout(check, 300);
};
editor.onkeydown = (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) prove();
};
start();
