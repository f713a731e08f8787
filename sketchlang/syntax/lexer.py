"""Text to tokens, by Lark. What no terminal of the grammar matches becomes an `ERROR` token."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from sketchlang.source import Span
from sketchlang.syntax import grammar

if TYPE_CHECKING:
    from lark import Token

ERROR = "ERROR"
UNCLOSED_STRING = "UNCLOSED_STRING"


class Comment(NamedTuple):
    """A `#` comment without its line break; `first` tells whether its line begins with it."""

    text: str
    start: int
    end: int
    first: bool


def tokenize(text: str) -> tuple[list[Token], list[Comment]]:
    """All tokens and all comments of a text, in order."""

    tokens: list[Token] = []
    comments: list[Comment] = []
    for token in grammar.load().lex(text, dont_ignore=True):
        kind = token.type
        if kind in {"SPACE", "NEWLINE"}:
            continue
        if kind == "COMMENT":
            place = span(token)
            first = not tokens or tokens[-1].line != token.line
            comments.append(Comment(token.rstrip(), place.start, place.end, first))
            continue
        if (
            kind == ERROR
            and token[0].isalpha()
            and tokens
            and tokens[-1].end_pos == token.start_pos
        ):
            # `größe`: the whole word is wrong, not its middle.
            before = tokens.pop()
            token = token.update(value=before.value + token.value)
            token.start_pos, token.column = before.start_pos, before.column
        tokens.append(token)
    return tokens, comments


def span(token: Token) -> Span:
    """Where a token stands."""
    start, end = token.start_pos, token.end_pos
    assert start is not None
    assert end is not None
    return Span(start, end)


def begins_line(tokens: Sequence[Token], number: int) -> bool:
    """Whether a token is the first one on its line."""
    return number == 0 or tokens[number - 1].line != tokens[number].line
