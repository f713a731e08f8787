"""Formulas that cannot hold together, and the fewest of them that cannot.

A search for a valuation in which all of them hold (Davis, Putnam, Logemann, Loveland) fails by way
of some of them only: these contradict each other already. As many as possible are left out again.
Fewer may do in another combination, which implicit hitting sets find (Ignatiev, Previti,
Liffiton and Marques-Silva, Smallest MUS Extraction with Minimal Hitting Set Dualization, CP 2015):
whatever contradicts has, for every valuation, a formula that is false there. Where the fewest
that hit all valuations seen so far can hold, there is one more valuation to hit.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from sketchlang.analysis.bits import members
from sketchlang.analysis.cubes import (
    Cube,
    TooManyCubesError,
    Work,
    cubes_of,
    disjoint,
    fewest_hitting,
)
from sketchlang.model import Formula


class Together:
    """Formulas that are to hold together, with a limit of work for all that is asked of them."""

    def __init__(self, formulas: Sequence[Formula], most_work: int) -> None:
        self._work = Work(most_work)
        self._false: list[tuple[int, Cube]] = []
        try:
            for number, formula in enumerate(formulas):
                self._false += [(number, cube) for cube in cubes_of(formula, False, self._work)]
        except TooManyCubesError:
            self._false = []

    def contradiction(self, fixed: Mapping[int, bool] | None = None) -> tuple[int, ...]:
        """The fewest formulas that cannot hold together where some features are `fixed`.

        Empty if all can hold, or if that is too much work to find out. Where it is too much work to
        find the fewest there are more than that.
        """
        fixed = fixed or {}
        within = Cube(sum(1 << f for f in fixed), sum(1 << f for f, true in fixed.items() if true))
        found = 0
        try:
            _, found = self._outside(-1, within)
            for number in members(found):
                if found >> number & 1:
                    found = self._outside(found & ~(1 << number), within)[1] or found
            found = self._fewest(found, within)
        except TooManyCubesError:
            pass
        return tuple(members(found))

    def _fewest(self, found: int, within: Cube) -> int:
        to_hit: list[int] = []
        while True:
            chosen = fewest_hitting(to_hit, self._work)
            if chosen.bit_count() >= found.bit_count():
                return found
            bits, _ = self._outside(chosen, within)
            if bits is None:
                return chosen
            false = {number for number, cube in self._false if not (cube.bits ^ bits) & cube.known}
            to_hit.append(sum(1 << number for number in false))

    def _outside(self, chosen: int, within: Cube) -> tuple[int | None, int]:
        """A valuation in which the chosen formulas hold and 0, or None and those of them that were
        in the way."""
        cubes = [(number, cube) for number, cube in self._false if chosen >> number & 1]
        stack = [within]
        used = 0
        while stack:
            here = stack.pop()
            self._work.step(1 + len(cubes))
            left = [(number, cube) for number, cube in cubes if not disjoint(cube, here)]
            if not left:
                return here.bits, 0
            number, shortest = min(left, key=lambda one: (one[1].known & ~here.known).bit_count())
            used |= 1 << number
            opened = shortest.known & ~here.known
            bit = opened & -opened
            # Where one feature is open only its other value is left, where none is, nothing.
            values = [shortest.bits & bit, ~shortest.bits & bit]
            stack += _branches(here, bit, values[max(0, 2 - opened.bit_count()) :])
        return None, used


def _branches(here: Cube, bit: int, values: Collection[int]) -> list[Cube]:
    return [Cube(here.known | bit, here.bits | value) for value in values]
