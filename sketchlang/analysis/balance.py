"""Cycles from balances: how often each rule fires in one, then in which order.

Where no weighted sum of truth values falls, some firing counts let every truth value rise as
often as it falls (the two linear programmes are dual to each other; in Petri nets the counts are
called T-invariants, Murata, Proc. IEEE 77, 1989). Counts with few firings are found for one rule
after another, and an order by search: what rules do one after another is, for each feature
on its own, a set of (before, after) bits. A token that goes round many Booleans is found at once
like that, while its policy graph is too large to be listed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import lcm

from sketchlang.analysis.bits import RuleBits, bounded_mask, members
from sketchlang.analysis.elimination import drop
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.piece import Move
from sketchlang.analysis.programme import Matrix, solve
from sketchlang.analysis.region import Outside
from sketchlang.analysis.short_cycles import Moves, then
from sketchlang.analysis.walk import close
from sketchlang.model import SketchModel

MOST_RULES = 16
"""Rules for which counts are looked for, a linear programme each."""

MOST_TRIED = 200_000
"""Rules that are tried as the next one of a cycle, for all counts together: a fifth of a second."""

MOST_FIRINGS = 1000

FALLS_A_RISE = 4
"""Falls of a number that one rise is to make up for. Any would do, but small counts are wanted."""


def balanced_cycle(
    model: SketchModel, rules: Sequence[RuleBits], left: Sequence[RuleBits], budget: Budget
) -> tuple[Move, ...]:
    """A closed walk of the rules `left` that can be repeated for ever, or () if none is found.

    Raises:
        LimitReachedError: the time of the budget is over.
    """
    bounded = bounded_mask(model)
    outside = Outside(model)
    order = _Order((1 << len(model.features)) - 1, budget)
    seen: set[tuple[tuple[int, int], ...]] = set()
    for counts in _balances(left, bounded, budget):
        firings = tuple((number, count) for number, count in enumerate(counts) if count)
        chosen = [left[number] for number, _ in firings]
        if firings in seen or drop(chosen, bounded) is not None:
            continue
        seen.add(firings)
        found = order.of(chosen, [count for _, count in firings])
        if found:
            walk = [Move(0, rule.index, 0) for rule in found]
            cycle, reasons = close(walk, 0, model, rules, outside)
            if not reasons:
                return tuple(cycle)
    return ()


def _balances(left: Sequence[RuleBits], bounded: int, budget: Budget) -> Iterator[list[int]]:
    """Counts for the rules, as few as possible with one rule after another among them."""
    import numpy as np

    rows = [*_truth_rows(left), *_number_rows(left, bounded)]
    count = len(left)
    for number in range(min(count, MOST_RULES)):
        matrix = Matrix.of([*rows, {number: -1}], count)
        limits = np.concatenate([np.zeros(len(rows)), [-1.0]])
        found = solve(np.ones(count), matrix, limits, np.full(count, np.inf), budget)
        counts = None if found is None else _whole(found.tolist())
        if counts is not None and sum(counts) <= MOST_FIRINGS:
            yield counts


def _truth_rows(left: Sequence[RuleBits]) -> Iterator[dict[int, int]]:
    """What must be at most 0: no truth value is left higher, or lower, whatever may happen."""
    touched = 0
    for rule in left:
        touched |= rule.touched
    for feature in members(touched):
        changes = [[after - before for before, after in rule.pairs(feature)] for rule in left]
        for sign in (1, -1):
            row = {r: min(sign * one for one in each) for r, each in enumerate(changes)}
            yield {r: least for r, least in row.items() if least}


def _number_rows(left: Sequence[RuleBits], bounded: int) -> Iterator[dict[int, int]]:
    """The same for what falls and is never raised, or is bounded and the other way round."""
    for strict, against, within in (
        ([rule.falls for rule in left], [rule.may_rise for rule in left], -1),
        ([rule.rises for rule in left], [rule.may_fall for rule in left], bounded),
    ):
        changed = 0
        for mask in strict:
            changed |= mask & within
        for feature in members(changed):
            row = {
                r: (moved >> feature & 1) - FALLS_A_RISE * (back >> feature & 1)
                for r, (moved, back) in enumerate(zip(strict, against, strict=True))
            }
            yield {r: factor for r, factor in row.items() if factor}


def _whole(counts: Sequence[float]) -> list[int] | None:
    """The counts times the least number that makes them whole, None if they are no fractions."""
    fractions = [Fraction(count).limit_denominator(MOST_FIRINGS) for count in counts]
    if any(abs(float(f) - c) > 1e-6 for f, c in zip(fractions, counts, strict=True)):
        return None
    factor = lcm(*(fraction.denominator for fraction in fractions))
    return [int(fraction * factor) for fraction in fractions]


class _Order:
    """Searches for an order of firings after which every feature can have the bit it had."""

    def __init__(self, everything: int, budget: Budget) -> None:
        self._everything = everything
        self._budget = budget
        self._left = MOST_TRIED

    def of(self, rules: Sequence[RuleBits], counts: Sequence[int]) -> list[RuleBits]:
        """The rules in order, each as often as its count says; [] if no order was found."""
        moves = [self._within(rule.moves()) for rule in rules]
        everything = self._everything
        # Depth first: what was done so far, how often each rule is left, the firings.
        stack: list[tuple[Moves, tuple[int, ...], _Firings]] = [
            ((everything, 0, 0, everything), tuple(counts), None)
        ]
        seen: set[tuple[Moves, tuple[int, ...]]] = set()
        while stack:
            self._budget.check()
            so_far, left, firings = stack.pop()
            if not any(left):
                if not everything & ~(so_far[0] | so_far[3]):
                    return [rules[number] for number in _listed(firings)]
                continue
            if (so_far, left) in seen:
                continue
            seen.add((so_far, left))
            self._left -= len(rules)
            if self._left < 0:
                return []
            options = []
            for number, count in enumerate(left):
                if count:
                    after = self._within(then(so_far, moves[number]))
                    if not everything & ~(after[0] | after[1] | after[2] | after[3]):
                        # First what asks least of the features that nothing was asked of yet.
                        asked = (after[0] | after[1]) ^ (after[2] | after[3])
                        options.append((asked.bit_count(), number, after))
            for _, number, after in sorted(options, reverse=True):
                rest = (*left[:number], left[number] - 1, *left[number + 1 :])
                stack.append((after, rest, (firings, number)))
        return []

    def _within(self, moves: Moves) -> Moves:
        a, b, c, d = (mask & self._everything for mask in moves)
        return a, b, c, d


_Firings = tuple["_Firings", int] | None
"""Numbers of rules, the last one first."""


def _listed(firings: _Firings) -> list[int]:
    numbers = []
    while firings is not None:
        firings, number = firings
        numbers.append(number)
    return numbers[::-1]
