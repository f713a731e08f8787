"""One item to its node: Lark's interactive parser, fed token by token.

It stops at the first token that cannot stand where it is, and never recurses.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from sketchlang.syntax import grammar
from sketchlang.syntax.tree import Item

if TYPE_CHECKING:
    from lark import Token
    from lark.parsers.lalr_interactive_parser import InteractiveParser

END = "$END"
"""Lark's name for the end of the input; here the end of the item."""

MAX_DEPTH = 200
"""Longest stack of unfinished productions; a level of nesting takes two to four places."""


class StuckError(Exception):
    """The parser met a token that cannot stand there: `tokens[number]`, or the end."""

    def __init__(self, parser: InteractiveParser, tokens: Sequence[Token], number: int) -> None:
        from lark import Token

        super().__init__(number)
        self.number = number
        self.first = tokens[0]
        at_end = number == len(tokens)
        self.token = Token.new_borrow_pos(END, "", tokens[-1]) if at_end else tokens[number]
        if at_end:
            self.token.start_pos = self.token.end_pos
        self.previous = tokens[number - 1] if number else None
        self.place = settled(parser), self.token.type
        self._parser = parser

    @cached_property
    def expected(self) -> frozenset[str]:
        """The terminals that can stand there."""
        return frozenset(self._parser.accepts())  # type: ignore[no-untyped-call]


class TooDeepError(Exception):
    """More nesting than anybody writes."""

    def __init__(self, token: Token) -> None:
        super().__init__(token)
        self.token = token


def parse_item(tokens: Sequence[Token]) -> Item:
    """The node of one item; raises `StuckError`, `TooDeepError` or `RejectedError`."""
    from lark.exceptions import UnexpectedToken

    from sketchlang.syntax.build import build

    parser = grammar.load().parse_interactive()
    stack = parser.parser_state.state_stack
    number = 0
    try:
        for token in tokens:
            parser.feed_token(token)
            number += 1
            if len(stack) > MAX_DEPTH:
                raise TooDeepError(token)
        return build(parser.feed_eof(tokens[-1]))  # type: ignore[no-untyped-call]
    except UnexpectedToken:
        raise StuckError(parser, tokens, number) from None


def settled(parser: InteractiveParser) -> object:
    """The state after all reductions that do not depend on what follows.

    Examples of mistakes are found by this state, so that `{ a }` and `{ a, b > 0 }` count
    as the same left context.
    """
    from lark.parsers.lalr_analysis import Shift

    states = parser.parser_state.parse_conf.states
    stack = list(parser.parser_state.state_stack)
    while True:
        row = states[stack[-1]]
        actions = {row[symbol] for symbol in row if symbol.isupper()}
        if len(actions) != 1 or (only := actions.pop())[0] is Shift:
            return stack[-1]
        rule = only[1]
        del stack[-len(rule.expansion) :]
        stack.append(states[stack[-1]][rule.origin.name][1])
