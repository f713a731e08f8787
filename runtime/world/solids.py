"""Convex solids: box, cylinder, sphere, capsule, hull. Each is centred on its own frame.

A solid is a frozen value; what it means as a mesh, as vertices or to a collision library is
said by functions elsewhere. Lengths are metres; cylinders and capsules stand along z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Box:
    """A box: full size along x, y and z."""

    size: tuple[float, float, float]

    @property
    def half(self) -> tuple[float, float, float]:
        """Half extents of the smallest box around the solid, along its own axes."""
        return self.size[0] / 2, self.size[1] / 2, self.size[2] / 2

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return math.prod(self.size)


@dataclass(frozen=True)
class Cylinder:
    """A cylinder around z: radius, and height along z."""

    radius: float
    height: float

    @property
    def half(self) -> tuple[float, float, float]:
        """Half extents of the smallest box around the solid, along its own axes."""
        return self.radius, self.radius, self.height / 2

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return math.pi * self.radius**2 * self.height


@dataclass(frozen=True)
class Sphere:
    """A sphere."""

    radius: float

    @property
    def half(self) -> tuple[float, float, float]:
        """Half extents of the smallest box around the solid, along its own axes."""
        return self.radius, self.radius, self.radius

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return 4 / 3 * math.pi * self.radius**3


@dataclass(frozen=True)
class Capsule:
    """All that is within `radius` of a segment of length `height` along z."""

    radius: float
    height: float

    @property
    def half(self) -> tuple[float, float, float]:
        """Half extents of the smallest box around the solid, along its own axes."""
        return self.radius, self.radius, self.height / 2 + self.radius

    @property
    def volume(self) -> float:
        """Cubic metres."""
        return math.pi * self.radius**2 * self.height + 4 / 3 * math.pi * self.radius**3


@dataclass(frozen=True)
class Hull:
    """The convex hull of some points; only corners are kept, and the middle of the box around
    them is the origin of the solid's frame."""

    corners: tuple[tuple[float, float, float], ...]

    @cached_property
    def points(self) -> Floats:
        """The corners (n, 3)."""
        return np.array(self.corners)

    @cached_property
    def half(self) -> tuple[float, float, float]:
        """Half extents of the smallest box around the solid, along its own axes."""
        x, y, z = np.abs(self.points).max(axis=0).tolist()
        return x, y, z

    @cached_property
    def volume(self) -> float:
        """Cubic metres."""
        from scipy.spatial import ConvexHull

        return float(ConvexHull(self.points).volume)


Solid = Box | Cylinder | Sphere | Capsule | Hull


def smaller(solid: Solid, by: float) -> Solid:
    """A solid that is `by` metres smaller on every side, or nearly so for a hull; what is
    thinner than that keeps a hundredth of it."""
    least = 0.01 * by

    def less(value: float, times: float = 1.0) -> float:
        return max(value - times * by, least)

    match solid:
        case Box((x, y, z)):
            return Box((less(x, 2), less(y, 2), less(z, 2)))
        case Cylinder(radius, height):
            return Cylinder(less(radius), less(height, 2))
        case Sphere(radius):
            return Sphere(less(radius))
        case Capsule(radius, height):
            return Capsule(less(radius), height)
        case Hull():
            share = less(min(solid.half)) / min(solid.half)
            return Hull(tuple((x * share, y * share, z * share) for x, y, z in solid.corners))
