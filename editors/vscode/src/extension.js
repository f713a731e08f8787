// Starts `sketchlang lsp` and connects VS Code with it.
const vscode = require("vscode");
const { LanguageClient, TransportKind } = require("vscode-languageclient/node");

let client;

function settings() {
  const found = vscode.workspace.getConfiguration("sketchlang");
  return { command: found.get("command") || "sketchlang", domain: found.get("domain") || "" };
}

async function start() {
  const { command, domain } = settings();
  const server = { command, args: ["lsp"], transport: TransportKind.stdio };
  client = new LanguageClient("sketchlang", "Sketch", server, {
    documentSelector: [{ language: "sketch" }],
    initializationOptions: { domain },
  });
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    vscode.window.showErrorMessage(
      `"${command} lsp" could not be started. Install it with: pip install "sketchlang[lsp]", ` +
        "or set sketchlang.command to its path."
    );
  }
}

async function stop() {
  const running = client;
  client = undefined;
  if (running) {
    await running.stop();
  }
}

function terminate() {
  const editor = vscode.window.activeTextEditor;
  if (!editor || editor.document.languageId !== "sketch") {
    return;
  }
  const { command, domain } = settings();
  const args = ["terminate", editor.document.fileName, ...(domain ? ["--domain", domain] : [])];
  const execution = new vscode.ProcessExecution(command, args);
  const task = new vscode.Task(
    { type: "sketchlang" },
    vscode.TaskScope.Workspace,
    "terminate",
    "sketchlang",
    execution
  );
  vscode.tasks.executeTask(task);
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("sketchlang.terminate", terminate),
    vscode.commands.registerCommand("sketchlang.restart", async () => {
      await stop();
      await start();
    }),
    vscode.workspace.onDidChangeConfiguration(async (change) => {
      if (change.affectsConfiguration("sketchlang")) {
        await stop();
        await start();
      }
    })
  );
  await start();
}

module.exports = { activate, deactivate: stop };
