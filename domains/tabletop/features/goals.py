"""Where each object should stand: goal sites, and which objects are there already."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.state import Placement

if TYPE_CHECKING:
    from domains.tabletop.scene.model import Surface
    from runtime.robot.model import Floats, Ints

LATTICE = 0.1
"""Metres between the sites by which a goal region is judged (the published bin size)."""


@dataclass(frozen=True, eq=False)
class GoalSites:
    """Sites where an object would be well placed.

    `xy` (S, 2); `reachable` (S,) bits of headings from which the robot can come; `yaw` is
    the heading that the object must have there, up to a turn of 2 pi / `symmetry`, or None
    where any will do. `key` tells groups of sites apart.
    """

    key: tuple[object, ...]
    surface: int
    xy: Floats
    reachable: Ints
    tolerance: float
    yaw: float | None = None
    symmetry: int = 0
    region: Surface | None = field(default=None, repr=False)

    @property
    def modulus(self) -> int:
        """Headings of pick and place are tied together modulo this number of steps."""
        return 1 if self.yaw is None else swept.HEADINGS // self.symmetry

    def holds(self, placement: Placement) -> bool:
        """Whether an object with this placement is well placed."""
        if placement.surface != self.surface:
            return False
        x, y, yaw = placement.pose
        if self.region is not None:
            return self.region.contains(x, y)
        if np.hypot(self.xy[:, 0] - x, self.xy[:, 1] - y).min() > self.tolerance:
            return False
        return self.yaw is None or turn_error(yaw - self.yaw, self.symmetry) < 0.05

    @cached_property
    def circle(self) -> tuple[tuple[float, float], float]:
        """Centre and radius, in metres, of a circle around the sites."""
        x, y = (self.xy.min(axis=0) + self.xy.max(axis=0)) / 2
        return (x, y), float(np.hypot(self.xy[:, 0] - x, self.xy[:, 1] - y).max())

    @cached_property
    def placements(self) -> tuple[Placement, ...]:
        """One placement a site."""
        yaw = self.yaw or 0.0
        return tuple(Placement.of(x, y, yaw, self.surface) for x, y in self.xy)


def turn_error(angle: float, symmetry: int) -> float:
    """How far an angle is from the nearest multiple of 2 pi / symmetry, in radians."""
    step = 2 * math.pi / symmetry
    return abs(angle - step * round(angle / step))


def lattice(surface: Surface, inset: float) -> Floats:
    """Sites (S, 2) that cover a surface evenly, `inset` metres from its edge."""
    spans = [max(half - inset, 0.0) for half in surface.half]
    counts = [int(2 * span / LATTICE + 1e-9) + 1 for span in spans]
    axes = [
        np.linspace(-span, span, count) if count > 1 else np.zeros(1)
        for span, count in zip(spans, counts, strict=True)
    ]
    return np.array([surface.table.world(lx, ly) for lx in axes[0] for ly in axes[1]])
