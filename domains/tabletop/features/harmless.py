"""Sites of a goal at which an object would be in nobody's way, all of them looked at at once.

A table is carried over from arrangement to arrangement: only the rows of what moved are new.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.features import swept
from domains.tabletop.features.goals import GoalSites

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement
    from domains.tabletop.world import Ints

Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class SiteTable:
    """Of objects (n,) and the sites (S,) of a goal on furniture, for something of one kind:
    `bars` (n, S) is whether it would bar a heading to an object from a site, `stands` (n, S)
    whether an object stands there. `barred`, `taken` (S,) are how many of each."""

    bars: Bools
    stands: Bools
    barred: Ints
    taken: Ints

    @classmethod
    def afresh(cls, here: Arrangement, index: int, goal: GoalSites) -> SiteTable:
        """The table for the kind of an object."""
        everything = list(range(len(here.boxes)))
        bars, stands = _rows(here, index, goal, everything)
        return cls(bars, stands, bars.sum(axis=0), stands.sum(axis=0))

    def moved(
        self, here: Arrangement, index: int, goal: GoalSites, changed: Sequence[int]
    ) -> SiteTable:
        """The table in an arrangement that differs from its own in some objects."""
        rows = _rows(here, index, goal, changed)
        bars, barred = _replaced(self.bars, self.barred, changed, rows[0])
        stands, taken = _replaced(self.stands, self.taken, changed, rows[1])
        return SiteTable(bars, stands, barred, taken)

    def free(self, index: int) -> Bools:
        """The sites at which no other object stands (S,)."""
        found: Bools = self.taken == self.stands[index]
        return found

    def harmless(self, index: int) -> Bools:
        """The free sites from which it bars no heading to any other object (S,)."""
        found: Bools = self.free(index) & (self.barred == self.bars[index])
        return found


def _replaced(
    table: Bools, counts: Ints, changed: Sequence[int], rows: Bools
) -> tuple[Bools, Ints]:
    """A table (n, S) and its sums (S,) with other rows for some objects."""
    found, old = table.copy(), table[changed]
    found[changed] = rows
    summed: Ints = counts - old.sum(axis=0) + rows.sum(axis=0)
    return found, summed


def _rows(
    here: Arrangement, index: int, goal: GoalSites, chosen: Sequence[int]
) -> tuple[Bools, Bools]:
    """The rows of some objects."""
    world = here.world
    bars = (here.bars(world.site_boxes(index, goal), chosen) != 0).any(axis=0)
    stands = swept.standing_at(goal.xyz, world.own(index), here.boxes[chosen])
    return bars, stands
