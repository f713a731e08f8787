"""Parsing again after a change: items that did not change are taken from the time before.

Pieces of a file are the ones that the parser cuts, at lines that begin with an item keyword. One
that is known is moved to its new place, which takes a fraction of the time of parsing it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import Any, TypeVar, cast

from sketchlang.diagnostics import Diagnostic, Fix, Label
from sketchlang.source import Source, Span
from sketchlang.syntax import hidden
from sketchlang.syntax.lexer import Comment
from sketchlang.syntax.parser import MAX_CHARACTERS, MAX_MISTAKES, parse
from sketchlang.syntax.repair import ITEMS
from sketchlang.syntax.tree import Tree

T = TypeVar("T")

_OTHERS = "|".join(word for word in ITEMS if word != "goal")

# An indented `goal` may belong to an expression. Two items in a piece do no harm, half of one does.
_BEGIN = re.compile(rf"^(?:[ \t\r\f\ufeff]*(?:{_OTHERS})|goal)\b", re.MULTILINE)


@dataclass
class Parser:
    """Remembers the pieces of the last version of a file by their text."""

    pieces: dict[str, tuple[Tree, list[Diagnostic]]] = field(default_factory=dict)

    def parse(self, source: Source) -> tuple[Tree, list[Diagnostic]]:
        """The same as `sketchlang.syntax.parser.parse`."""
        text = source.text
        if len(text) > MAX_CHARACTERS or hidden.suspicious(text):
            return parse(source)
        starts = [match.start() for match in _BEGIN.finditer(text)]
        bounds = sorted({0, *starts, len(text)})
        pieces: dict[str, tuple[Tree, list[Diagnostic]]] = {}
        items: list[Any] = []
        comments: list[Comment] = []
        diagnostics: list[Diagnostic] = []
        for start, end in pairwise(bounds):
            part = text[start:end]
            known = self.pieces.get(part) or pieces.get(part)
            pieces[part] = known = known or parse(Source(source.name, part))
            tree, found = known
            items.extend(moved(item, start) for item in tree.items)
            comments.extend(
                one._replace(start=one.start + start, end=one.end + start) for one in tree.comments
            )
            diagnostics.extend(_placed(one, source, start) for one in found)
            if len(diagnostics) >= MAX_MISTAKES:
                return parse(source)
        self.pieces = pieces
        return Tree(source, tuple(items), tuple(comments)), diagnostics


def moved(node: T, by: int) -> T:
    """A node of the tree, and all in it, further on in the text."""
    return node if by == 0 else cast(T, _moved(node, by))


def _moved(node: Any, by: int) -> Any:
    kind = type(node)
    if kind is Span:
        return Span(node.start + by, node.end + by)
    if kind is tuple:
        return tuple([_moved(part, by) for part in node])
    names = _FIELDS.get(kind)
    if names is None:
        if not hasattr(kind, "__dataclass_fields__"):
            return node
        names = _FIELDS[kind] = tuple(one.name for one in fields(node))
    return kind(*[_moved(getattr(node, name), by) for name in names])


_FIELDS: dict[type, tuple[str, ...]] = {}


def _placed(found: Diagnostic, source: Source, by: int) -> Diagnostic:
    primary = Label(source, moved(found.primary.span, by), found.primary.text)
    fix = None if found.fix is None else Fix(moved(found.fix.span, by), found.fix.text)
    return replace(found, primary=primary, fix=fix)
