"""What the shape of an object says about standing and being grasped (trimesh).

Grasps are from the side: the gripper comes in horizontally, with any rotation about the
object's vertical axis; stable object poses are upright, with any rotation about it (paper,
Figure 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sketchlang.errors import InputError

GRASP_HEIGHT = 0.12
"""Metres above the object's bottom, as published; lower for objects that are not as tall."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A graspable shape: size of its box, its outline at grasp height, and symmetry.

    `outline` (v, 2) are the vertices of the cross-section at the grasp height, in the
    object's frame. `symmetry` is how many turns about z map the shape to itself.
    """

    size: tuple[float, float, float]
    outline: NDArray[np.float64]
    grasp_height: float
    symmetry: int

    @property
    def inner_radius(self) -> float:
        """Radius of the largest upright cylinder inside, metres."""
        return min(self.size[0], self.size[1]) / 2

    @property
    def outer_radius(self) -> float:
        """Radius of the smallest upright cylinder around, metres."""
        return math.hypot(self.size[0], self.size[1]) / 2

    def width(self, angle: float) -> float:
        """How far the fingers are apart on the object for an approach heading `angle`."""
        return float(self.widths(np.array([angle]))[0])

    def widths(self, angles: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same for several headings (k,)."""
        across = self.outline @ np.array([-np.sin(angles), np.cos(angles)])
        found: NDArray[np.float64] = across.max(axis=0) - across.min(axis=0)
        return found


@lru_cache(maxsize=256)
def box_shape(size: tuple[float, float, float]) -> Shape:
    """The shape of a box.

    Raises:
        InputError: it does not stand upright.
    """
    import trimesh

    mesh = trimesh.creation.box(extents=size)
    transforms, _ = trimesh.poses.compute_stable_poses(mesh)
    if not any(abs(transform[2, 2]) > 1 - 1e-6 for transform in transforms):
        raise InputError(f"an object of size {size} does not stand upright")
    height = min(GRASP_HEIGHT, 0.6 * size[2])
    section = mesh.section(plane_origin=[0.0, 0.0, height - size[2] / 2], plane_normal=[0, 0, 1])
    outline = np.unique(np.round(np.asarray(section.vertices)[:, :2], 9), axis=0)
    symmetry = 4 if math.isclose(size[0], size[1]) else 2
    return Shape(size, outline, height, symmetry)
