"""The parser's actions: one function a production of `grammars/sketch.lark`."""

from __future__ import annotations

from typing import Any

from sketchlang.source import Span
from sketchlang.syntax import tree
from sketchlang.syntax.lalr import Action
from sketchlang.syntax.lexer import Token

# One spelling for every operator, whichever the author prefers.
SIGNS = {
    "≠": "!=",
    "≤": "<=",
    "≥": ">=",
    "∈": "in",
    "↓": "--",
    "↑": "++",
    "∃": "some",
    "∀": "all",
}
MAX_NUMBER = 10**9


class RejectedError(Exception):
    """The item follows the grammar and is wrong all the same."""

    def __init__(self, code: str, message: str, span: Span, hint: str | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.span = span
        self.hint = hint


def _name(token: Token) -> tree.Name:
    return tree.Name(token.text, Span(token.start, token.end))


def _sign(token: Token) -> str:
    return SIGNS.get(token.text, token.text)


def _number(token: Token) -> int:
    # Counting digits first: Python refuses to convert very long ones.
    if len(token.text.lstrip("0")) > 10 or int(token.text) > MAX_NUMBER:
        raise RejectedError(
            "number-too-large",
            "this number is above 1000000000",
            Span(token.start, token.end),
        )
    return int(token.text)


def _title(children: list[Any], span: Span) -> tree.Title:
    return tree.Title(_name(children[0]), span)


def _use(children: list[Any], span: Span) -> tree.Use:
    return tree.Use(_name(children[0]), span)


def _include(children: list[Any], span: Span) -> tree.Include:
    token = children[0]
    quoted = token.kind == "STRING"
    target = token.text[1:-1] if quoted else token.text
    return tree.Include(target, quoted, Span(token.start, token.end), span)


def _feature(children: list[Any], span: Span) -> tree.FeatureItem:
    bounded = children[0].kind == "BOUNDED"
    name, kind, *rest = children[bounded:]
    definition = rest[1] if rest else None
    return tree.FeatureItem(_name(name), kind.text, bounded, definition, span)


def _define(children: list[Any], span: Span) -> tree.Define:
    parameters = children[1] if len(children) == 4 else ()
    return tree.Define(_name(children[0]), parameters, children[-1], span)


def _parameters(children: list[Any], _span: Span) -> tuple[tree.Parameter, ...]:
    return tuple(children)


def _parameter(children: list[Any], span: Span) -> tree.Parameter:
    return tree.Parameter(_name(children[0]), _name(children[1]), span)


def _invariant(children: list[Any], span: Span) -> tree.InvariantItem:
    return tree.InvariantItem(children[0], span)


def _atoms(children: list[Any], span: Span) -> tree.Atoms:
    return tree.Atoms(tuple(map(_name, children)), span)


def _goal(children: list[Any], span: Span) -> tree.Goal:
    return tree.Goal(children[0], span)


def _rule(children: list[Any], span: Span) -> tree.RuleItem:
    name, conditions, effects = children
    return tree.RuleItem(_name(name), conditions, effects, span)


def _block(children: list[Any], span: Span) -> tree.Block:
    return tree.Block(tuple(children), span)


def _literal(children: list[Any], span: Span) -> tree.Literal:
    negated = children[0].kind == "NOT"
    name, *rest = children[negated:]
    sign = _sign(rest[0]) if rest else ""
    number = _number(rest[1]) if len(rest) == 2 else None
    return tree.Literal(_name(name), negated, sign, number, span)


def _implies(children: list[Any], span: Span) -> tree.Operation:
    return tree.Operation("->", tuple(children), span)


def _or(children: list[Any], span: Span) -> tree.Operation:
    return tree.Operation("or", tuple(children), span)


def _and(children: list[Any], span: Span) -> tree.Operation:
    return tree.Operation("and", tuple(children), span)


def _not(children: list[Any], span: Span) -> tree.Operation:
    return tree.Operation("not", (children[1],), span)


def _add(children: list[Any], span: Span) -> tree.Operation:
    return tree.Operation("+", tuple(children), span)


def _compare(children: list[Any], span: Span) -> tree.Comparison:
    if len(children) > 3:
        second = children[3]
        raise RejectedError(
            "chained-comparison",
            "comparisons cannot be chained",
            Span(second.start, second.end),
            "Write `a < b and b < c`, or put one comparison in parentheses.",
        )
    left, sign, right = children
    return tree.Comparison(left, _sign(sign), right, span)


def _truth(children: list[Any], span: Span) -> tree.Truth:
    return tree.Truth(children[0].text == "true", span)


def _number_expr(children: list[Any], span: Span) -> tree.Number:
    return tree.Number(_number(children[0]), span)


def _group(children: list[Any], _span: Span) -> tree.Expr:
    inner: tree.Expr = children[0]
    return inner


def _call(children: list[Any], span: Span) -> tree.Call:
    arguments = children[1] if len(children) == 2 else ()
    return tree.Call(_name(children[0]), arguments, span)


def _arguments(children: list[Any], _span: Span) -> tuple[tree.Expr, ...]:
    return tuple(children)


def _quantifier(children: list[Any], span: Span) -> tree.Quantifier:
    kind, variable, _in, domain, *rest = children
    default = rest.pop()[0] if isinstance(rest[-1], list) else None
    body = rest.pop()
    condition = rest.pop() if rest else None
    return tree.Quantifier(_sign(kind), _name(variable), domain, condition, body, default, span)


def _default(children: list[Any], _span: Span) -> list[tree.Expr]:
    # A list, so that `_quantifier` can tell it from a body.
    return children


ACTIONS: dict[str, Action] = {
    "sketch": _title,
    "use": _use,
    "include": _include,
    "feature": _feature,
    "define": _define,
    "parameters": _parameters,
    "parameter": _parameter,
    "invariant": _invariant,
    "atoms": _atoms,
    "goal": _goal,
    "rule": _rule,
    "block": _block,
    "literal": _literal,
    "implies": _implies,
    "or": _or,
    "and": _and,
    "not": _not,
    "add": _add,
    "compare": _compare,
    "truth": _truth,
    "number": _number_expr,
    "group": _group,
    "call": _call,
    "arguments": _arguments,
    "quantifier": _quantifier,
    "default": _default,
}
