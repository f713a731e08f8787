"""Cycles of two or three rules, found without a graph.

What rules do one after another is, for each feature on its own, a set of (before, after)
bits; four masks hold it for all features at once. Sketches with hundreds of random rules
that do not terminate nearly always have such a cycle.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sketchlang.analysis.bits import RuleBits
from sketchlang.analysis.elimination import drop
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.piece import Move
from sketchlang.analysis.region import Outside
from sketchlang.analysis.walk import close
from sketchlang.model import SketchModel

MOST_TRIED = 300_000
"""Sequences of rules that are looked at: well under a second."""

Moves = tuple[int, int, int, int]
"""Masks of the features whose bit may go 0 -> 0, 0 -> 1, 1 -> 0 and 1 -> 1."""


def short_cycle(
    model: SketchModel, rules: Sequence[RuleBits], left: Sequence[RuleBits], budget: Budget
) -> tuple[Move, ...]:
    """A closed walk of two or three of the rules `left` that can be repeated for ever, or ()."""
    bounded = sum(1 << f for f, feature in enumerate(model.features) if feature.bounded)
    outside = Outside(model)
    for chosen in _candidates(left, (1 << len(model.features)) - 1, budget):
        if drop(chosen, bounded) is None:
            walk = [Move(0, rule.index, 0) for rule in chosen]
            cycle, reasons = close(walk, 0, model, rules, outside)
            if not reasons:
                return tuple(cycle)
    return ()


def _candidates(
    rules: Sequence[RuleBits], everything: int, budget: Budget
) -> Iterator[tuple[RuleBits, ...]]:
    """Two or three rules that bring every feature back to the bit it had, shorter ones first."""
    moves = [rule.moves() for rule in rules]
    follow: list[tuple[int, int, Moves]] = []
    tried = 0
    for i, first in enumerate(moves):
        budget.check()
        for j, second in enumerate(moves):
            if i == j:
                continue
            both = then(first, second)
            if everything & ~(both[0] | both[1] | both[2] | both[3]):
                continue
            if i < j and not everything & ~(both[0] | both[3]):
                yield rules[i], rules[j]
            follow.append((i, j, both))
        tried += len(moves)
        if tried > MOST_TRIED:
            return
    for number, (i, j, both) in enumerate(follow):
        if number % 256 == 0:
            budget.check()
        # The first rule is the one with the lowest number: each cycle comes once.
        for k in range(i + 1, len(moves)) if i < j else ():
            last = moves[k]
            stays = (both[0] & last[0]) | (both[1] & last[2])
            stays |= (both[2] & last[1]) | (both[3] & last[3])
            if not everything & ~stays and k != j:
                yield rules[i], rules[j], rules[k]
        tried += len(moves) - i
        if tried > MOST_TRIED:
            return


def then(first: Moves, second: Moves) -> Moves:
    """What one does after the other."""
    return (
        (first[0] & second[0]) | (first[1] & second[2]),
        (first[0] & second[1]) | (first[1] & second[3]),
        (first[2] & second[0]) | (first[3] & second[2]),
        (first[2] & second[1]) | (first[3] & second[3]),
    )
