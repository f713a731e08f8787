"""Characters that mean nothing in a sketch, and what their writer may have meant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sketchlang.syntax.lexer import ERROR, UNCLOSED_STRING, span
from sketchlang.syntax.mistakes import Mistake, describe

if TYPE_CHECKING:
    from lark import Token

# What people mean by signs that the language does not have.
_SIGN_HINTS = {
    "-": "There is no subtraction: values are never negative.",
    "*": "There is no multiplication: write a function of the domain.",
    "&": "Write `and`.",
    "&&": "Write `and`.",
    "|": "Write `or`.",
    "||": "Write `or`.",
    "~": "Write `!`.",
    ";": "Items end where the next one begins: leave the sign out.",
    "[": "Write braces `{ ... }` around conditions and effects.",
    "//": "Comments begin with `#`.",
    "/": "Put paths in quotes.",
    ".": "Put paths in quotes.",
    "−": "There is no subtraction. `n--` is written with two hyphens.",
    "–": "There is no subtraction. `n--` is written with two hyphens.",
    "—": "There is no subtraction. `n--` is written with two hyphens.",
    "⇒": "Write `->`.",
}


def bad_characters(tokens: Sequence[Token], most: int) -> list[Mistake]:
    """What is wrong with the tokens that no terminal matches, `most` mistakes at most."""
    mistakes = []
    for token in tokens:
        if token.type == UNCLOSED_STRING:
            message = 'this text has no closing `"`'
            mistakes.append(Mistake("unclosed-string", message, span(token), None))
        elif token.type == ERROR:
            hint = _SIGN_HINTS.get(token)
            if token[0].isidentifier():
                hint = "Names consist of the letters a to z and A to Z, digits and `_`."
            message = f"{_printable(token)} means nothing here"
            mistakes.append(Mistake("unexpected-character", message, span(token), hint))
        if len(mistakes) >= most:
            break
    return mistakes


def _printable(token: Token) -> str:
    if token.isprintable():
        return describe(token)
    if len(token) == 1:
        return f"the character U+{ord(token):04X}"
    return f"this run of {len(token)} characters"
