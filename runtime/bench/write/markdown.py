"""Tables in Markdown, in columns that fit a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from runtime.bench.table import Table
from sketchlang.escape import shown_line

WIDTH = 80
"""Characters a line. Where a table has wider rows, its first labels become headings of parts."""


def markdown(table: Table, width: int = WIDTH) -> list[str]:
    """The lines of a table: its title, its rows, its notes."""
    lines = [f"**{table.title}**", ""] if table.title else []
    rows = [tuple(_cell(text) for text in row) for row in table.rows]
    return [*lines, *_parts(table.columns, rows, table.labels, width), *_notes(table.notes, width)]


def _parts(
    columns: tuple[str, ...], rows: Sequence[tuple[str, ...]], labels: int, width: int
) -> list[str]:
    """The rows under their columns, or in parts with the first label as a heading."""
    sizes = [max(len(row[i]) for row in (columns, *rows)) for i in range(len(columns))]
    if sum(sizes) + 3 * len(sizes) + 1 <= width or labels < 2:
        return _lines(columns, rows, labels, sizes)
    lines: list[str] = []
    for value in dict.fromkeys(row[0] for row in rows):
        part = [row[1:] for row in rows if row[0] == value]
        lines += [*([""] if lines else []), f"{columns[0]}: {value}", ""]
        lines += _parts(columns[1:], part, labels - 1, width)
    return lines


def _lines(
    columns: tuple[str, ...], rows: Sequence[tuple[str, ...]], labels: int, sizes: list[int]
) -> list[str]:
    def line(cells: Sequence[str]) -> str:
        padded = [
            cell.ljust(size) if i < labels else cell.rjust(size)
            for i, (cell, size) in enumerate(zip(cells, sizes, strict=True))
        ]
        return "| " + " | ".join(padded) + " |"

    rule = "|".join(
        "-" * (size + 2) if i < labels else "-" * (size + 1) + ":" for i, size in enumerate(sizes)
    )
    return [line(columns), f"|{rule}|", *map(line, rows)]


def _cell(text: str) -> str:
    """A text that neither ends its cell nor its line."""
    return shown_line(text).replace("|", "\\|")


def _notes(notes: tuple[str, ...], width: int) -> list[str]:
    from textwrap import wrap

    return [line for note in notes for line in ("", *wrap(note, width))]
