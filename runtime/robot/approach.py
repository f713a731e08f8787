"""How a hand can come to an object, and what it sweeps: families of approaches.

All of it is derived from the URDF (`runtime.robot.sweeps`, `runtime.robot.reachable`), and is
the same for every scene. Lengths in metres.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np

from runtime.world.solids import Floats


class Family(Enum):
    """The direction from which a hand comes, and how it is turned about it."""

    SIDE = "side"
    """Horizontally, fingers left and right."""
    TOP = "top"
    """From straight above."""
    PINCH = "pinch"
    """Horizontally, fingers above and below."""
    SLANT = "slant"
    """From the side and from above, halfway between both, fingers left and right."""

    @property
    def ahead(self) -> tuple[float, float]:
        """The direction of approach: how far ahead and how far up it leads, a unit vector."""
        return AHEAD[self.value]


SLOPE = math.sqrt(0.5)
AHEAD = {"side": (1.0, 0.0), "pinch": (1.0, 0.0), "top": (0.0, -1.0), "slant": (SLOPE, -SLOPE)}

USUAL = (Family.SIDE, Family.TOP, Family.PINCH)
"""What is derived of every robot; others where a scene asks for them."""


@dataclass(frozen=True, eq=False)
class Approach:
    """What a hand that comes in by a family sweeps, from 10 cm before the grasp to the grasp.

    Boxes are rows [x_lo, x_hi, y_lo, y_hi, z_lo, z_hi] in the approach frame: origin at the
    grasp centre, z up, x the heading. Coming horizontally, that is the direction of approach,
    and coming aslant that as it is seen from above;
    from above, the direction from the shoulder's axis to the grasp, so that the forearm hangs
    back towards -x.

    - `hand` (h, 6): what is fixed to the wrist, palm and all. From above it is given for
      fingers that close along y; it turns with them.
    - `arm` (a, 6): where wrist and forearm are in nearly all postures that reach there.
    - `fingers` (f, 6): those on one side. Along the direction in which they close (y; z for
      PINCH), they are measured outwards from the face of the pad: with pads `w` apart, add
      w / 2 for one side, and mirror that for the other.
    """

    family: Family
    hand: Floats
    arm: Floats
    fingers: Floats

    @property
    def hand_and_arm(self) -> Floats:
        """All boxes whose place does not depend on the opening (h + a, 6)."""
        return np.vstack([self.hand, self.arm])


@dataclass(frozen=True, eq=False)
class Workspace:
    """InArmWorkspace (paper, Executability) of one family: how far the wrist may be from the
    shoulder's axis, `inner` to `outer` (k,), for a grasp centre at heights (k,) above the
    floor; 0 to 0 where none is. The wrist is `wrist_offset` behind the grasp centre, seen from
    above."""

    heights: Floats
    inner: Floats
    outer: Floats
    wrist_offset: float

    def at(self, height: float) -> tuple[float, float, float]:
        """Inner and outer radius and wrist offset for a grasp centre at a height; the interval
        is empty (inner = outer = 0) where the arm cannot get."""
        heights, inner, outer = self._reached
        step = float(self.heights[1] - self.heights[0]) if len(self.heights) > 1 else 0.0
        above = bisect_left(heights, height)
        nearest = min((abs(h - height) for h in heights[max(0, above - 1) : above + 1]), default=1)
        if not heights or nearest > step:
            return 0.0, 0.0, self.wrist_offset
        below, above = max(0, above - 1), min(above, len(heights) - 1)
        span = heights[above] - heights[below]
        share = (height - heights[below]) / span if span > 0 else 0.0
        share = min(1.0, max(0.0, share))
        return (
            inner[below] + share * (inner[above] - inner[below]),
            outer[below] + share * (outer[above] - outer[below]),
            self.wrist_offset,
        )

    @cached_property
    def _reached(self) -> tuple[list[float], list[float], list[float]]:
        """The heights that are reached, with the radii there: plain numbers, for one height is
        asked for at a time."""
        found = self.outer > self.inner
        heights, inner, outer = self.heights[found], self.inner[found], self.outer[found]
        return heights.tolist(), inner.tolist(), outer.tolist()

    @property
    def reaches(self) -> tuple[float, float] | None:
        """Lowest and highest height at which something can be grasped."""
        found = self.heights[self.outer > self.inner]
        return (float(found[0]), float(found[-1])) if len(found) else None


@dataclass(frozen=True, eq=False)
class Derived:
    """What kinematics says of a robot: the shoulder's axis (x, y) in the base frame, and for
    each family its workspace and what it sweeps."""

    centre: tuple[float, float]
    workspaces: dict[Family, Workspace]
    approaches: dict[Family, Approach]
