"""Sets of valuations as cubes: conjunctions of literals, one cube a pair of bit masks.

The operations are those of two-level logic minimisation (Brayton et al., Logic Minimization
Algorithms for VLSI Synthesis, 1984): complement by case distinction, and expansion of cubes
against the set they must not touch.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from sketchlang.analysis.bits import members
from sketchlang.model import And, Formula, Literal, Not, Or

LITERALS_A_STEP = 16
"""Literals of a cube that are looked at in one step."""

MOST_CHOSEN = 300
"""Features of a set that hits others, at most: the search for it calls itself so often."""


class TooManyCubesError(Exception):
    """A set falls into more cubes than the caller is ready to wait for."""


class Cube(NamedTuple):
    """The valuations v with `v & known == bits`; `bits` is a subset of `known`."""

    known: int
    bits: int


EVERYTHING = Cube(0, 0)


class Work:
    """Counts steps, so that the same sketch always gets the same answer, however long it takes."""

    def __init__(self, most: int) -> None:
        self.left = most

    def step(self, steps: int = 1) -> None:
        """Raises `TooManyCubesError` when the steps are used up."""
        self.left -= steps
        if self.left < 0:
            raise TooManyCubesError


def disjoint(a: Cube, b: Cube) -> bool:
    return bool((a.bits ^ b.bits) & a.known & b.known)


def intersection(a: Cube, b: Cube) -> Cube | None:
    return None if disjoint(a, b) else Cube(a.known | b.known, a.bits | b.bits)


def contains(outer: Cube, inner: Cube) -> bool:
    return not outer.known & ~inner.known and not (outer.bits ^ inner.bits) & outer.known


def complement(cubes: Iterable[Cube], work: Work, within: Cube = EVERYTHING) -> list[Cube]:
    """Disjoint cubes for what is in `within` and in none of the cubes."""
    relevant = [
        Cube(cube.known & ~within.known, cube.bits & ~within.known)
        for cube in cubes
        if not disjoint(cube, within)
    ]
    found: list[Cube] = []
    longest = max((cube.known.bit_count() for cube in relevant), default=0)
    steps = max(1, longest // LITERALS_A_STEP)  # for a cube
    # What is left to take away is over features that are not known on the path to there.
    waiting = [(relevant, within)]
    while waiting:
        left, path = waiting.pop()
        work.step(1 + len(left) * steps)
        if not left:
            found.append(path)
        elif all(cube.known for cube in left):
            feature = _dividing(left)
            waiting += [_half(left, path, 1 << feature, value) for value in (1 << feature, 0)]
    return found


def _dividing(cubes: Sequence[Cube]) -> int:
    """The feature that most cubes ask for; a short cube is the sooner used up."""
    counts: dict[int, int] = {}
    for cube in cubes:
        weight = 1 << max(0, 8 - cube.known.bit_count())
        for feature in members(cube.known):
            counts[feature] = counts.get(feature, 0) + weight
    return max(counts, key=lambda f: (counts[f], -f))


def _half(cubes: Sequence[Cube], path: Cube, bit: int, value: int) -> tuple[list[Cube], Cube]:
    """The cubes and the path where one more feature is known."""
    rest = [
        Cube(cube.known & ~bit, cube.bits & ~bit)
        for cube in cubes
        if not cube.known & bit or cube.bits & bit == value
    ]
    return rest, Cube(path.known | bit, path.bits | value)


def covered(cube: Cube, by: Iterable[Cube], work: Work) -> bool:
    """Whether every valuation of a cube is in some of the others."""
    return not complement(by, work, within=cube)


def expanded(cube: Cube, off: Sequence[Cube], work: Work) -> Cube:
    """The cube with as few of its literals as keep it apart from every cube in `off`."""
    work.step(len(off))
    clashes = {(cube.bits ^ other.bits) & cube.known & other.known for other in off}
    kept = fewest_hitting(sorted(clashes, key=int.bit_count), work)
    return Cube(kept, cube.bits & kept)


def fewest_hitting(sets: Sequence[int], work: Work) -> int:
    """A smallest set (as a mask) that meets all the given ones, none of which is empty."""
    minimal: list[int] = []
    for candidate in sets:
        work.step(1 + len(minimal))
        if not any(smaller & ~candidate == 0 for smaller in minimal):
            minimal.append(candidate)
    best = 0
    for candidate in minimal:
        best |= candidate

    def search(left: list[int], chosen: int) -> None:
        nonlocal best
        work.step(1 + len(left))
        if chosen.bit_count() > MOST_CHOSEN:
            raise TooManyCubesError
        if chosen.bit_count() + bool(left) >= best.bit_count():
            if not left and chosen.bit_count() < best.bit_count():
                best = chosen
            return
        if not left:
            best = chosen
            return
        for feature in members(min(left, key=int.bit_count)):
            bit = 1 << feature
            search([candidate for candidate in left if not candidate & bit], chosen | bit)

    search(minimal, 0)
    return best


def fewest_cubes(on: Sequence[Cube], off: Sequence[Cube], work: Work) -> list[Cube]:
    """Few large cubes that together contain `on` and touch nothing of `off`."""
    chosen = list(dict.fromkeys(expanded(cube, off, work) for cube in on))
    # Leave out what the others cover, the most special ones first.
    for cube in sorted(chosen, key=lambda c: (-c.known.bit_count(), c)):
        work.step(len(on) + len(chosen))
        others = [other for other in chosen if other != cube]
        if all(
            covered(part, others, work)
            for part in (intersection(cube, piece) for piece in on)
            if part is not None
        ):
            chosen = others
    return sorted(chosen, key=lambda c: (c.known.bit_count(), c))


def cubes_of(formula: Formula, value: bool, work: Work) -> list[Cube]:
    """Cubes that together are the valuations in which a formula has a truth value."""
    work.step()
    match formula:
        case Literal(feature, positive):
            return [Cube(1 << feature, (positive == value) << feature)]
        case Not(operand):
            return cubes_of(operand, not value, work)
        case And(operands) | Or(operands):
            parts = [cubes_of(operand, value, work) for operand in operands]
            if isinstance(formula, Or) == value:
                return _without_contained([cube for part in parts for cube in part])
            product = [EVERYTHING]
            for part in parts:
                pairs = [(a, b) for a in product for b in part]
                work.step(len(pairs))
                met = [intersection(a, b) for a, b in pairs]
                product = _without_contained([cube for cube in met if cube is not None])
            return product


def _without_contained(cubes: list[Cube]) -> list[Cube]:
    kept: list[Cube] = []
    for cube in sorted(set(cubes), key=lambda c: (c.known.bit_count(), c)):
        if not any(contains(other, cube) for other in kept):
            kept.append(cube)
    return kept
