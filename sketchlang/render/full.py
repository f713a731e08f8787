"""The format for people: the sentence, the lines it is about, and what to do.

error[undefined-name]: `helt` is neither declared here nor a function in domain tabletop
 --> sorting.sketch:4:40
  |
4 | feature H : bool = some o in objects: helt(o)
  |                                       ^^^^
  = hint: Did you mean `held`?
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable

from sketchlang.diagnostics import Diagnostic, Label, Severity
from sketchlang.escape import visible

MAX_WIDTH = 120
"""Longer source lines are cut around the place that matters."""

_RED, _YELLOW, _BLUE, _BOLD = "31;1", "33;1", "34;1", "1"


def render(diagnostic: Diagnostic, colour: bool = False) -> str:
    """One diagnostic as lines of text, without a line break at the end."""
    painter = _Painter(colour)
    severity = diagnostic.severity
    tone = _RED if severity is Severity.ERROR else _YELLOW
    title = painter.paint(f"{severity.value}[{diagnostic.code}]", tone)
    lines = [f"{title}: {painter.paint(visible(diagnostic.message), _BOLD)}"]
    labels = [(diagnostic.primary, True)] + [(label, False) for label in diagnostic.secondary]
    width = max(len(str(_line(label))) for label, _ in labels)
    pad = " " * width
    bar = painter.paint("|", _BLUE)
    names = []
    for label, _ in labels:
        if label.source.name not in names:
            names.append(label.source.name)
    for name in names:
        here = [entry for entry in labels if entry[0].source.name == name]
        arrow = "-->" if name == names[0] else ":::"
        first = here[0][0]
        row, column = first.source.position(first.span.start)
        lines.append(f"{pad}{painter.paint(arrow, _BLUE)} {visible(name)}:{row}:{column}")
        lines.append(f"{pad} {bar}")
        lines.extend(_excerpts(here, pad, bar, tone, painter))
    if diagnostic.hint:
        lines.append(f"{pad} {painter.paint('=', _BLUE)} hint: {visible(diagnostic.hint)}")
    return "\n".join(lines)


class _Painter:
    def __init__(self, colour: bool) -> None:
        self.colour = colour

    def paint(self, text: str, style: str) -> str:
        """The text in a style, if colours are wanted."""
        return f"\x1b[{style}m{text}\x1b[0m" if self.colour else text


def _line(label: Label) -> int:
    return label.source.position(label.span.start)[0]


def _excerpts(
    labels: Iterable[tuple[Label, bool]], pad: str, bar: str, tone: str, painter: _Painter
) -> list[str]:
    """The source lines of some labels in one file, each with its marks below it."""
    by_line: dict[int, list[tuple[Label, bool]]] = {}
    for label, primary in labels:
        by_line.setdefault(_line(label), []).append((label, primary))
    lines: list[str] = []
    last = None
    for number in sorted(by_line):
        if last is not None and number > last + 1:
            lines.append(f"{pad} {painter.paint('.', _BLUE)}")
        last = number
        marks = sorted(by_line[number], key=lambda entry: entry[0].span)
        text, offset = _cut(marks[0][0])
        gutter = painter.paint(str(number).rjust(len(pad)), _BLUE)
        lines.append(f"{gutter} {bar} {_visible(text)}".rstrip())
        for label, primary in marks:
            lines.append(f"{pad} {bar} {_mark(label, primary, (text, offset), tone, painter)}")
    return lines


def _cut(label: Label) -> tuple[str, int]:
    """A line of the source, or the part of a long one around the label, and where it begins."""
    row, column = label.source.position(label.span.start)
    text = label.source.line(row)
    if len(text) <= MAX_WIDTH:
        return text, 0
    start = max(0, min(column - 1 - MAX_WIDTH // 3, len(text) - MAX_WIDTH))
    return text[start : start + MAX_WIDTH], start


def _mark(label: Label, primary: bool, shown: tuple[str, int], tone: str, painter: _Painter) -> str:
    text, offset = shown
    column = label.source.position(label.span.start)[1] - 1 - offset
    column = max(0, min(column, len(text)))
    # Only the first line of a longer place is marked.
    end = max(column + 1, min(column + label.span.end - label.span.start, len(text)))
    before = _columns(text[:column])
    length = max(1, _columns(text[column:end]))
    sign = painter.paint(("^" if primary else "-") * length, tone if primary else _BLUE)
    words = f" {visible(label.text)}" if label.text else ""
    return " " * before + sign + painter.paint(words, tone if primary else _BLUE)


def _visible(text: str) -> str:
    """A line without characters that would move the cursor."""
    return "".join(
        c if c.isprintable() else " " if c == "\t" else "\N{REPLACEMENT CHARACTER}" for c in text
    )


def _columns(text: str) -> int:
    """How many columns of a terminal a text takes."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1
        for c in text
    )
