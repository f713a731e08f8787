"""How long an editor waits for diagnostics: `python -m benchmarks.editor_time`.

Wall time from a change in a sketch of 100 rules (a mistake and its repair) until the language
server has published what it found for that version, over pipes, with a real client.
"""

from __future__ import annotations

import asyncio
import statistics
import sys
import tempfile
import time
from pathlib import Path

from lsprotocol import types
from pygls.lsp.client import LanguageClient

from benchmarks.check_time import sketch
from sketchlang.lsp.protocol import uri_of

CHANGES = 40


async def run(folder: Path) -> list[float]:
    """Seconds of each change."""
    client = LanguageClient("benchmark", "1")
    arrived: asyncio.Queue[types.PublishDiagnosticsParams] = asyncio.Queue()

    @client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
    def published(params: types.PublishDiagnosticsParams) -> None:
        arrived.put_nowait(params)

    await client.start_io(sys.executable, "-m", "sketchlang", "lsp")
    await client.initialize_async(types.InitializeParams(types.ClientCapabilities()))
    client.initialized(types.InitializedParams())
    text, uri = sketch(rules=100, features=30), uri_of(str(folder / "large.sketch"))
    client.text_document_did_open(
        types.DidOpenTextDocumentParams(types.TextDocumentItem(uri, "sketch", 0, text))
    )
    while (await arrived.get()).version != 0:
        pass
    row = next(i for i, line in enumerate(text.split("\n")) if line.startswith("rule r50"))
    seconds = []
    for version in range(1, CHANGES + 1):
        # An `n` too much in a rule in the middle of the file, and away with it again.
        column = len("rule r50 ")
        start, end = types.Position(row, column), types.Position(row, column + 1 - version % 2)
        change = types.TextDocumentContentChangePartial(
            types.Range(start, end), "n" if version % 2 else ""
        )
        document = types.VersionedTextDocumentIdentifier(version, uri)
        before = time.perf_counter()
        client.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))
        while (await arrived.get()).version != version:
            pass
        seconds.append(time.perf_counter() - before)
    await client.shutdown_async(None)
    client.exit(None)
    await client.stop()
    return seconds


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        seconds = asyncio.run(run(Path(folder)))
    print(
        f"{CHANGES} changes of 100 rules: median {statistics.median(seconds) * 1000:.0f} ms, "
        f"worst {max(seconds) * 1000:.0f} ms until diagnostics are there"
    )


if __name__ == "__main__":
    main()
