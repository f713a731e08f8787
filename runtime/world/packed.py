"""Bodies packed for the collision kernels: a row and a shape for each of their solids."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runtime.kernels.convex import BOX, CYLINDER, EXACT, HULL, Ints, Obstacles, Shapes
from runtime.world.body import Body
from runtime.world.poses import Pose, compose
from runtime.world.solids import Box, Capsule, Cylinder, Floats, Hull, Solid, Sphere

UPRIGHT = 1e-12
"""A box stands on one of its sides where the cosine of its tilt is that near to 1."""


def pack_shapes(solids: Sequence[Solid]) -> Shapes:
    """A table of solids as the kernels take it."""
    rows = np.zeros((len(solids), 7))
    vertices = [np.empty((0, 3))]
    used = 0
    for row, solid in zip(rows, solids, strict=True):
        match solid:
            case Box():
                row[:4] = BOX, *solid.half
            case Sphere():
                row[:5] = BOX, 0.0, 0.0, 0.0, solid.radius
            case Capsule():
                row[:5] = BOX, 0.0, 0.0, solid.height / 2, solid.radius
            case Cylinder():
                row[:4] = CYLINDER, solid.radius, 0.0, solid.height / 2
            case Hull():
                row[[0, 5, 6]] = HULL, used, len(solid.corners)
                vertices.append(solid.points)
                used += len(solid.corners)
    return Shapes(rows, np.vstack(vertices))


def reach_along(solid: Solid, direction: Floats) -> Floats:
    """How far a solid reaches from its origin along directions (k, 3) of its own frame."""
    match solid:
        case Box():
            reach = np.abs(direction) @ np.array(solid.half)
        case Sphere():
            reach = solid.radius * np.linalg.norm(direction, axis=1)
        case Capsule():
            rounding = solid.radius * np.linalg.norm(direction, axis=1)
            reach = rounding + np.abs(direction[:, 2]) * solid.height / 2
        case Cylinder():
            flat = np.hypot(direction[:, 0], direction[:, 1])
            reach = solid.radius * flat + np.abs(direction[:, 2]) * solid.height / 2
        case Hull():
            reach = (direction @ solid.points.T).max(axis=1)
    found: Floats = reach
    return found


def upright_row(solid: Solid, pose: Pose) -> Floats:
    """The smallest upright box around a solid at a pose, packed for the kernels (8,), among
    those along one of the solid's own axes."""
    best, smallest = np.empty(8), math.inf
    for axis in range(3):
        x, y = pose[0, axis], pose[1, axis]
        length = math.hypot(x, y)
        if length < 1e-9:
            continue
        c, s = x / length, y / length
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        along = turn @ pose[:, :3]
        high, low = reach_along(solid, along), reach_along(solid, -along)
        half = (high + low) / 2
        if half[0] * half[1] < smallest * (1 - 1e-9):
            smallest = half[0] * half[1]
            centre = pose[:, 3] + turn.T @ ((high - low) / 2)
            best = np.array([*centre, *half, c, s])
    return best


@dataclass(frozen=True, eq=False)
class PackedBodies:
    """Bodies whose solids are in one table of shapes; `index[i]` are the indices of the solids
    of body i."""

    bodies: tuple[Body, ...]
    shapes: Shapes
    index: tuple[Ints, ...]

    def at(self, body: int, pose: Pose) -> Obstacles:
        """The solids of a body at a pose (3, 4), in the frame that the pose is given in. Boxes
        that stand on a side are exactly their rows."""
        parts = self.bodies[body].parts
        poses = np.array([compose(pose, part.pose) for part in parts])
        rows = np.empty((len(parts), 8))
        shape = self.index[body].copy()
        for i, part in enumerate(parts):
            rows[i] = upright_row(part.solid, poses[i])
            if isinstance(part.solid, Box) and np.abs(poses[i, 2, :3]).max() > 1 - UPRIGHT:
                shape[i] = EXACT
        return Obstacles(rows, shape, poses, self.shapes)


def pack_bodies(bodies: Sequence[Body]) -> PackedBodies:
    """Pack bodies; equal solids share an entry of the table."""
    known: dict[Solid, int] = {}
    index = tuple(
        np.array([known.setdefault(part.solid, len(known)) for part in body.parts], dtype=np.int64)
        for body in bodies
    )
    return PackedBodies(tuple(bodies), pack_shapes(list(known)), index)
