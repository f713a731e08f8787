"""Bodies: solids that move together."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from runtime.world.poses import Pose, identity
from runtime.world.solids import Floats, Solid


@dataclass(frozen=True, eq=False)
class Part:
    """One solid of a body and its pose (3, 4) in the body's frame."""

    solid: Solid
    pose: Pose = field(default_factory=identity)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles for the eye: vertices (n, 3) and faces (m, 3) in the body's frame."""

    vertices: Floats
    faces: Any


@dataclass(frozen=True, eq=False)
class Body:
    """Solids that move together. The origin of a body's frame is the middle of its bottom in
    the pose that its file describes; z is up there.

    `mass` in kg and `centre` (3,), the centre of mass in the body's frame; `mesh` is what it
    looks like where that is more than its parts.
    """

    parts: tuple[Part, ...]
    mass: float
    centre: tuple[float, float, float]
    mesh: Mesh | None = None

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner (3,) of the box around the body, in its frame; cylinders
        and the like count as the boxes around them."""
        low, high = [], []
        for part in self.parts:
            reach = np.abs(part.pose[:, :3]) @ np.array(part.solid.half)
            low.append(part.pose[:, 3] - reach)
            high.append(part.pose[:, 3] + reach)
        return np.min(low, axis=0), np.max(high, axis=0)
