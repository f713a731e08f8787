"""Tables in LaTeX: plain `tabular`, which needs no package."""

from __future__ import annotations

import re

from runtime.bench.table import Table
from sketchlang.escape import visible

_SPECIAL = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"{\char34}",
    "`": r"{\char96}",
    "$": r"{\char36}",  # \$ asks for a font that small installations lack
    **{character: f"\\{character}" for character in "&%#_{}"},
}


def latex(table: Table) -> list[str]:
    """The lines of a table, to be read into a document by `\\input`."""
    layout = "l" * table.labels + "r" * (len(table.columns) - table.labels)
    caption = " ".join([f"{table.title}.", *table.notes])
    return [
        r"\begin{table}",
        r"\centering",
        rf"\begin{{tabular}}{{{layout}}}",
        r"\hline",
        _row(table.columns),
        r"\hline",
        *map(_row, table.rows),
        r"\hline",
        r"\end{tabular}",
        rf"\caption{{{escaped(caption)}}}",
        r"\end{table}",
    ]


def escaped(text: str) -> str:
    """A text that LaTeX prints as it is. A character that fonts of LaTeX may lack is told by its
    number."""
    found = "".join(_character(character) for character in visible(text))
    return re.sub("-(?=-)", "-{}", found)  # two of them would become a dash


def _character(character: str) -> str:
    if character in _SPECIAL:
        return _SPECIAL[character]
    if " " <= character <= "~":
        return character
    return rf"\texttt{{U+{ord(character):04X}}}"


def _row(cells: tuple[str, ...]) -> str:
    # Braces first: a row that began with `[` would be an argument of the line end before it.
    return "{}" + " & ".join(map(escaped, cells)) + r" \\"
