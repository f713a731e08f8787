"""Solids and bodies as triangles: for drawings, GLB files and physics.

Round solids become polyhedra whose corners are on their surface. No library is needed but for
hulls, whose faces SciPy finds.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from runtime.world.body import Body, Mesh
from runtime.world.poses import apply
from runtime.world.solids import Box, Capsule, Cylinder, Floats, Hull, Solid, Sphere

SIDES = 32
"""Corners of what is drawn for a circle."""

RINGS = 8
"""Rings of corners between the poles of a sphere, an even number."""


@lru_cache(maxsize=512)
def mesh_of(solid: Solid) -> Mesh:
    """The triangles of a solid in its own frame, counter-clockwise seen from outside."""
    match solid:
        case Box():
            return _box(solid)
        case Cylinder():
            half = solid.height / 2
            return _turned([(solid.radius, -half), (solid.radius, half)], -half, half)
        case Sphere():
            return _turned(_globe(solid.radius, 0.0), -solid.radius, solid.radius)
        case Capsule():
            half = solid.height / 2
            top = half + solid.radius
            return _turned(_globe(solid.radius, half), -top, top)
        case Hull():
            return _hull(solid)


def body_mesh(body: Body) -> Mesh:
    """What a body looks like, in its frame: its own mesh, or those of its solids together."""
    if body.mesh is not None:
        return body.mesh
    vertices, faces, used = [], [], 0
    for part in body.parts:
        mesh = mesh_of(part.solid)
        vertices.append(apply(part.pose, mesh.vertices))
        faces.append(mesh.faces + used)
        used += len(mesh.vertices)
    return Mesh(np.vstack(vertices), np.vstack(faces))


def volume_and_centre(mesh: Mesh) -> tuple[float, Floats]:
    """Volume in cubic metres and centre of mass (3,) of the inside of a closed mesh."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    total = float(volumes.sum())
    return total, ((a + b + c) / 4 * volumes[:, None]).sum(axis=0) / total


def _box(box: Box) -> Mesh:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    squares = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in squares for face in ((a, b, c), (a, c, d))]
    return Mesh(corners * np.array(box.half), np.array(faces))


def _globe(radius: float, half: float) -> list[tuple[float, float]]:
    """Radius and height of the rings of a capsule whose segment is two `half` long."""
    bearings = np.linspace(-np.pi / 2, np.pi / 2, RINGS + 1)[1:-1]
    lower = [(radius * np.cos(b), radius * np.sin(b) - half) for b in bearings if b < 1e-9]
    upper = [(radius * np.cos(b), radius * np.sin(b) + half) for b in bearings if b > -1e-9]
    return lower + (upper if half else upper[1:])


def _turned(rings: list[tuple[float, float]], bottom: float, top: float) -> Mesh:
    """Rings (radius, height) around z, from below, with a pole at each end."""
    angles = np.arange(SIDES) * (2 * np.pi / SIDES)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(SIDES)])
    corners = [circle * radius + [0.0, 0.0, height] for radius, height in rings]
    vertices = np.vstack([*corners, [[0.0, 0.0, bottom], [0.0, 0.0, top]]])
    low, high = len(vertices) - 2, len(vertices) - 1
    last = SIDES * (len(rings) - 1)
    faces = []
    for i in range(SIDES):
        j = (i + 1) % SIDES
        faces += [(low, j, i), (high, last + i, last + j)]
        for ring in range(0, last, SIDES):
            a, b, c, d = ring + i, ring + j, ring + SIDES + j, ring + SIDES + i
            faces += [(a, b, c), (a, c, d)]
    return Mesh(vertices, np.array(faces))


def _hull(hull: Hull) -> Mesh:
    from scipy.spatial import ConvexHull

    found = ConvexHull(hull.points)
    faces = found.simplices.copy()
    a, b, c = (hull.points[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), found.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Mesh(hull.points, faces)
