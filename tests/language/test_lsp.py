"""The language server with a real client: pygls starts it and talks to it over pipes."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pygls")

from lsprotocol import types
from pygls import uris
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

from sketchlang.lsp.protocol import uri_of

DOMAIN = '''\
from sketchlang.domain import Domain, Nat

domain = Domain("lamps", summary="Lamps")
print("a domain that talks")


@domain.sort
class Lamp:
    """Something that shines."""


@domain.function
def lamps(state) -> frozenset[Lamp]:
    """All lamps."""
    return frozenset()


@domain.function
def lit(state, lamp: Lamp) -> bool:
    """The lamp is on."""
    return False


@domain.atom
def at(state):
    yield 1
'''
PART = """\
use lamps
# Lamps that are off.
feature n : nat = count l in lamps: not lit(l)
define dark(l : Lamp) = not lit(l)
"""
MAIN = """\
sketch s
include "part.sketch"
feature 𝐱 : bool
feature done : bool = all l in lamps: lit(l)
atoms at
goal { n = 0 }
rule r { n > 0, !done } -> { n--, done? }
"""


class Client(LanguageClient):
    """A client that keeps what the server publishes."""

    def __init__(self, folder: Path) -> None:
        super().__init__("test", "1")
        self.folder = folder
        self.versions: dict[str, int] = {}
        self.texts: dict[str, str] = {}
        self.published: asyncio.Queue[types.PublishDiagnosticsParams] = asyncio.Queue()

        @self.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def published(params: types.PublishDiagnosticsParams) -> None:
            self.published.put_nowait(params)

    def uri(self, name: str) -> str:
        return uri_of(str(self.folder / name))

    def open(self, name: str, text: str | None = None) -> None:
        path = self.folder / name
        if text is not None:
            path.write_text(text, encoding="utf-8")
        uri, self.texts[name] = self.uri(name), path.read_text(encoding="utf-8")
        self.versions[uri] = 1
        document = types.TextDocumentItem(uri, "sketch", 1, self.texts[name])
        self.text_document_did_open(types.DidOpenTextDocumentParams(document))

    def type(self, name: str, text: str) -> None:
        """Replace the whole text; the file on the disk stays as it is."""
        uri, self.texts[name] = self.uri(name), text
        self.versions[uri] += 1
        document = types.VersionedTextDocumentIdentifier(self.versions[uri], uri)
        change = types.TextDocumentContentChangeWholeDocument(text)
        self.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))

    async def findings(self, name: str) -> list[types.Diagnostic]:
        """What is published for the version of a document that is open now."""
        uri = self.uri(name)
        while True:
            params = await asyncio.wait_for(self.published.get(), 30)
            if params.uri == uri and params.version == self.versions[uri]:
                return list(params.diagnostics)

    def place(self, name: str, before: str, here: str = "") -> dict[str, Any]:
        """The place of `here` behind the text `before`."""
        offset = self.texts[name].index(before + here) + len(before)
        lines = self.texts[name][:offset].split("\n")
        column = len(lines[-1].encode("utf-16-le")) // 2
        return {
            "text_document": types.TextDocumentIdentifier(self.uri(name)),
            "position": types.Position(len(lines) - 1, column),
        }


Story = Callable[[Client], Awaitable[None]]


class Session:
    """One server for all tests, started as editors start it; every test has its own folder."""

    def __init__(self, root: Path) -> None:
        self.runner = asyncio.Runner()
        self.client = Client(root)
        self.runner.run(self._start(root))

    async def _start(self, root: Path) -> None:
        (root / "lamps.py").write_text(DOMAIN, encoding="utf-8")
        run = "from sketchlang.cli import main; main()"
        command = ["-c", run, "lsp", "--domain", str(root / "lamps.py")]
        await self.client.start_io(sys.executable, *command)
        started = await self.client.initialize_async(
            types.InitializeParams(types.ClientCapabilities())
        )
        assert started.server_info is not None
        assert started.server_info.name == "sketchlang"
        self.client.initialized(types.InitializedParams())

    def tell(self, folder: Path, story: Story) -> None:
        self.client.folder = folder
        self.runner.run(self._tell(story))

    async def _tell(self, story: Story) -> None:
        await story(self.client)
        for uri in self.client.versions:
            document = types.TextDocumentIdentifier(uri)
            self.client.text_document_did_close(types.DidCloseTextDocumentParams(document))
        self.client.versions.clear()

    async def _stop(self) -> None:
        await self.client.shutdown_async(None)
        self.client.exit(None)
        await self.client.stop()

    def stop(self) -> None:
        self.runner.run(self._stop())
        self.runner.close()


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    made = Session(tmp_path_factory.mktemp("domain"))
    yield made
    made.stop()


@pytest.fixture
def folder(tmp_path: Path, session: Session) -> Path:
    (tmp_path / "lamps.py").write_text(DOMAIN, encoding="utf-8")
    (tmp_path / "part.sketch").write_text(PART, encoding="utf-8")
    (tmp_path / "main.sketch").write_text(MAIN.replace("𝐱", "x"), encoding="utf-8")
    return tmp_path


def changed(text: str, edits: list[types.TextEdit]) -> str:
    """A text with edits of an editor; its columns are UTF-16."""
    lines = text.split("\n")
    for edit in sorted(edits, key=lambda e: (e.range.start.line, e.range.start.character))[::-1]:
        first, last = edit.range.start, edit.range.end
        before = lines[first.line].encode("utf-16-le")[: 2 * first.character].decode("utf-16-le")
        after = lines[last.line].encode("utf-16-le")[2 * last.character :].decode("utf-16-le")
        lines[first.line : last.line + 1] = (before + edit.new_text + after).split("\n")
    return "\n".join(lines)


def test_diagnostics_follow_what_is_typed(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")
        text = client.texts["main.sketch"]
        assert {one.code for one in await client.findings("main.sketch")} == {
            "unused-feature",
            "unused-define",
        }
        client.type("main.sketch", text.replace("n--", "n -= 1"))
        (one,) = await client.findings("main.sketch")
        assert (one.code, one.severity) == ("foreign-notation", types.DiagnosticSeverity.Error)
        assert "Write `n--`." in one.message
        client.type("main.sketch", text.replace("all l in", "all l in in"))
        assert (await client.findings("main.sketch"))[0].range.start.line == 3

    session.tell(folder, story)


def test_what_is_not_saved_counts_where_it_is_included(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")
        await client.findings("main.sketch")
        client.open("part.sketch")
        client.type("part.sketch", PART.replace("feature n", "feature m"))
        while True:
            found = await client.findings("main.sketch")
            if "undefined-feature" in [one.code for one in found]:
                break

    session.tell(folder, story)


def test_a_mistake_in_an_included_file(folder: Path, session: Session) -> None:
    (folder / "part.sketch").write_text(PART.replace("count l", "count"), encoding="utf-8")

    async def story(client: Client) -> None:
        client.open("main.sketch")
        found = await client.findings("main.sketch")
        (one,) = [one for one in found if one.message.startswith("part.sketch: ")]
        assert one.range.start == types.Position(1, 8)
        assert one.related_information is not None
        assert one.related_information[0].location.uri == client.uri("part.sketch")

    session.tell(folder, story)


def test_hover(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")
        client.open("part.sketch")

        async def shown(name: str, before: str, here: str) -> str:
            params = types.HoverParams(**client.place(name, before, here))
            found = await client.text_document_hover_async(params)
            assert found is not None, (before, here)
            assert isinstance(found.contents, types.MarkupContent)
            return found.contents.value

        feature = await shown("main.sketch", "goal { ", "n")
        assert "feature n : nat = count l in lamps: not lit(l)" in feature
        assert "Lamps that are off." in feature
        assert "in `r` it falls" in feature
        assert "The sketch terminates." in feature
        assert "r fires only finitely often: it lowers n" in feature
        assert "n" in await shown("main.sketch", "rule ", "r ")
        assert "lit(Lamp) : bool" in await shown("main.sketch", "lamps: ", "lit")
        assert "The lamp is on." in await shown("main.sketch", "lamps: ", "lit")
        assert "l : Lamp" in await shown("main.sketch", "lit(", "l")
        assert "Something that shines." in await shown("part.sketch", "(l : ", "Lamp")
        assert "All lamps." in await shown("part.sketch", "use ", "lamps")

    session.tell(folder, story)


def test_definitions_lead_through_includes_and_into_python(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")

        async def line(before: str, here: str, file: str) -> str:
            params = types.DefinitionParams(**client.place("main.sketch", before, here))
            found = await client.text_document_definition_async(params)
            assert isinstance(found, types.Location), (before, here)
            home = Path(uris.to_fs_path(found.uri) or "")
            assert home.name == file
            lines = home.read_text(encoding="utf-8").splitlines()
            return lines[found.range.start.line][found.range.start.character :]

        assert (await line("goal { ", "n", "part.sketch")).startswith("n : nat")
        assert (await line("lamps: ", "lit", "lamps.py")).startswith("def lit")
        assert (await line("atoms ", "at", "lamps.py")).startswith("def at")
        assert (await line("lit(", "l", "main.sketch")).startswith("l in lamps")
        assert (await line("include ", '"part', "part.sketch")).startswith("use lamps")

    session.tell(folder, story)


COMPLETIONS: list[tuple[str, set[str], set[str]]] = [
    ("goal { |", {"n = 0", "!done"}, {"n--", "lit"}),
    ("rule q { n > 0 } -> { |", {"n--", "done?", "!n++"}, {"n = 0"}),
    ("feature k : |", {"bool", "nat"}, {"lit", "Lamp"}),
    ("feature k : bool = some l in |", {"lamps"}, {"lit", "done"}),
    ("feature k : bool = some l in lamps: |", {"l", "lit", "done", "dark", "not"}, {"goal"}),
    ("define far(x : |", {"bool", "Lamp"}, {"lit"}),
    ("use |", {"delivery", "tabletop"}, {"n"}),
    ("include |", {"pick_and_place"}, {"n"}),
    ("atoms |", {"at"}, {"n"}),
    ("ru|", {"rule", "feature"}, {"n"}),
    ("# in a comment |", set(), {"rule"}),
]
"""What is written (the cursor at the bar), what has to be proposed there, and what must not be."""


def test_completion(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")
        text = client.texts["main.sketch"]
        for written, wanted, unwanted in COMPLETIONS:
            whole = text + written.replace("|", "")
            client.type("main.sketch", whole)
            place = client.place("main.sketch", whole)
            found = await client.text_document_completion_async(types.CompletionParams(**place))
            assert isinstance(found, list)
            labels = {one.label for one in found}
            assert wanted <= labels, written
            assert not unwanted & labels, written

    session.tell(folder, story)


def test_renaming_reaches_all_files(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("part.sketch")
        params = types.RenameParams(
            **client.place("part.sketch", "feature ", "n"), new_name="left_over"
        )
        found = await client.text_document_rename_async(params)
        assert found is not None
        assert found.changes is not None
        texts = {
            uri: changed((folder / Path(uri).name).read_text(encoding="utf-8"), list(edits))
            for uri, edits in found.changes.items()
        }
        assert texts[client.uri("part.sketch")] == PART.replace("feature n", "feature left_over")
        main = (folder / "main.sketch").read_text(encoding="utf-8")
        for old, new in (
            ("n = 0", "left_over = 0"),
            ("n > 0", "left_over > 0"),
            ("n--", "left_over--"),
        ):
            main = main.replace(old, new)
        assert texts[client.uri("main.sketch")] == main
        for name in ("goal", "n-x", "lit", "done"):
            params = types.RenameParams(
                **client.place("part.sketch", "feature ", "n"), new_name=name
            )
            if name == "done":
                client.open("main.sketch")
            with pytest.raises(JsonRpcException):
                await client.text_document_rename_async(params)

    session.tell(folder, story)


def test_a_variable_is_renamed_where_it_is_bound(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")
        params = types.RenameParams(**client.place("main.sketch", "lit(", "l"), new_name="lamp")
        found = await client.text_document_rename_async(params)
        assert found is not None
        assert found.changes is not None
        (edits,) = found.changes.values()
        text = changed(client.texts["main.sketch"], list(edits))
        assert "all lamp in lamps: lit(lamp)" in text

    session.tell(folder, story)


def test_formatting_and_quick_fixes(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")
        good = client.texts["main.sketch"]
        client.type("main.sketch", good.replace("goal { n = 0 }", "goal   {n=0}"))
        document = types.TextDocumentIdentifier(client.uri("main.sketch"))
        options = types.FormattingOptions(4, True)
        edits = await client.text_document_formatting_async(
            types.DocumentFormattingParams(document, options)
        )
        assert edits is not None
        assert changed(client.texts["main.sketch"], list(edits)) == good

        bad = good.replace("goal { n = 0 }", "goal: n == 0").replace("lit(l)", "lid(l)")
        bad = bad.replace("done?", "𝐱?").replace("𝐱?", "done := true")
        client.type("main.sketch", bad)
        while found := await client.findings("main.sketch"):
            one = found[0]
            context = types.CodeActionContext([one])
            actions = await client.text_document_code_action_async(
                types.CodeActionParams(document, one.range, context)
            )
            fixes = [one for one in actions or [] if isinstance(one, types.CodeAction)]
            if not fixes:
                break
            assert fixes[0].edit is not None
            assert fixes[0].edit.changes is not None
            edits = fixes[0].edit.changes[client.uri("main.sketch")]
            client.type("main.sketch", changed(client.texts["main.sketch"], list(edits)))
        wanted = good.replace("done? }", "done }")
        assert client.texts["main.sketch"] == wanted

    session.tell(folder, story)


def test_columns_are_counted_as_the_client_counts_them(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch", MAIN.replace("feature 𝐱 : bool", "# 𝐱𝐱\n"))
        text = client.texts["main.sketch"].replace("goal { n = 0 }", "goal { n = 0, # 𝐱\nm = 0 }")
        client.type("main.sketch", text.replace("atoms at", "atoms at # 𝐱𝐱𝐱"))
        (one,) = [
            one for one in await client.findings("main.sketch") if one.code == "undefined-feature"
        ]
        assert one.range.start.character == 0
        client.type("main.sketch", MAIN)
        (one,) = [one for one in await client.findings("main.sketch") if one.range.start.line == 2]
        assert (one.range.start.character, one.range.end.character) == (8, 10)

    session.tell(folder, story)


def test_outline_and_references(folder: Path, session: Session) -> None:
    async def story(client: Client) -> None:
        client.open("main.sketch")
        document = types.TextDocumentIdentifier(client.uri("main.sketch"))
        symbols = await client.text_document_document_symbol_async(
            types.DocumentSymbolParams(document)
        )
        assert [one.name for one in symbols or []] == ["s", "x", "done", "goal", "r"]
        params = types.ReferenceParams(
            context=types.ReferenceContext(True), **client.place("main.sketch", "goal { ", "n")
        )
        found = await client.text_document_references_async(params)
        assert sorted(Path(one.uri).name for one in found or []) == ["main.sketch"] * 3 + [
            "part.sketch"
        ]

    session.tell(folder, story)
