"""Two sketches side by side: is every subgoal of the one a subgoal of the other?

What a rule asks of one feature before and after is one of four cases for a Boolean, and one of six
for a nat: 0 or > 0 before, 0 or > 0 after, and whether it falls, stays or rises. A rule allows
some cases of each feature, whatever the others do: a box. So subgoals are a union of boxes,
and the question is whether one union covers another, which case distinction answers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from sketchlang.analysis.bits import members
from sketchlang.analysis.cubes import Work, cubes_of
from sketchlang.model import Effect, Feature, Kind, Rule, SketchModel

BOOL_CASES = ((0, 0), (0, 1), (1, 0), (1, 1))
NAT_CASES = ((0, 0), (0, 1), (1, 0), (2, 1), (1, 1), (1, 2))
"""Values before and after that stand for all pairs of their case."""

MOST_WORK = 10_000_000
"""Steps before a comparison is given up: some seconds."""

FEATURES_A_STEP = 4
"""Features of two boxes that are compared in a step."""

Box = tuple[int, ...]
"""For each feature the cases allowed, as a mask."""


class NotComparableError(Exception):
    """A feature has different kinds in the two sketches; the message names it."""


@dataclass(frozen=True, slots=True)
class Witness:
    """A subgoal of one sketch that is none of the other.

    Values by feature, before and after; `rule` of the first sketch allows the pair, None if
    it is because the second valuation is its goal.
    """

    before: Mapping[str, int]
    after: Mapping[str, int]
    rule: str | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """`only_first` is a subgoal of the first sketch alone, `only_second` of the second; None
    where there is no such subgoal."""

    only_first: Witness | None
    only_second: Witness | None

    @property
    def verdict(self) -> str:
        """`equivalent`, `first-refines-second`, `second-refines-first` or `different`."""
        match (self.only_first is None, self.only_second is None):
            case (True, True):
                return "equivalent"
            case (True, False):
                return "first-refines-second"
            case (False, True):
                return "second-refines-first"
            case _:
                return "different"


def compare(first: SketchModel, second: SketchModel) -> Comparison:
    """Compares the subgoals of two sketches, feature by name.

    A pair of valuations counts if the first is no goal of the sketch and the invariants of
    both sketches hold in both. A feature that a sketch does not have may do anything there.

    Raises:
        NotComparableError: a name stands for a Boolean and for a nat.
        TooManyCubesError: it would take too long to tell.
    """
    space = _Space(first, second)
    return Comparison(space.uncovered(first, second), space.uncovered(second, first))


class _Space:
    """The features of both sketches, and the pairs of valuations that do not count."""

    def __init__(self, first: SketchModel, second: SketchModel) -> None:
        declared: dict[str, Feature] = {}
        for feature in (*first.features, *second.features):
            known = declared.setdefault(feature.name, feature)
            if known.kind is not feature.kind:
                raise NotComparableError(
                    f"{feature.name} is a {known.kind.value} here, a {feature.kind.value} there"
                )
        self.names = list(declared)
        self.cases = [
            BOOL_CASES if feature.kind is Kind.BOOL else NAT_CASES for feature in declared.values()
        ]
        self.place = {name: i for i, name in enumerate(self.names)}
        self.everything: Box = tuple((1 << len(cases)) - 1 for cases in self.cases)
        self.work = Work(MOST_WORK)
        self.excluded = [box for model in (first, second) for box in self._excluded(model)]

    def uncovered(self, model: SketchModel, other: SketchModel) -> Witness | None:
        """A subgoal of the first model that the other does not have."""
        cover = [box for box, _ in self._subgoals(other)] + self.excluded
        for box, rule in self._subgoals(model):
            found = self._outside(box, cover)
            if found is not None:
                chosen = [
                    cases[(mask & -mask).bit_length() - 1]
                    for cases, mask in zip(self.cases, found, strict=True)
                ]
                before = {name: b for name, (b, _) in zip(self.names, chosen, strict=True)}
                after = {name: a for name, (_, a) in zip(self.names, chosen, strict=True)}
                return Witness(before, after, rule)
        return None

    def _subgoals(self, model: SketchModel) -> Iterator[tuple[Box, str | None]]:
        """Boxes of the pairs that satisfy a rule or end in the goal, and begin in none."""
        boxes: list[tuple[Box, str | None]] = [
            (self._of_rule(model, rule), rule.name) for rule in model.rules
        ]
        starts = [self.everything]
        if model.goal is not None:
            literals = {model.features[f].name: value for f, value in model.goal.items()}
            boxes.append((self._where(literals, 1), None))
            starts = list(self._not_before(literals))
        for box, rule in boxes:
            for start in starts:
                self.work.step(1 + len(box) // FEATURES_A_STEP)
                met = _met(box, start)
                if met is not None:
                    yield met, rule

    def _of_rule(self, model: SketchModel, rule: Rule) -> Box:
        box = list(self.everything)
        for f, feature in enumerate(model.features):
            place = self.place[feature.name]
            condition, effect = rule.conditions.get(f), rule.effects.get(f)
            box[place] = sum(
                1 << number
                for number, (before, after) in enumerate(self.cases[place])
                if condition in (None, before > 0) and _allows(effect, before, after)
            )
        return tuple(box)

    def _where(self, literals: Mapping[str, bool], side: int) -> Box:
        """The pairs in which literals hold before (side 0) or after (side 1)."""
        box = list(self.everything)
        for name, value in literals.items():
            place = self.place[name]
            box[place] = sum(
                1 << number
                for number, case in enumerate(self.cases[place])
                if (case[side] > 0) == value
            )
        return tuple(box)

    def _not_before(self, literals: Mapping[str, bool]) -> Iterator[Box]:
        """Disjoint boxes of the pairs in which some literal does not hold before."""
        held: dict[str, bool] = {}
        for name, value in literals.items():
            yield self._where({**held, name: not value}, 0)
            held[name] = value

    def _excluded(self, model: SketchModel) -> Iterator[Box]:
        for invariant in model.invariants:
            for cube in cubes_of(invariant.formula, False, self.work):
                literals = {
                    model.features[f].name: bool(cube.bits >> f & 1) for f in members(cube.known)
                }
                yield self._where(literals, 0)
                yield self._where(literals, 1)

    def _outside(self, box: Box, cover: Sequence[Box]) -> Box | None:
        """A part of a box that no box of the cover meets, None if there is none."""
        waiting = [(box, cover)] if all(box) else []
        while waiting:
            box, cover = waiting.pop()
            self.work.step(1 + len(cover) * len(box) // FEATURES_A_STEP)
            near = [met for met in (_met(box, other) for other in cover) if met is not None]
            if not near:
                return box
            if box in near:
                continue
            place = _dividing(box, near)
            parts = _parts(box[place], {other[place] for other in near})
            smaller = [(*box[:place], part, *box[place + 1 :]) for part in reversed(parts)]
            waiting += [(one, near) for one in smaller]
        return None


def _allows(effect: Effect | None, before: int, after: int) -> bool:
    return before == after if effect is None else effect.allows(before, after)


def _met(a: Box, b: Box) -> Box | None:
    met = tuple(x & y for x, y in zip(a, b, strict=True))
    return met if all(met) else None


def _dividing(box: Box, near: Iterable[Box]) -> int:
    """The feature in which most boxes leave out cases, boxes with few such features first."""
    weights = [0] * len(box)
    for other in near:
        places = [i for i, mask in enumerate(other) if mask != box[i]]
        for i in places:
            weights[i] += 1 << max(0, 8 - len(places))
    return max(range(len(box)), key=lambda i: weights[i])


def _parts(mask: int, others: set[int]) -> list[int]:
    """The cases of a mask, those together that all of the other masks treat alike."""
    groups: dict[tuple[bool, ...], int] = {}
    ordered = sorted(others)
    for case in members(mask):
        signature = tuple(bool(other >> case & 1) for other in ordered)
        groups[signature] = groups.get(signature, 0) | 1 << case
    return list(groups.values())
