"""What invariants exclude: each other, the goal, rules."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING

from sketchlang.checking.report import Report
from sketchlang.diagnostics import Label
from sketchlang.model import And, Formula, Invariant, Literal, Not, Or, Rule, holds

if TYPE_CHECKING:
    from sketchlang.analysis.contradiction import Together

_MAX_INVARIANT_FEATURES = 12

MOST_WORK = 100_000
"""Steps that are spent on what several invariants say together: well under a tenth of a second."""

MOST_SHOWN = 8
"""Invariants that are shown in their places, of those that exclude something together."""


class Stated:
    """The invariants of a sketch, each of which can hold on its own, and where they stand.

    That they contradict each other is said as they are read; of such invariants nothing else is
    said, since they exclude everything.
    """

    def __init__(
        self, invariants: Sequence[Invariant], places: Sequence[Label], report: Report
    ) -> None:
        self._invariants = invariants
        self._places = places
        self._report = report
        self._together = self._made()
        chosen = () if self._together is None else self._together.contradiction()
        if chosen:
            self._together = None
            self._tell_contradiction(chosen)

    def _made(self) -> Together | None:
        if not self._invariants:
            return None
        from sketchlang.analysis.contradiction import Together

        return Together([one.formula for one in self._invariants], MOST_WORK)

    def _tell_contradiction(self, chosen: Sequence[int]) -> None:
        """The last one of them is where it becomes impossible."""
        *others, last = chosen
        this = f"`{self._invariants[last].text}`"
        with_ = "the other invariant" if len(others) == 1 else f"{len(others)} other invariants"
        self._report.add(
            "contradicting-invariants",
            f"{this} and {with_} can never hold together",
            self._places[last],
            *self._labels(others),
            hint="No state satisfies them all. Correct or remove one of them.",
        )

    def against_goal(self, goal: Mapping[int, bool], place: Label) -> None:
        """Warns if no goal state satisfies the invariants."""
        chosen = () if self._together is None else self._together.contradiction(goal)
        if chosen:
            self._report.add(
                "goal-against-invariant",
                f"the goal can never hold: {self._excluded_by(chosen)}",
                place,
                *self._labels(chosen),
            )

    def against_rule(self, rule: Rule, place: Label) -> None:
        """Warns if the conditions of a rule hold in no state that satisfies the invariants."""
        chosen = () if self._together is None else self._together.contradiction(rule.conditions)
        if chosen:
            self._report.add(
                "rule-against-invariant",
                f"rule `{rule.name}` never applies: {self._excluded_by(chosen)}",
                place,
                *self._labels(chosen),
            )

    def _excluded_by(self, chosen: Sequence[int]) -> str:
        if len(chosen) == 1:
            return f"`{self._invariants[chosen[0]].text}` excludes it"
        return f"{len(chosen)} invariants together exclude it"

    def _labels(self, chosen: Sequence[int]) -> list[Label]:
        places = [self._places[number] for number in chosen[:MOST_SHOWN]]
        return [Label(place.source, place.span, "invariant") for place in places]


def features_of(formula: Formula) -> set[int]:
    """The features that a formula speaks of."""
    match formula:
        case Literal(feature, _):
            return {feature}
        case Not(operand):
            return features_of(operand)
        case And(operands) | Or(operands):
            return set().union(*map(features_of, operands))


def satisfiable(formula: Formula, fixed: Mapping[int, bool]) -> bool:
    """Whether a formula can hold where some features are fixed (True for large formulas)."""
    features = sorted(features_of(formula))
    free = [f for f in features if f not in fixed]
    if len(free) > _MAX_INVARIANT_FEATURES:
        return True
    values = [0] * (max(features, default=-1) + 1)
    for f in features:
        values[f] = int(fixed.get(f, False))
    for choice in product((0, 1), repeat=len(free)):
        for f, value in zip(free, choice, strict=True):
            values[f] = value
        if holds(formula, tuple(values)):
            return True
    return False
