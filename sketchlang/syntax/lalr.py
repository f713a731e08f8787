"""The LALR machine that `grammars/table.py` was made for.

It calls one action a production, with the children that the grammar keeps: tokens, or what
the actions of shorter productions returned. It never recurses, and it stops at the first
token that cannot stand where it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from grammars.table import ACTIONS, END, GOTOS, PRODUCTIONS, START
from sketchlang.source import Span
from sketchlang.syntax.lexer import Token

STOP = "$END"
MAX_DEPTH = 200
"""Longest stack of unfinished productions; a level of nesting takes two to four places."""

Action = Callable[[list[Any], Span], Any]


class StuckError(Exception):
    """The parser met a token (`$END`: the end of the item) that cannot stand there."""

    def __init__(self, state: int, token: Token, expected: frozenset[str]) -> None:
        super().__init__(token.text)
        self.state = state
        self.token = token
        self.expected = expected
        self.previous: Token | None = None


class TooDeepError(Exception):
    """More nesting than anybody writes."""

    def __init__(self, token: Token) -> None:
        super().__init__(token.text)
        self.token = token


def parse_item(tokens: Sequence[Token], actions: Mapping[str, Action]) -> Any:
    """What the actions make of one item; raises `StuckError` or `TooDeepError`."""
    states = [START]
    values: list[Any] = []
    spans: list[tuple[int, int]] = []
    for number, token in enumerate(tokens):
        try:
            _reduce(token, states, values, spans, actions)
        except StuckError as stuck:
            stuck.previous = tokens[number - 1] if number else None
            raise
        states.append(ACTIONS[states[-1]][token.kind])
        values.append(token)
        spans.append((token.start, token.end))
        if len(states) > MAX_DEPTH:
            raise TooDeepError(token)
    end = tokens[-1].end
    _reduce(Token(STOP, "", end, end, False), states, values, spans, actions)
    return values[-1]


def _reduce(
    token: Token,
    states: list[int],
    values: list[Any],
    spans: list[tuple[int, int]],
    actions: Mapping[str, Action],
) -> None:
    """Finish every production that is complete before `token`."""
    kind = token.kind
    while True:
        action = ACTIONS[states[-1]].get(kind)
        if action is None:
            raise StuckError(settled(states), token, accepted(states))
        if action >= 0:
            return
        origin, length, name, kept = PRODUCTIONS[~action]
        children = values[-length:]
        span = (spans[-length][0], spans[-1][1])
        del states[-length:], values[-length:], spans[-length:]
        values.append(_value(name, kept, children, span, actions))
        spans.append(span)
        states.append(GOTOS[states[-1]][origin])
        if states[-1] == END and kind == STOP:
            return


class _Splice(list[Any]):
    """Children of a helper production, to be put into the parent's."""


def _value(
    name: str,
    kept: tuple[int, ...],
    children: list[Any],
    span: tuple[int, int],
    actions: Mapping[str, Action],
) -> Any:
    if name == "?":
        return children[kept[0]]
    flat: list[Any] = []
    for i in kept:
        child = children[i]
        if type(child) is _Splice:
            if i == 0 and not name:
                # A list that grows by one at a time: keep it, or it is copied every time.
                flat = child
                continue
            flat.extend(child)
        else:
            flat.append(child)
    if not name:
        return flat if type(flat) is _Splice else _Splice(flat)
    return actions[name](flat, Span(*span))


def settled(states: Sequence[int]) -> int:
    """The state after all reductions that do not depend on what follows.

    Examples of mistakes are found by this state, so that `{ a }` and `{ a, b > 0 }` count
    as the same left context.
    """
    stack = list(states)
    while True:
        actions = set(ACTIONS[stack[-1]].values())
        if len(actions) != 1 or (action := actions.pop()) >= 0:
            return stack[-1]
        origin, length, _, _ = PRODUCTIONS[~action]
        del stack[-length:]
        stack.append(GOTOS[stack[-1]][origin])


def accepted(states: Sequence[int]) -> frozenset[str]:
    """The terminals that the parser can really shift (or end on) from a stack of states."""
    return frozenset(kind for kind in ACTIONS[states[-1]] if _can_shift(states, kind))


def _can_shift(states: Sequence[int], kind: str) -> bool:
    stack = list(states)
    while True:
        action = ACTIONS[stack[-1]].get(kind)
        if action is None:
            return False
        if action >= 0:
            return True
        origin, length, _, _ = PRODUCTIONS[~action]
        del stack[-length:]
        stack.append(GOTOS[stack[-1]][origin])
        if stack[-1] == END:
            return kind == STOP
