"""Which valuations no rule provides for, which rules never apply, and which ones overlap.

A rule provides for a valuation if its conditions hold there and its effects can happen:
`n--` needs n > 0, and some valuation that it may lead to satisfies the invariants. Where no
rule does, a search for the next subgoal has only the goal itself to look for.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sketchlang.analysis.bits import RuleBits, members, rule_bits
from sketchlang.analysis.cubes import (
    Cube,
    TooManyCubesError,
    Work,
    complement,
    contains,
    covered,
    cubes_of,
    disjoint,
    fewest_cubes,
    intersection,
)
from sketchlang.model import SketchModel

MOST_WORK = 10_000_000
"""Steps before coverage gives up: some seconds."""

MOST_EXPLAINED = 100
"""Gaps for which the obstacles are looked for."""


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A rule whose conditions hold in a gap, and why it does not help there.

    `lowered` is a nat that the rule lowers and that is 0; None: the invariants exclude all
    valuations that the rule leads to.
    """

    rule: int
    lowered: int | None


@dataclass(frozen=True, slots=True)
class Gap:
    """Valuations that no rule provides for."""

    cube: Cube
    obstacles: tuple[Obstacle, ...]


@dataclass(frozen=True, slots=True)
class Overlap:
    """Two rules that both provide for some valuations: those of the cube, or some of them."""

    first: int
    second: int
    cube: Cube


@dataclass(frozen=True, slots=True)
class Coverage:
    """Gaps, rules that no state can use, and how many valuations there are of each sort.

    The gaps are few and large if `grouped`, otherwise there are too many for that and they
    are as they were found. `possible` counts the valuations that satisfy the invariants.
    """

    gaps: tuple[Gap, ...]
    dead: tuple[int, ...]
    grouped: bool
    uncovered: int
    possible: int


class _Sets:
    """The sets of valuations that coverage is about, as cubes."""

    def __init__(self, model: SketchModel, work: Work) -> None:
        self.rules = rule_bits(model)
        self.excluded = [
            cube
            for invariant in model.invariants
            for cube in cubes_of(invariant.formula, False, work)
        ]
        self.goal: list[Cube] = []
        if model.goal is not None:
            known = sum(1 << f for f in model.goal)
            self.goal = [Cube(known, sum(1 << f for f, value in model.goal.items() if value))]
        self.usable = [_usable(rule, self.excluded, work) for rule in self.rules]


def find_coverage(model: SketchModel, most_work: int = MOST_WORK) -> Coverage:
    """All gaps and dead rules. Raises `TooManyCubesError` if that is too much work."""
    work = Work(most_work)
    sets = _Sets(model, work)
    outside = sets.excluded + sets.goal
    provided = [cube for cubes in sets.usable for cube in cubes]
    on = complement(outside + provided, work)
    dead = tuple(
        index
        for index, cubes in enumerate(sets.usable)
        if all(covered(cube, outside, work) for cube in cubes)
    )
    possible = complement(sets.excluded, work)
    try:
        off = complement(on, work)
        cubes, grouped = fewest_cubes(on, off, work), True
    except TooManyCubesError:
        cubes, grouped = sorted(on, key=lambda cube: cube.known.bit_count()), False
    count = len(model.features)
    return Coverage(
        gaps=tuple(_gaps(model, sets.rules, cubes)),
        dead=dead,
        grouped=grouped,
        uncovered=_size(on, count),
        possible=_size(possible, count),
    )


def usable_rules(model: SketchModel, most_work: int = MOST_WORK) -> frozenset[int]:
    """The rules that some valuation can use, which is no goal and no invariant excludes.

    Raises `TooManyCubesError` if that is too much work."""
    work = Work(most_work)
    sets = _Sets(model, work)
    outside = sets.excluded + sets.goal
    return frozenset(
        index
        for index, cubes in enumerate(sets.usable)
        if not all(covered(cube, outside, work) for cube in cubes)
    )


def _size(cubes: Sequence[Cube], features: int) -> int:
    """How many valuations disjoint cubes have."""
    return sum(1 << (features - cube.known.bit_count()) for cube in cubes)


def find_overlaps(model: SketchModel, most_work: int = MOST_WORK) -> list[Overlap]:
    """Pairs of rules that some state can use both."""
    work = Work(most_work)
    sets = _Sets(model, work)
    outside = sets.excluded + sets.goal
    found = []
    for second, others in enumerate(sets.usable):
        for first in range(second):
            for a in sets.usable[first]:
                met = [intersection(a, b) for b in others]
                shared = [c for c in met if c is not None and not covered(c, outside, work)]
                if shared:
                    found.append(Overlap(first, second, min(shared)))
                    break
    return sorted(found, key=lambda overlap: (overlap.first, overlap.second))


def _usable(rule: RuleBits, excluded: Sequence[Cube], work: Work) -> list[Cube]:
    """Where a rule applies and leads somewhere that is not excluded, as disjoint cubes."""
    if rule.dead:
        return []
    found: list[Cube] = []
    # The bits that these features end up with do not depend on where they were.
    changed = rule.sets | rule.clears | rule.free

    def search(where: Cube) -> None:
        work.step()
        base, free = rule.fan(where.bits)
        settled = where.known | changed
        after = Cube(settled & ~free, base & settled & ~free)
        forbidden = [cube for cube in excluded if not disjoint(cube, after)]
        undecided = 0
        for cube in forbidden:
            undecided |= cube.known & ~settled
        if undecided:
            bit = undecided & -undecided
            search(Cube(where.known | bit, where.bits))
            search(Cube(where.known | bit, where.bits | bit))
        elif not covered(after, forbidden, work):
            found.append(where)

    search(Cube(rule.needs, rule.wants))
    return found


def _gaps(model: SketchModel, rules: Sequence[RuleBits], cubes: Sequence[Cube]) -> Iterator[Gap]:
    """Gaps with the rules whose conditions hold in all of them."""
    conditions = [
        Cube(sum(1 << f for f in rule.conditions), sum(v << f for f, v in rule.conditions.items()))
        for rule in model.rules
    ]
    for number, gap in enumerate(cubes):
        found = []
        for rule in rules if number < MOST_EXPLAINED else ():
            if not contains(conditions[rule.index], gap):
                continue
            missing = rule.falls & gap.known & ~gap.bits
            if missing:
                found.append(Obstacle(rule.index, next(members(missing))))
            elif not rule.dead:
                found.append(Obstacle(rule.index, None))
        yield Gap(gap, tuple(found))
