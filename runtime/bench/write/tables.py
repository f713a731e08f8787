"""Tables one after the other, in Markdown or LaTeX."""

from __future__ import annotations

from collections.abc import Sequence

from runtime.bench.table import Table
from runtime.bench.write.latex import latex
from runtime.bench.write.markdown import markdown


def lines_of(tables: Sequence[Table], shape: str) -> list[str]:
    """The lines of tables, an empty line between two of them; `shape` is `latex` or `md`."""
    write = latex if shape == "latex" else markdown
    lines: list[str] = []
    for number, table in enumerate(tables):
        lines += [*([""] if number else []), *write(table)]
    return lines
