"""Changes of a text: renaming, formatting, and what the hints of diagnostics come down to."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sketchlang.diagnostics import Diagnostic, Fix, Label
from sketchlang.loader import SUFFIX
from sketchlang.lsp.state import Document
from sketchlang.lsp.symbols import Occurrence
from sketchlang.source import Source, Span
from sketchlang.syntax.formatter import NotFormattedError, format_source
from sketchlang.syntax.grammar import words

RENAMED = frozenset({"feature", "define", "rule", "variable", "parameter", "sketch"})
"""What is declared in sketches, and so can have another name there."""

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_MEANT = re.compile(r"Did you mean `([^`]+)`\?")


class RefusedError(Exception):
    """A change that cannot be made; the text says why."""


def uses(found: Occurrence, documents: Sequence[Document]) -> list[Label]:
    """All places of what a name stands for, in every file once."""
    places = {
        (one.source.name, one.span): Label(one.source, one.span)
        for document in documents
        for one in document.names
        if one.target == found.target
    }
    return sorted(places.values(), key=lambda label: (label.source.name, label.span))


def rename(found: Occurrence, new: str, documents: Sequence[Document]) -> list[Label]:
    """The places to change so that something gets a new name.

    Raises:
        RefusedError: it is declared elsewhere, or the name is none or is taken.
    """
    kind, name = found.target.kind, found.target.name
    if kind not in RENAMED:
        raise RefusedError(f"`{name}` is not declared in a sketch")
    if not _NAME.fullmatch(new):
        raise RefusedError(f"`{new}` is no name: names consist of letters, digits and `_`")
    if new in words():
        raise RefusedError(f"`{new}` is a keyword")
    rivals = {"rule"} if kind == "rule" else {"feature", "define", "variable", "parameter"}
    taken = {
        one.target.name
        for document in documents
        for one in document.names
        if one.declares and one.target.kind in rivals
    }
    functions = {
        name
        for document in documents
        if document.domain is not None
        for name in document.domain.functions
    }
    if kind != "sketch" and (new in taken or (kind != "rule" and new in functions)):
        raise RefusedError(f"`{new}` is taken")
    places = uses(found, documents)
    if any(not place.source.name.endswith(SUFFIX) for place in places):
        raise RefusedError(f"`{name}` is used in files that are no sketches")
    return places


def formatted(source: Source) -> str | None:
    """The canonical form of a text, None if it has syntax errors."""
    try:
        return format_source(source)
    except NotFormattedError:
        return None


def fix_of(found: Diagnostic) -> Fix | None:
    """The edit that the hint of a diagnostic comes down to."""
    if found.fix is not None:
        return found.fix
    meant = _MEANT.fullmatch(found.hint or "")
    return Fix(found.primary.span, meant[1]) if meant else None


def title_of(found: Diagnostic, fix: Fix) -> str:
    """What an editor calls the edit."""
    if found.hint and len(found.hint) <= 80:
        return found.hint.rstrip(".")
    return f"Write `{fix.text}`" if fix.text.strip() else "Remove it"


def whole(source: Source) -> Span:
    """All of a text."""
    return Span(0, len(source.text))
