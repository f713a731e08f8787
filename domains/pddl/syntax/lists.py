"""Texts to nested lists of words, each with its place: all that PDDL has of a syntax.

Lark reads; this file is its grammar, the limits, and the message for what does not fit.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, cast

from sketchlang.errors import InputError
from sketchlang.source import Source, Span

if TYPE_CHECKING:
    from lark import Lark

MAX_BYTES = 16_000_000
MAX_DEPTH = 200
"""Deepest nesting of parentheses: formulas are read by calls within calls."""

_GRAMMAR = r"""
start: list*
list: LPAR (WORD | list)* RPAR
LPAR: "("
RPAR: ")"
WORD: /[^\s();]+/
COMMENT: /;[^\n]*/
SPACE: /\s+/
%ignore COMMENT
%ignore SPACE
"""


class PddlError(InputError):
    """What is wrong with a PDDL file, with its place in it."""

    def __init__(self, message: str, source: Source, span: Span, hint: str | None = None) -> None:
        line, column = source.position(span.start)
        super().__init__(message, place=f"{source.name}:{line}:{column}", hint=hint)


@dataclass(frozen=True, slots=True)
class Word:
    """A name, variable, keyword, number or sign, in lower case: PDDL does not tell case."""

    text: str
    span: Span

    @property
    def is_variable(self) -> bool:
        """Whether it begins with a question mark."""
        return self.text.startswith("?")


@dataclass(frozen=True, slots=True)
class List:
    """What stands between two parentheses."""

    items: tuple[Word | List, ...]
    span: Span

    def head(self) -> str:
        """The first word; empty where there is none."""
        first = self.items[0] if self.items else None
        return first.text if isinstance(first, Word) else ""

    def __iter__(self) -> Iterator[Word | List]:
        return iter(self.items)


Item = Word | List


class Reader:
    """The lists of a text, and errors with a place in it."""

    def __init__(self, source: Source) -> None:
        self.source = source

    def error(self, message: str, at: Item | Span, hint: str | None = None) -> PddlError:
        """What to raise for a mistake at a place."""
        return PddlError(message, self.source, at if isinstance(at, Span) else at.span, hint)

    def lists(self) -> list[List]:
        """All top-level lists.

        Raises:
            PddlError: parentheses do not match, or there are too many of them.
        """
        from lark import UnexpectedInput

        text = self.source.text
        self._balanced(text)
        try:
            tree = cast(list[List], _parser().parse(text))
        except UnexpectedInput as error:
            place = max(0, min(getattr(error, "pos_in_stream", 0) or 0, len(text) - 1))
            shown = text[place : place + 20].split()
            raise self.error(
                f"expected `(`, found `{shown[0] if shown else text[place]}`",
                Span(place, place + 1),
            ) from None
        return tree

    def _balanced(self, text: str) -> None:
        """Finds the parenthesis that is to blame, which a parser notices only at the end."""
        opened: list[int] = []
        comment = False
        for place, letter in enumerate(text):
            if letter == "\n":
                comment = False
            elif comment:
                continue
            elif letter == ";":
                comment = True
            elif letter == "(":
                opened.append(place)
                if len(opened) > MAX_DEPTH:
                    message = f"more than {MAX_DEPTH} parentheses within each other"
                    raise self.error(message, Span(place, place + 1))
            elif letter == ")":
                if not opened:
                    message = "this parenthesis closes nothing"
                    raise self.error(message, Span(place, place + 1))
                opened.pop()
        if opened:
            message = "this parenthesis is never closed"
            raise self.error(message, Span(opened[-1], opened[-1] + 1))


@cache
def _parser() -> Lark:
    from lark import Lark, Token, Transformer

    class Build(Transformer[Token, Any]):
        """Makes lists while the parser runs: no tree is built in between."""

        def WORD(self, token: Token) -> Word:  # noqa: N802 (named as in the grammar)
            start = token.start_pos or 0
            return Word(str(token).lower(), Span(start, start + len(token)))

        def list(self, children: Sequence[Any]) -> List:
            opening, *items, closing = children
            return List(tuple(items), Span(opening.start_pos, closing.end_pos))

        def start(self, children: Sequence[List]) -> Sequence[List]:
            return children

    return Lark(_GRAMMAR, parser="lalr", lexer="basic", transformer=Build())
