"""Our places and findings in the words of the protocol, and back.

Files are paths here and URIs there; places are offsets in characters here, and there lines with
columns in the units that client and server have agreed on.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from lsprotocol import types
from pygls import uris
from pygls.workspace.position_codec import PositionCodec

from sketchlang.diagnostics import Diagnostic, Label, Severity
from sketchlang.lsp.completion import Proposal
from sketchlang.lsp.edits import fix_of, title_of
from sketchlang.source import Source, Span
from sketchlang.syntax import tree

_KINDS = {
    "keyword": types.CompletionItemKind.Keyword,
    "module": types.CompletionItemKind.Module,
    "file": types.CompletionItemKind.File,
    "value": types.CompletionItemKind.Value,
    "field": types.CompletionItemKind.Field,
    "class": types.CompletionItemKind.Class,
    "variable": types.CompletionItemKind.Variable,
    "function": types.CompletionItemKind.Function,
}


def path_of(uri: str) -> str:
    """The path of a document; one that was never saved has its URI for one."""
    return uris.to_fs_path(uri) or uri


def uri_of(path: str) -> str:
    """The URI of a path."""
    return uris.from_fs_path(str(Path(path).absolute())) or path


def range_of(source: Source, span: Span, codec: PositionCodec) -> types.Range:
    """A place as the client counts it."""
    return types.Range(
        _position(source, span.start, codec), _position(source, max(span.end, span.start), codec)
    )


def _position(source: Source, offset: int, codec: PositionCodec) -> types.Position:
    row, column = source.position(min(offset, len(source.text)))
    before = source.line(row)[: column - 1]
    return types.Position(row - 1, codec.client_num_units(before))


def offset_of(source: Source, position: types.Position, codec: PositionCodec) -> int:
    """The offset of a place that the client has named."""
    lines = source.text.split("\n")
    row = min(position.line, len(lines) - 1)
    start = sum(len(line) + 1 for line in lines[:row])
    inside = codec.position_from_client_units(lines, types.Position(row, position.character))
    return start + min(inside.character, len(lines[row]))


def location(label: Label, codec: PositionCodec) -> types.Location:
    """A place in a file."""
    return types.Location(uri_of(label.source.name), range_of(label.source, label.span, codec))


def diagnostic(found: Diagnostic, main: tree.Tree, codec: PositionCodec) -> types.Diagnostic:
    """A finding, at the `include` that brings it in if it is about another file."""
    label = found.primary
    message = found.message if found.hint is None else f"{found.message}\n{found.hint}"
    related = [(other, other.text) for other in found.secondary]
    if label.source.name != main.source.name:
        related.insert(0, (label, found.message))
        message = f"{Path(label.source.name).name}: {message}"
        label = Label(main.source, _bringing(main, label.source.name))
    return types.Diagnostic(
        range=range_of(label.source, label.span, codec),
        message=message,
        severity=types.DiagnosticSeverity.Error
        if found.severity is Severity.ERROR
        else types.DiagnosticSeverity.Warning,
        code=found.code,
        source="sketchlang",
        related_information=[
            types.DiagnosticRelatedInformation(location(other, codec), text or "see here")
            for other, text in related
        ],
    )


def _bringing(main: tree.Tree, name: str) -> Span:
    for item in main.items:
        if isinstance(item, tree.Include) and item.tree is not None and _holds(item.tree, name):
            return item.place
    return Span(0, 0)


def _holds(file: tree.Tree, name: str) -> bool:
    return file.source.name == name or any(
        isinstance(item, tree.Include) and item.tree is not None and _holds(item.tree, name)
        for item in file.items
    )


def completion(proposal: Proposal, where: types.Range) -> types.CompletionItem:
    """A proposal, which replaces the word that is being written."""
    text = proposal.snippet or proposal.label
    return types.CompletionItem(
        label=proposal.label,
        kind=_KINDS[proposal.kind],
        detail=proposal.detail or None,
        documentation=proposal.documentation or None,
        filter_text=proposal.label.lstrip("!"),
        text_edit=types.TextEdit(where, text),
        insert_text_format=types.InsertTextFormat.Snippet
        if proposal.snippet
        else types.InsertTextFormat.PlainText,
    )


def quick_fixes(
    findings: Sequence[Diagnostic], main: tree.Tree, wanted: types.Range, codec: PositionCodec
) -> list[types.CodeAction]:
    """The edits that the findings at a place come down to."""
    actions = []
    for found in findings:
        fix = fix_of(found)
        shown = diagnostic(found, main, codec)
        if fix is None or found.primary.source.name != main.source.name:
            continue
        if not _touch(shown.range, wanted):
            continue
        edit = types.TextEdit(range_of(main.source, fix.span, codec), fix.text)
        actions.append(
            types.CodeAction(
                title=title_of(found, fix),
                kind=types.CodeActionKind.QuickFix,
                diagnostics=[shown],
                is_preferred=True,
                edit=types.WorkspaceEdit(changes={uri_of(main.source.name): [edit]}),
            )
        )
    return actions


def _touch(one: types.Range, other: types.Range) -> bool:
    return _pair(one.start) <= _pair(other.end) and _pair(other.start) <= _pair(one.end)


def _pair(position: types.Position) -> tuple[int, int]:
    return position.line, position.character
