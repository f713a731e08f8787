"""Invariants: expressions that only look at truth values of features."""

from __future__ import annotations

from collections.abc import Mapping

from sketchlang.checking.declarations import Placed
from sketchlang.checking.report import Report
from sketchlang.checking.typed import Node
from sketchlang.model import And, Formula, Invariant, Literal, Not, Or
from sketchlang.syntax import tree
from sketchlang.types import BOOL


class NotAFormulaError(Exception):
    """A node that no statement about a valuation can express."""

    def __init__(self, node: Node) -> None:
        super().__init__(node.kind)
        self.node = node


def invariant(placed: Placed[tree.InvariantItem], node: Node, report: Report) -> Invariant | None:
    """The invariant that a typed formula states, or None if it is no statement about truth
    values of features."""
    try:
        formula = _formula(node)
    except NotAFormulaError as wrong:
        report.add(
            "wrong-invariant",
            "invariants speak of features only: `p`, `n = 0`, `n > 0`, put together",
            wrong.node.place,
            hint="Declare a Boolean feature for it and state the invariant with that.",
        )
        return None
    span = placed.item.formula.span
    text = " ".join(placed.source.text[span.start : span.end].split())
    return Invariant(formula, text, placed.item.span)


def _formula(node: Node) -> Formula:
    match node.kind:
        case "feature" if node.type == BOOL:
            assert isinstance(node.value, int)
            return Literal(node.value, True)
        case "constant" if node.type == BOOL:
            return And(()) if node.value else Or(())
        case "not":
            return _negated(_formula(node.parts[0]))
        case "and":
            return And(tuple(map(_formula, node.parts)))
        case "or":
            return Or(tuple(map(_formula, node.parts)))
        case "->":
            return Or((_negated(_formula(node.parts[0])), _formula(node.parts[1])))
        case "=" if node.parts[0].type == BOOL:
            left, right = map(_formula, node.parts)
            return Or((And((left, right)), And((_negated(left), _negated(right)))))
        case "=" | "<" | "<=":
            return _comparison(node)
    raise NotAFormulaError(node)


def _negated(formula: Formula) -> Formula:
    """The shortest form of a negation."""
    if isinstance(formula, Literal):
        return Literal(formula.feature, not formula.positive)
    return formula.operand if isinstance(formula, Not) else Not(formula)


def _comparison(node: Node) -> Formula:
    """A comparison of a number with 0 or 1 that says whether it is 0."""
    left, right = node.parts
    signs: Mapping[tuple[str, int], bool]
    if left.kind == "feature" and right.kind == "constant":
        feature, number, signs = left, right.value, _AGAINST
    elif right.kind == "feature" and left.kind == "constant":
        feature, number, signs = right, left.value, _BEHIND
    else:
        raise NotAFormulaError(node)
    positive = signs.get((node.kind, number)) if isinstance(number, int) else None
    if positive is None:
        raise NotAFormulaError(node)
    assert isinstance(feature.value, int)
    return Literal(feature.value, positive)


_AGAINST = {("=", 0): False, ("<=", 0): False, ("<", 1): False}
_BEHIND = {("=", 0): False, ("<", 0): True, ("<=", 1): True}
