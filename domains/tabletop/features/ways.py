"""The ways to objects and to the sites of goals in one arrangement, and what bars them."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.features import swept
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import HEADINGS
from domains.tabletop.footprints import footprints_meet
from domains.tabletop.state import Placement
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.holds import SiteHold
    from domains.tabletop.world import Ints, TabletopWorld


@dataclass(frozen=True, eq=False)
class Picks:
    """For one family of approaches, the ways to the objects where they rest.

    `barred` (n, n): headings at object i that object j bars. `holds` (n, K, 3) and `heights`
    (n,): how each is taken. `reachable` (n,): headings from which the robot could come.
    `counts` (n, K): how many objects bar each heading.
    """

    barred: Ints
    holds: Floats
    heights: Floats
    reachable: Ints
    counts: Ints


@dataclass(frozen=True, eq=False)
class Places:
    """The same for the sites of a goal: `barred` (S, n), `counts` (S, K), `reachable` (S,).
    `stands` (S, 8) are boxes around the object at the sites where its heading there is known;
    `spared` is which boxes, by what they are known as, leave a way free (`Arrangement`)."""

    goal: GoalSites
    hold: SiteHold
    own: Floats
    barred: Ints
    counts: Ints
    reachable: Ints
    stands: Floats | None = None
    spared: dict[Hashable, NDArray[np.bool_]] = field(default_factory=dict)

    @cached_property
    def extent(self) -> float:
        """Metres from a site to the corners of the object there, where its heading is known."""
        if self.stands is None:
            return 0.0
        return float(np.hypot(self.stands[:, 3], self.stands[:, 4]).max())

    @cached_property
    def free(self) -> Ints:
        """Bits of the headings to each site that nothing bars (S,)."""
        found: Ints = ((self.counts == 0) << np.arange(HEADINGS)).sum(axis=1)
        return found

    @cached_property
    def repeated(self) -> tuple[Floats, Floats, Floats]:
        """The hold's rows, its height and the object's own size, once for each site."""
        n = len(self.goal.xyz)
        return (
            np.tile(self.hold.rows, (n, 1, 1)),
            np.full(n, self.hold.height),
            np.tile(self.own, (n, 1)),
        )


def face_of(placement: Placement | None) -> int:
    """The face on which an object rests; that of the start where it is held."""
    return 0 if placement is None else placement.face


def pick_row(
    world: TabletopWorld,
    index: int,
    family: int,
    site: Floats,
    yaw: float,
    placement: Placement | None,
    present: int,
) -> tuple[Floats, float, int]:
    """How an object is taken where it rests, and bits of the headings that the robot reaches."""
    if not present:
        return np.zeros((HEADINGS, 3)), 0.0, 0
    face = face_of(placement)
    hold = world.hold(index, family, yaw, face)
    x, y, z = site.tolist()
    return hold.rows, hold.height, world.reachable_at(index, family, (x, y, z, yaw), face)


def columns(rows: Sequence[tuple[Floats, float, int]]) -> tuple[Floats, Floats, Ints]:
    holds = np.array([row[0] for row in rows]).reshape(-1, HEADINGS, 3)
    heights = np.array([row[1] for row in rows], dtype=np.float64)
    return holds, heights, np.array([row[2] for row in rows], dtype=np.int64)


def place_barred(world: TabletopWorld, ways: Places, family: int, boxes: Floats) -> Ints:
    """Bits (S, n) of the headings to the sites of a goal that boxes (n, 8) bar."""
    holds, heights, owns = ways.repeated
    sweep = world.hand.sweeps[family]
    found: Ints = swept.barred_matrix(ways.goal.xyz, holds, heights, owns, boxes, sweep, 0.0)
    for s, stands in enumerate(() if ways.stands is None else ways.stands):
        # Where its heading is prescribed, what reaches into its corners is in its place, too.
        away = np.hypot(boxes[:, 0] - stands[0], boxes[:, 1] - stands[1])
        near = away < np.hypot(boxes[:, 3], boxes[:, 4]) + math.hypot(stands[3], stands[4])
        for j in np.flatnonzero(near & (found[s] != swept.ALL)):
            apart = abs(boxes[j, 2] - stands[2]) >= boxes[j, 5] + stands[5] - swept.LEVEL
            if not apart and footprints_meet(stands, boxes[j], 0.0):
                found[s, j] = swept.ALL
    return found
