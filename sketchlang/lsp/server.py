"""The language server: requests of an editor, answered by the plain functions of this package."""

from __future__ import annotations

import asyncio
import sys
from typing import Any, Protocol

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.workspace.position_codec import PositionCodec

from sketchlang.lsp import completion, definition, edits, hover, protocol
from sketchlang.lsp.state import Document, Workspace
from sketchlang.lsp.symbols import Occurrence, at
from sketchlang.source import Source, Span
from sketchlang.syntax import tree
from sketchlang.version import __version__

PAUSE = 0.01
"""Seconds without a change after which a text is checked: whoever types goes on typing."""

ANALYSES_PAUSE = 0.4
"""Seconds after which analyses are made as well."""


class Place(Protocol):
    """What all requests about a place have."""

    text_document: types.TextDocumentIdentifier
    position: types.Position


class SketchServer(LanguageServer):
    """The server, and what it knows of the documents that are open."""

    def __init__(self, domain_file: str | None = None) -> None:
        super().__init__("sketchlang", __version__)
        self.known = Workspace(domain_file)
        self.waiting: dict[str, asyncio.Task[None]] = {}
        self.complained: str | None = None

    @property
    def codec(self) -> PositionCodec:
        """How the client counts columns."""
        return self.workspace.position_codec

    def document(self, uri: str) -> Document:
        """The document as it is now."""
        path = protocol.path_of(uri)
        text = self.workspace.get_text_document(uri).source
        known = self.known.documents.get(path)
        if known is None or known.source.text != text:
            known = self.known.look(path, text)
        return known

    def name_at(self, params: Place) -> tuple[Document, Occurrence | None]:
        """The document of a request, and the name at its place."""
        document = self.document(params.text_document.uri)
        offset = protocol.offset_of(document.source, params.position, self.codec)
        return document, at(document.names, document.source.name, offset)

    def tell(self, uri: str, analyses: bool) -> None:
        """Publish what is found in a document, and say if the domain's file cannot be used."""
        document = self.document(uri)
        if self.known.trouble not in (None, self.complained):
            message = types.ShowMessageParams(types.MessageType.Error, self.known.trouble or "")
            self.window_show_message(message)
        self.complained = self.known.trouble
        found = [*document.loaded.diagnostics, *(document.warnings if analyses else ())]
        shown = [protocol.diagnostic(one, document.loaded.tree, self.codec) for one in found]
        version = self.workspace.get_text_document(uri).version
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri, shown, version=version)
        )

    async def check(self, uri: str, pause: float) -> None:
        """Check a document as soon as nothing changes any more, and then those that include it."""
        await asyncio.sleep(pause)
        self.tell(uri, analyses=False)
        path = protocol.path_of(uri)
        for other in self.known.dependants(path):
            self.known.look(other, self.known.documents[other].source.text)
            self.tell(protocol.uri_of(other), analyses=False)
        await asyncio.sleep(ANALYSES_PAUSE)
        document = self.document(uri)
        # Elsewhere: whoever types on meanwhile must not wait for it.
        await asyncio.to_thread(getattr, document, "warnings")
        if self.document(uri) is document:
            self.tell(uri, analyses=True)

    def soon(self, uri: str, pause: float = PAUSE) -> None:
        """Have a document checked, instead of the check that it still waits for."""
        waiting = self.waiting.pop(uri, None)
        if waiting is not None:
            waiting.cancel()
        self.waiting[uri] = asyncio.ensure_future(self.check(uri, pause))


def make(domain_file: str | None = None) -> SketchServer:
    """A server with all its features."""
    server = SketchServer(domain_file)
    _follow_documents(server)
    _answer_questions(server)
    _make_edits(server)
    return server


def serve(domain_file: str | None = None) -> None:
    """Serve one client on standard input and output, until it says that it leaves."""
    client = sys.stdout.buffer
    # What a domain prints must not get between the messages.
    sys.stdout = sys.stderr
    make(domain_file).start_io(sys.stdin.buffer, client)


def _follow_documents(server: SketchServer) -> None:
    @server.feature(types.INITIALIZE)
    def initialize(params: types.InitializeParams) -> None:
        options: Any = params.initialization_options
        if isinstance(options, dict) and isinstance(options.get("domain"), str):
            server.known.domain_file = options["domain"] or server.known.domain_file

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    async def opened(params: types.DidOpenTextDocumentParams) -> None:
        server.soon(params.text_document.uri, 0)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    async def changed(params: types.DidChangeTextDocumentParams) -> None:
        server.soon(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    async def saved(params: types.DidSaveTextDocumentParams) -> None:
        # The domain's Python file may have changed as well.
        for path in list(server.known.documents):
            server.known.look(path, server.known.documents[path].source.text)
            server.soon(protocol.uri_of(path))

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    async def closed(params: types.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        waiting = server.waiting.pop(uri, None)
        if waiting is not None:
            waiting.cancel()
        server.known.close(protocol.path_of(uri))
        server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))


def _answer_questions(server: SketchServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hovered(params: types.HoverParams) -> types.Hover | None:
        document, found = server.name_at(params)
        text = hover.text(document, found) if found is not None else None
        if found is None or not text:
            return None
        markup = types.MarkupContent(types.MarkupKind.Markdown, text)
        return types.Hover(markup, protocol.range_of(document.source, found.span, server.codec))

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def define(params: types.DefinitionParams) -> types.Location | None:
        document, found = server.name_at(params)
        label = definition.place(document, found) if found is not None else None
        return protocol.location(label, server.codec) if label is not None else None

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    def refer(params: types.ReferenceParams) -> list[types.Location]:
        document, found = server.name_at(params)
        if found is None:
            return []
        related = server.known.related(document.source.name, server.workspace.root_path)
        return [protocol.location(label, server.codec) for label in edits.uses(found, related)]

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def outline(params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        document = server.document(params.text_document.uri)
        return _outline(document, document.source, server.codec)

    @server.feature(
        types.TEXT_DOCUMENT_COMPLETION,
        types.CompletionOptions(trigger_characters=[" ", "(", "{", ",", ":"]),
    )
    def complete(params: types.CompletionParams) -> list[types.CompletionItem]:
        document = server.document(params.text_document.uri)
        source = document.source
        offset = protocol.offset_of(source, params.position, server.codec)
        word = completion.word_before(source.text, offset)
        where = protocol.range_of(source, word, server.codec)
        found = completion.proposals(document, offset)
        return [protocol.completion(one, where) for one in found]


def _make_edits(server: SketchServer) -> None:
    @server.feature(types.TEXT_DOCUMENT_FORMATTING)
    def form(params: types.DocumentFormattingParams) -> list[types.TextEdit]:
        source = server.document(params.text_document.uri).source
        text = edits.formatted(source)
        if text is None or text == source.text:
            return []
        return [types.TextEdit(protocol.range_of(source, edits.whole(source), server.codec), text)]

    @server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare(params: types.PrepareRenameParams) -> types.Range | None:
        document, found = server.name_at(params)
        if found is None or found.target.kind not in edits.RENAMED:
            return None
        return protocol.range_of(document.source, found.span, server.codec)

    @server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    def rename(params: types.RenameParams) -> types.WorkspaceEdit | None:
        document, found = server.name_at(params)
        if found is None:
            return None
        declared = definition.place(document, found)
        home = declared.source.name if declared is not None else document.source.name
        related = server.known.related(home, server.workspace.root_path)
        try:
            places = edits.rename(found, params.new_name, related)
        except edits.RefusedError as refused:
            raise JsonRpcInvalidParams(str(refused)) from None
        changes: dict[str, list[types.TextEdit]] = {}
        for place in places:
            where = protocol.location(place, server.codec)
            changes.setdefault(where.uri, []).append(types.TextEdit(where.range, params.new_name))
        return types.WorkspaceEdit(changes=changes)

    @server.feature(
        types.TEXT_DOCUMENT_CODE_ACTION,
        types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix]),
    )
    def mend(params: types.CodeActionParams) -> list[types.CodeAction]:
        document = server.document(params.text_document.uri)
        found = document.loaded.diagnostics
        return protocol.quick_fixes(found, document.loaded.tree, params.range, server.codec)


_SYMBOLS: dict[type, types.SymbolKind] = {
    tree.FeatureItem: types.SymbolKind.Field,
    tree.Define: types.SymbolKind.Function,
    tree.RuleItem: types.SymbolKind.Event,
    tree.Title: types.SymbolKind.Module,
}


def _outline(
    document: Document, source: Source, codec: PositionCodec
) -> list[types.DocumentSymbol]:
    symbols = []
    for item in document.loaded.tree.items:
        kind = _SYMBOLS.get(type(item))
        name = getattr(item, "name", None)
        span: Span = item.span
        if isinstance(item, tree.Goal):
            kind, name = types.SymbolKind.Constant, tree.Name("goal", item.span)
        if kind is None or not isinstance(name, tree.Name):
            continue
        symbols.append(
            types.DocumentSymbol(
                name.text,
                kind,
                protocol.range_of(source, span, codec),
                protocol.range_of(source, name.span, codec),
            )
        )
    return symbols
