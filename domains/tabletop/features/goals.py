"""Where each object should be: goal sites, and which objects are there already."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.state import UNIT, Placement, quantise_angle
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.ground import Ground

LATTICE = 0.1
"""Metres between the sites by which a goal region is judged (the published bin size)."""

TURNED = 0.05
"""Radians by which an object may be off the heading that its goal prescribes."""


@dataclass(frozen=True, eq=False)
class GoalSites:
    """Sites where an object would be well placed, on one support.

    `xy` (S, 2) are sites in the frame of the support's pose and `xyz` (S, 3) in the world;
    `yaw` is the heading that the object must have there, up to a turn of 2 pi / `symmetry`, or
    None where any will do. `region` is given where anywhere on it is well. `frame` is the
    heading of the support's owner, None where that does not move; `bearers` are all objects that
    bear what is there. `key` tells groups of sites
    apart.
    """

    key: tuple[object, ...]
    support: int
    xy: Floats
    xyz: Floats
    tolerance: float
    yaw: float | None = None
    symmetry: int = 1
    region: Ground | None = None
    frame: float | None = None
    bearers: tuple[int, ...] = ()

    @property
    def world_yaw(self) -> float | None:
        """The prescribed heading in the world, radians."""
        return None if self.yaw is None else self.yaw + (self.frame or 0.0)

    @property
    def modulus(self) -> int:
        """Headings of pick and place are tied together modulo this number of steps."""
        if self.yaw is None:
            return 1
        return max(1, swept.HEADINGS // self.symmetry)

    def holds(self, placement: Placement) -> bool:
        """Whether an object with this placement is well placed."""
        if placement.support != self.support:
            return False
        x, y, yaw = placement.pose
        if self.region is not None:
            if not self.region.contains(x, y):
                return False
        elif np.hypot(self.xy[:, 0] - x, self.xy[:, 1] - y).min() > self.tolerance:
            return False
        return self.yaw is None or turn_error(yaw - self.yaw, self.symmetry) < TURNED

    @cached_property
    def circle(self) -> tuple[tuple[float, float], float]:
        """Centre and radius, in metres, of a circle around the sites in the world."""
        x, y = (self.xyz[:, :2].min(axis=0) + self.xyz[:, :2].max(axis=0)) / 2
        return (x, y), float(np.hypot(self.xyz[:, 0] - x, self.xyz[:, 1] - y).max())

    @cached_property
    def placements(self) -> tuple[Placement, ...]:
        """One placement a site."""
        yaw = quantise_angle(self.yaw or 0.0)
        steps = np.rint(self.xy / UNIT).astype(np.int64).tolist()
        return tuple(Placement(x, y, yaw, self.support) for x, y in steps)


def turn_error(angle: float, symmetry: int) -> float:
    """How far an angle is from the nearest multiple of 2 pi / symmetry, in radians."""
    step = 2 * math.pi / symmetry
    return abs(angle - step * round(angle / step))
