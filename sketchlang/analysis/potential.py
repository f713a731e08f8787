"""Potentials: weighted sums of features that rules can only lower (linear ranking).

A sum with integer weights - of nats, of Booleans as 0 and 1, and of `n > 0` as 0 and 1 - is
bounded below if the weights of nats are not negative (or the nat is bounded). If no rule can
raise it, the rules that are sure to lower it fire finitely often. They are taken away, and
the rest may have a sum of its own: a lexicographic linear ranking function (Podelski and
Rybalchenko, VMCAI 2004; Bradley, Manna and Sipma, CAV 2005), here over the qualitative
effects of rules. All weights come out of one linear programme, whose numbers are
rounded; what counts is checked again with integers.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from sketchlang.analysis.bits import RuleBits, members
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.proof import Potential, Term


def potential(rules: Collection[RuleBits], bounded: int, budget: Budget) -> Potential | None:
    """A sum that no rule can raise and as many as possible must lower; None if there is none.

    Raises:
        LimitReachedError: the time of the budget is over.
    """
    from sketchlang.analysis.weights import integer_weights

    columns = _columns(rules, bounded)
    if not columns:
        return None
    numbered = {column: number for number, column in enumerate(columns)}
    amounts = integer_weights([_row(rule, numbered) for rule in rules], len(columns), budget)
    if amounts is None:
        return None
    sums: dict[tuple[int, bool], int] = {}
    for (feature, of_truth, sign), amount in zip(columns, amounts, strict=True):
        sums[feature, of_truth] = sums.get((feature, of_truth), 0) + sign * amount
    terms = tuple(Term(f, of_truth, w) for (f, of_truth), w in sorted(sums.items()) if w)
    changes = [(rule.index, most_change(rule, terms)) for rule in rules]
    lowering = tuple(index for index, change in changes if change is not None and change < 0)
    if not lowering or any(change is None or change > 0 for _, change in changes):
        return None
    return Potential(terms, lowering)


def most_change(rule: RuleBits, terms: Sequence[Term]) -> int | None:
    """The most by which a rule can change a weighted sum; None if there is no such number."""
    total = 0
    for feature, of_truth, weight in terms:
        bit = 1 << feature
        if of_truth:
            if rule.touched & bit:
                total += max(weight * (after - before) for before, after in rule.pairs(feature))
        elif (rule.may_rise if weight > 0 else rule.may_fall) & bit:
            return None
        elif (rule.falls if weight > 0 else rule.rises) & bit:
            total -= abs(weight)
    return total


Column = tuple[int, bool, int]
"""A variable of the linear programme, not negative: feature, whether it is the weight of its
truth value or of the number, and the sign with which it counts."""


def _columns(rules: Collection[RuleBits], bounded: int) -> list[Column]:
    """What may have a weight: bits that change, numbers that none moves the wrong way."""
    changes = falls = rises = may_fall = may_rise = 0
    for rule in rules:
        changes |= rule.touched
        falls |= rule.falls
        rises |= rule.rises
        may_fall |= rule.may_fall
        may_rise |= rule.may_rise
    columns = [(f, False, 1) for f in members(falls & ~may_rise)]
    columns += [(f, False, -1) for f in members(rises & bounded & ~may_fall)]
    columns += [(f, True, sign) for f in members(changes) for sign in (1, -1)]
    return columns


def _row(rule: RuleBits, columns: Mapping[Column, int]) -> dict[int, int]:
    """Coefficients, by column, of an upper bound on what a rule can do to the sum.

    With the weight of a truth value as a difference of two numbers that are not negative, the
    most that a change by -1, 0 or 1 adds is linear in them, and exact where one of them is 0.
    """
    row: dict[int, int] = {}
    for feature in members(rule.touched):
        changes = [after - before for before, after in rule.pairs(feature)]
        for sign in (1, -1):
            change = max(sign * change for change in changes)
            # A fall that need not happen is no help: it counts as none.
            if change and (change > 0 or 0 not in changes):
                row[columns[feature, True, sign]] = change
    for mask, sign in ((rule.falls, 1), (rule.rises, -1)):
        for feature in members(mask):
            if (feature, False, sign) in columns:
                row[columns[feature, False, sign]] = -1
    return row
