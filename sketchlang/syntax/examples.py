"""The table of example mistakes: `grammars/mistakes.txt`."""

from __future__ import annotations

from functools import cache
from itertools import groupby
from typing import TYPE_CHECKING

from sketchlang.syntax.grammar import FOLDER
from sketchlang.syntax.item import StuckError, parse_item
from sketchlang.syntax.lexer import tokenize

if TYPE_CHECKING:
    from lark import Token

MISTAKES = FOLDER / "mistakes.txt"


@cache
def mistakes() -> dict[tuple[object, str], str]:
    """Parser state and offending terminal of every example, with its code.

    Worked out at the first syntax error: a sketch without one does not pay for it.
    """
    return place(MISTAKES.read_text(encoding="utf-8"))


def place(text: str) -> dict[tuple[object, str], str]:
    """Where the examples of a text are stuck. Raises `ValueError` for one that is no mistake, and
    for two with different codes that are stuck at the same place."""
    found: dict[tuple[object, str], str] = {}
    origin: dict[tuple[object, str], str] = {}
    code = ""
    lines = text.splitlines()
    # In one go: making ready to read a text costs more than an example does.
    for number, tokens in groupby(tokenize(text)[0], key=lambda token: token.line):
        line = lines[(number or 1) - 1]
        if not line.startswith(" "):
            code = line.strip()
            continue
        stuck = _stuck_at(list(tokens))
        if found.setdefault(stuck, code) != code:
            raise ValueError(f"{code}: {line.strip()!r} is stuck where {origin[stuck]!r} is")
        origin.setdefault(stuck, line.strip())
    return found


def _stuck_at(example: list[Token]) -> tuple[object, str]:
    try:
        parse_item(example)
    except StuckError as stuck:
        return stuck.place
    raise ValueError(f"{' '.join(example)!r} is no mistake")
