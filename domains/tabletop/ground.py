"""Supports as the planner handles them: regions that things rest on, and who owns them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from runtime.world.poses import Floats, Pose, apply, invert


@dataclass(frozen=True, eq=False)
class Ground:
    """A region that things may rest on. `owner` is the index of the object that it belongs to,
    None where it does not move; `pose` (3, 4) puts its middle into the world, or into the
    standing frame of its owner. `half` are half its extents, `clearance` what is free above."""

    name: str
    owner: int | None
    pose: Pose
    half: tuple[float, float]
    clearance: float

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
        inside = apply(invert(self.pose), np.array([[x, y, self.height]]))[0]
        return float(inside[0]), float(inside[1])

    def outside(self, lx: float, ly: float) -> tuple[float, float]:
        """A point of the region in the frame that `pose` is given in."""
        point = apply(self.pose, np.array([[lx, ly, 0.0]]))[0]
        return float(point[0]), float(point[1])

    def contains(self, x: float, y: float, inset: float = 0.0) -> bool:
        """Whether a point of the plane is on the region, `inset` metres from its edge."""
        lx, ly = self.local(x, y)
        return abs(lx) <= self.half[0] - inset and abs(ly) <= self.half[1] - inset

    def lattice(self, spacing: float, inset: float) -> Floats:
        """Points (S, 2) that cover the region evenly, `inset` metres from its edge, in the
        frame that `pose` is given in."""
        spans = [max(half - inset, 0.0) for half in self.half]
        counts = [int(2 * span / spacing + 1e-9) + 1 for span in spans]
        axes = [
            np.linspace(-span, span, count) if count > 1 else np.zeros(1)
            for span, count in zip(spans, counts, strict=True)
        ]
        return np.array([self.outside(lx, ly) for lx in axes[0] for ly in axes[1]])
