"""Solids as triangles."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from runtime.show.forms import Ints, cylinder, rounded_box
from runtime.trace.write_world import hull_faces
from runtime.world.poses import Floats
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere

AROUND = 32
"""Corners of a circle."""

OVER = 8
"""Rings of half a ball."""


@lru_cache(maxsize=4096)
def triangles(solid: Solid) -> tuple[Floats, Ints]:
    """Vertices (n, 3) and faces (m, 3), counter-clockwise from outside."""
    match solid:
        case Box():
            points = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
            return _hull(points * np.array(solid.half))
        case Hull():
            return _hull(solid.points)
        case Cylinder():
            profile = [(solid.radius, -solid.height / 2), (solid.radius, solid.height / 2)]
        case Sphere():
            profile = _ball(solid.radius, 0.0)
        case Capsule():
            profile = _ball(solid.radius, solid.height)
    return _turned(profile, solid.half[2])


def _hull(points: Floats) -> tuple[Floats, Ints]:
    return points, np.array(hull_faces(points), dtype=np.int64)


def _ball(radius: float, height: float) -> list[tuple[float, float]]:
    """Radius and height of rings from pole to pole, the poles left out, of a ball that is cut
    at its equator and pulled apart by a height."""
    rings = []
    for i in range(1, 2 * OVER):
        angle = math.pi * (i / (2 * OVER) - 0.5)
        lift = math.copysign(height / 2, angle) if i != OVER else 0.0
        rings.append((radius * math.cos(angle), radius * math.sin(angle) + lift))
    if height:
        rings[OVER - 1 : OVER] = [(radius, -height / 2), (radius, height / 2)]
    return rings


def _turned(profile: list[tuple[float, float]], pole: float) -> tuple[Floats, Ints]:
    """What a profile (radius, height), from below, sweeps about z, closed by poles."""
    turn = np.linspace(0, 2 * math.pi, AROUND, endpoint=False)
    rings = [
        np.column_stack([r * np.cos(turn), r * np.sin(turn), np.full(AROUND, z)])
        for r, z in profile
    ]
    ends = np.array([[0, 0, -pole], [0, 0, pole]])
    vertices = np.vstack([*rings, ends])
    bottom, top = len(vertices) - 2, len(vertices) - 1
    faces = []
    for k in range(AROUND):
        n = (k + 1) % AROUND
        for ring in range(len(profile) - 1):
            a, b = ring * AROUND, (ring + 1) * AROUND
            faces += [(a + k, a + n, b + n), (a + k, b + n, b + k)]
        last = (len(profile) - 1) * AROUND
        faces += [(n, k, bottom), (last + k, last + n, top)]
    return vertices, np.array(faces, dtype=np.int64)


def of_solid(solid: Solid, radius: float) -> tuple[Floats, Ints]:
    """The same, edges of boxes and rims of cylinders rounded by a radius: to be looked at."""
    match solid:
        case Box() if radius > 0:
            return rounded_box(solid.size, radius)
        case Cylinder() if radius > 0:
            return cylinder(solid.radius, solid.height, radius)
    return triangles(solid)
