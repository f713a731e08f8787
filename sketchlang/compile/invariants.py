"""Formulas to closures over feature values."""

from __future__ import annotations

from collections.abc import Callable

from sketchlang.model import And, Formula, Literal, Not, Or

Truth = Callable[[tuple[int, ...]], bool]


def truth(formula: Formula) -> Truth:
    """What `sketchlang.model.holds` computes, with the formula already taken apart."""
    match formula:
        case Literal(feature, True):
            return lambda values: values[feature] > 0
        case Literal(feature, _):
            return lambda values: values[feature] == 0
        case Not(operand):
            inner = truth(operand)
            return lambda values: not inner(values)
        case And((left, right)):
            a, b = truth(left), truth(right)
            return lambda values: a(values) and b(values)
        case Or((left, right)):
            a, b = truth(left), truth(right)
            return lambda values: a(values) or b(values)
        case And(operands):
            parts = [truth(operand) for operand in operands]
            return lambda values: all(part(values) for part in parts)
        case Or(operands):
            parts = [truth(operand) for operand in operands]
            return lambda values: any(part(values) for part in parts)
