"""Supports as the planner handles them: regions that things rest on, and who owns them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runtime.world.poses import Floats, Pose, apply
from runtime.world.world import Peg

MIDDLE = 0.01
"""Metres from the middle of a hole within which something is right over it."""


@dataclass(frozen=True, eq=False)
class Ground:
    """A region that things may rest on. `owner` is the index of the object that it belongs to,
    None where it does not move; `pose` (3, 4) puts its middle into the world, or into the
    standing frame of its owner. `half` are half its extents, `clearance` what is free above, but
    for a `peg`, over which what stands there has to go."""

    name: str
    owner: int | None
    pose: Pose
    half: tuple[float, float]
    clearance: float
    peg: Peg | None = None

    @property
    def yaw(self) -> float:
        """Heading of the region's x axis, radians."""
        return float(np.arctan2(self.pose[1, 0], self.pose[0, 0]))

    @property
    def height(self) -> float:
        """Height of what rests here, metres, in the frame that `pose` is given in."""
        return float(self.pose[2, 3])

    def local(self, x: float, y: float) -> tuple[float, float]:
        """A point of the plane in the frame of the region."""
        a, b, x0, c, d, y0 = self._plane
        dx, dy = x - x0, y - y0
        return a * dx + c * dy, b * dx + d * dy

    def outside(self, lx: float, ly: float) -> tuple[float, float]:
        """A point of the region in the frame that `pose` is given in."""
        a, b, x0, c, d, y0 = self._plane
        return a * lx + b * ly + x0, c * lx + d * ly + y0

    @cached_property
    def _plane(self) -> tuple[float, ...]:
        """The first two rows of the pose without z, as plain numbers: points come one by one."""
        return tuple(self.pose[:2, [0, 1, 3]].ravel().tolist())

    def contains(self, x: float, y: float, inset: float = 0.0) -> bool:
        """Whether a point of the plane is on the region, `inset` metres from its edge."""
        lx, ly = self.local(x, y)
        return abs(lx) <= self.half[0] - inset and abs(ly) <= self.half[1] - inset

    def is_over(self, x: float, y: float) -> bool:
        """Whether a point of the plane is over the peg of the region, or in the middle of the hole
        in it."""
        lx, ly = self.local(x, y)
        least = MIDDLE if self.peg is None else max(self.peg.radius, MIDDLE)
        return abs(lx) < least and abs(ly) < least

    def lattice(self, spacing: float, inset: float) -> Floats:
        """Points (S, 2) that cover the region evenly, `inset` metres from its edge, in the
        frame that `pose` is given in."""
        spans = [max(half - inset, 0.0) for half in self.half]
        counts = [int(2 * span / spacing + 1e-9) + 1 for span in spans]
        axes = [
            np.linspace(-span, span, count) if count > 1 else np.zeros(1)
            for span, count in zip(spans, counts, strict=True)
        ]
        lx, ly = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
        return apply(self.pose, np.column_stack([lx, ly, np.zeros(len(lx))]))[:, :2].copy()
