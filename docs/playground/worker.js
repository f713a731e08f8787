// Python lives here, beside the page: a long proof does not freeze it, and can be stopped.
import { loadPyodide } from "./pyodide/pyodide.mjs";

let python;

async function load() {
  const [pyodide, language, own] = await Promise.all([
    loadPyodide({ indexURL: new URL("./pyodide/", import.meta.url).href }),
    fetch(new URL("./language.zip", import.meta.url)).then((answer) => answer.arrayBuffer()),
    fetch(new URL("./playground.py", import.meta.url)).then((answer) => answer.text()),
  ]);
  pyodide.unpackArchive(language, "zip", { extractDir: "/language" });
  pyodide.runPython("import sys; sys.path.insert(0, '/language')");
  pyodide.FS.writeFile("/language/playground.py", own);
  python = pyodide.pyimport("playground");
  const examples = JSON.parse(python.examples());
  // The first check imports the rest of the language: now, not when somebody waits for it.
  python.check(Object.values(examples)[0]);
  return examples;
}

const loading = load();

loading.then(
  (examples) => postMessage({ ready: true, examples }),
  (error) => postMessage({ failed: String(error) }),
);

onmessage = async ({ data: { id, call, args } }) => {
  await loading;
  try {
    postMessage({ id, result: JSON.parse(python[call](...args)) });
  } catch (error) {
    postMessage({ id, result: { ok: false, text: `This went wrong: ${error}` } });
  }
};
