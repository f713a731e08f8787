"""One canonical form for every file, with its comments.

Items are printed anew; blank lines between them are kept, one at most. An item with comments
inside keeps its lines, and only its signs are unified.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sketchlang.source import Source, Span
from sketchlang.syntax import printer, tree
from sketchlang.syntax.lexer import span, tokenize
from sketchlang.syntax.parser import parse
from sketchlang.syntax.signs import SIGNS

if TYPE_CHECKING:
    from lark import Token

_SPELLINGS = SIGNS | {"∧": "and", "∨": "or", "→": "->", "↦": "->"}


class NotFormattedError(Exception):
    """The text has syntax errors."""


def format_source(source: Source) -> str:
    """The canonical form of a text. Raises `NotFormattedError` if it has syntax errors."""
    parsed, diagnostics = parse(source)
    if diagnostics:
        raise NotFormattedError(source.name)
    return format_tree(parsed)


def format_tree(parsed: tree.Tree) -> str:
    """The canonical form of a file without syntax errors."""
    text = parsed.source.text
    lines: list[str] = []
    end = 0
    comments = list(parsed.comments)

    def begin(start: int) -> None:
        """Keep one blank line if there are some before this place."""
        if lines and text.count("\n", end, start) > 1:
            lines.append("")

    for item in parsed.items:
        while comments and comments[0].start < item.span.start:
            comment = comments.pop(0)
            begin(comment.start)
            lines.append(comment.text)
            end = comment.end
        begin(item.span.start)
        end = item.span.end
        inside = []
        while comments and comments[0].start < end:
            inside.append(comments.pop(0))
        lines.extend(_verbatim(text, item) if inside else printer.item(item))
        if comments and not comments[0].first and "\n" not in text[end : comments[0].start]:
            trailing = comments.pop(0)
            lines[-1] += f"  {trailing.text}"
            end = trailing.end
    for comment in comments:
        begin(comment.start)
        lines.append(comment.text)
        end = comment.end
    return "\n".join(lines) + "\n" if lines else ""


def _verbatim(text: str, item: tree.Item) -> list[str]:
    """The lines of an item as they are, but for signs and space at their ends."""
    piece = text[item.span.start : item.span.end]
    tokens, comments = tokenize(piece)
    places = [(span(token), _spelling(token)) for token in tokens]
    places.extend((Span(comment.start, comment.end), comment.text) for comment in comments)
    spelled: list[str] = []
    done = 0
    for place, spelling in sorted(places):
        spelled.append(piece[done : place.start])
        spelled.append(spelling)
        done = place.end
    lines = "".join(spelled).expandtabs(printer.INDENT).split("\n")
    return [line.rstrip() for line in lines]


def _spelling(token: Token) -> str:
    if token == "¬":
        return "!"
    return _SPELLINGS.get(token, str(token))
