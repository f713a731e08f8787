"""Points on the outside of solids: enough to measure how far they reach."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import product

import numpy as np

from runtime.robot.shapes import Shape
from runtime.world.poses import Pose, apply
from runtime.world.solids import Box, Capsule, Cylinder, Floats, Hull, Solid, Sphere

AROUND = 24
"""Points on a circle. They are put outside, so that their hull holds the solid."""


def outline(solid: Solid) -> Floats:
    """Points (n, 3) whose hull holds a solid: its corners, or for round ones a little more."""
    points: Floats
    match solid:
        case Box():
            points = np.array(list(product((-0.5, 0.5), repeat=3))) * solid.size
        case Hull():
            points = solid.points
        case Cylinder():
            x, y = _circle().T * solid.radius
            top = np.column_stack([x, y, np.full(AROUND, solid.height / 2)])
            points = np.vstack([top, top * (1, 1, -1)])
        case Capsule():
            end = np.array([0.0, 0.0, solid.height / 2])
            ball = _ball() * solid.radius
            points = np.vstack([ball + end, ball - end])
        case Sphere():
            points = _ball() * solid.radius
    return points


def points_of(shape: Shape, link: Pose) -> Floats:
    """The outline of a shape of a link, in the frame in which the link's pose is given."""
    return apply(link, apply(shape.pose, outline(shape.solid)))


def slices(cloud: Floats, thick: float) -> list[Floats]:
    """The hull of points (n, 3) cut across x into pieces that are at most so thick: points whose
    hulls together are that hull."""
    low, high = float(cloud[:, 0].min()), float(cloud[:, 0].max())
    edges = np.linspace(low, high, max(2, math.ceil((high - low) / thick) + 1))
    first, second = np.triu_indices(len(cloud), 1)
    a, b = cloud[first], cloud[second]
    cuts = {}
    for edge in edges[1:-1].tolist():
        crosses = (a[:, 0] - edge) * (b[:, 0] - edge) < 0
        p, q = a[crosses], b[crosses]
        share = (edge - p[:, :1]) / (q[:, :1] - p[:, :1])
        cuts[edge] = p + share * (q - p)
    found = []
    for near, far in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        inside = cloud[(cloud[:, 0] >= near) & (cloud[:, 0] <= far)]
        found.append(np.vstack([inside, *(cuts[edge] for edge in (near, far) if edge in cuts)]))
    return found


@lru_cache(maxsize=1)
def _circle() -> Floats:
    angles = np.arange(AROUND) * 2 * np.pi / AROUND
    circle: Floats = np.column_stack([np.cos(angles), np.sin(angles)]) / np.cos(np.pi / AROUND)
    return circle


@lru_cache(maxsize=1)
def _ball() -> Floats:
    """Points around the unit ball: the corners of a polyhedron that touches it from outside."""
    rings = [_circle() * np.cos(angle) for angle in np.linspace(-1.2, 1.2, 7)]
    heights = [np.full(AROUND, np.sin(angle)) for angle in np.linspace(-1.2, 1.2, 7)]
    points = np.column_stack([np.vstack(rings), np.concatenate(heights)])
    poles: Floats = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    ball: Floats = np.vstack([points, poles]) * 1.06
    return ball
