"""Solids as polyhedra of few corners that enclose them: for outlines and cross-sections."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from runtime.world.solids import Box, Capsule, Cylinder, Floats, Hull, Solid, Sphere

SIDES = 32
"""Sides of the prism around something round: its radius is 0.5 % larger."""

RINGS = 8
"""Steps from pole to pole between rings of corners around a sphere or the ends of a capsule."""

Edges = list[tuple[int, int]]


@lru_cache(maxsize=256)
def vertices_and_edges(solid: Solid) -> tuple[Floats, Edges]:
    """Corners (n, 3) and edges of a convex polyhedron around a solid, in the solid's frame."""
    match solid:
        case Box():
            corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
            edges = [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]
            return corners * np.array(solid.half), edges
        case Cylinder():
            radius = solid.radius / math.cos(math.pi / SIDES)
            return _stack([(-solid.height / 2, radius), (solid.height / 2, radius)])
        case Sphere():
            return _stack(_rings(solid.radius, 0.0))
        case Capsule():
            return _stack(_rings(solid.radius, solid.height / 2))
        case Hull():
            return solid.points, _hull_edges(solid.points)


def _rings(radius: float, half: float) -> list[tuple[float, float]]:
    """Heights and radii of rings around a capsule, half of whose segment is `half`."""
    wider = radius / (math.cos(math.pi / SIDES) * math.cos(math.pi / (2 * RINGS)))
    rings = []
    # The widest ring is at both ends of the segment.
    for shift, first in ((-half, -math.pi / 2), (half, 0.0)):
        for i in range(RINGS // 2 + 1):
            bearing = first + i * math.pi / RINGS
            rings.append((wider * math.sin(bearing) + shift, max(wider * math.cos(bearing), 1e-9)))
    return rings if half else rings[: RINGS // 2] + rings[RINGS // 2 + 1 :]


def _stack(rings: list[tuple[float, float]]) -> tuple[Floats, Edges]:
    """Rings (height, radius) of corners above each other, joined up."""
    bearings = 2 * math.pi * np.arange(SIDES) / SIDES
    corners = np.vstack(
        [
            np.column_stack([r * np.cos(bearings), r * np.sin(bearings), np.full(SIDES, z)])
            for z, r in rings
        ]
    )
    edges = [
        (SIDES * i + k, SIDES * i + (k + 1) % SIDES)
        for i in range(len(rings))
        for k in range(SIDES)
    ]
    edges += [
        (SIDES * i + k, SIDES * (i + 1) + k) for i in range(len(rings) - 1) for k in range(SIDES)
    ]
    return corners, edges


def _hull_edges(points: Floats) -> Edges:
    from scipy.spatial import ConvexHull

    found = set()
    for a, b, c in ConvexHull(points).simplices.tolist():
        found |= {(min(p, q), max(p, q)) for p, q in ((a, b), (b, c), (c, a))}
    return sorted(found)
