"""Few convex hulls with few corners that enclose a mesh: conservative, and cheap to test.

A hull is cut out of an oriented box around the points, plane by plane: each plane touches the
points and takes off the corner that sticks out furthest. A hollow or branching mesh is first
cut into slabs, along its own axes, where that saves volume; of a closed surface, the hulls of
the pieces cover all that the mesh encloses.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from runtime.world.body import Mesh
from runtime.world.poses import Pose, apply, invert
from runtime.world.solids import Floats, Hull

MAX_CORNERS = 32
"""Corners of a hull, at most."""

CLOSE = 0.002
"""Metres by which a hull may stick out of the points before it is cut again."""

LOOK = 12
"""So many of the corners that stick out are looked at for the next cut."""

SLIVER = 1e-4
"""Metres that flat or thin point sets are thickened by, so that they have a volume."""

SAVING = 0.8
"""A cut has to bring the volume of the hulls below this share."""

PIECES = 4
CUTS = (0.2, 0.35, 0.5, 0.65, 0.8)
"""Where along the box around a piece it may be cut, as shares of the length."""


def enclosing_hull(points: Floats) -> tuple[Hull, Pose]:
    """A hull of at most `MAX_CORNERS` corners around points (n, 3), and its pose among them.

    The pose is that of the smallest box found around the points. Exact where the hull of the
    points itself has few corners; else every point is within, and no corner is further out
    than its plane allows.
    """
    pose = _box_pose(points)
    local = apply(invert(pose), points)
    corners = _corners_of(local)
    if len(corners) > MAX_CORNERS:
        corners = _cut(corners)
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = (low + high) / 2
    pose[:, 3] = pose[:, :3] @ middle + pose[:, 3]
    rounded = np.round(corners - middle, 6)
    return Hull(tuple((x, y, z) for x, y, z in rounded.tolist())), pose


def enclosing_hulls(mesh: Mesh) -> list[tuple[Hull, Pose]]:
    """Hulls that cover a mesh and what it encloses, each with its pose in the mesh's frame."""
    return [enclosing_hull(points) for points in _pieces(mesh)]


def _corners_of(points: Floats) -> Floats:
    """Those of some points that are corners of their hull; flat sets are thickened."""
    from scipy.spatial import ConvexHull

    thin = points.max(axis=0) - points.min(axis=0) < 2 * SLIVER
    if thin.any():
        step = np.where(thin, SLIVER, 0.0)
        points = np.vstack([points - step, points + step])
    try:
        hull = ConvexHull(points)
    except Exception:  # Qhull's precision errors: nearly flat across the axes
        shifts = np.array(list(product((-SLIVER, SLIVER), repeat=3)))
        points = (points[None] + shifts[:, None]).reshape(-1, 3)
        hull = ConvexHull(points)
    corners: Floats = points[hull.vertices]
    return corners


def _directions(points: Floats) -> Floats:
    """Unit vectors (k, 3) of planes to cut with: the axes first, then those of the hull's own
    faces, and some spread evenly over the sphere."""
    from scipy.spatial import ConvexHull

    count = 300
    k = np.arange(count) + 0.5
    z = 1 - 2 * k / count
    around = np.pi * (1 + 5**0.5) * k
    ring = np.sqrt(1 - z * z)
    spread = np.column_stack([ring * np.cos(around), ring * np.sin(around), z])
    faces = np.unique(np.round(ConvexHull(points).equations[:, :3], 3), axis=0)
    faces /= np.linalg.norm(faces, axis=1)[:, None]
    return np.vstack([np.eye(3), -np.eye(3), faces, spread])


def _cut(points: Floats) -> Floats:
    """Corners of a polytope around points: cut from a box, each time with that plane, among
    those that touch the points and face a corner far out, which leaves the least volume."""
    directions = _directions(points)
    support = (points @ directions.T).max(axis=0)
    inside = points.mean(axis=0)
    chosen = list(range(6))
    corners = np.array(list(product(*zip(-support[3:6], support[:3], strict=True))))
    while True:
        # Never more than how far a corner is from the points: exact for the best direction.
        excess = corners @ directions.T - support
        furthest = excess.max(axis=1)
        if furthest.max() < CLOSE:
            return corners
        looked_at = np.argsort(furthest)[-LOOK:]
        tried = []
        for direction in {int(excess[corner].argmax()) for corner in looked_at}:
            planes = np.column_stack([directions, -support])[[*chosen, direction]]
            found = _intersection(planes, inside)
            if len(found) <= MAX_CORNERS:
                tried.append((_volume(found), direction, found))
        if not tried:
            return corners
        _, direction, corners = min(tried, key=lambda entry: entry[:2])
        chosen.append(direction)


def _intersection(planes: Floats, inside: Floats) -> Floats:
    """Corners of the polytope within planes (p, 4): normal and offset."""
    from scipy.spatial import HalfspaceIntersection

    found = HalfspaceIntersection(planes, inside).intersections
    found = found[np.isfinite(found).all(axis=1)]
    _, first = np.unique(np.round(found, 7), axis=0, return_index=True)
    corners: Floats = found[first]
    return corners


def _box_pose(points: Floats) -> Pose:
    """Pose of a small oriented box around points: along the frame's own axes unless the
    principal axes of the points make it at least a tenth smaller."""
    pose = np.eye(3, 4)
    low, high = points.min(axis=0), points.max(axis=0)
    pose[:, 3] = (low + high) / 2
    corners = _corners_of(points)
    _, vectors = np.linalg.eigh(np.cov(corners.T))
    if np.linalg.det(vectors) < 0:
        vectors[:, 0] *= -1
    turned = corners @ vectors
    span = turned.max(axis=0) - turned.min(axis=0)
    if np.prod(span + SLIVER) < 0.9 * np.prod(high - low + SLIVER):
        pose[:, :3] = vectors
        pose[:, 3] = vectors @ ((turned.max(axis=0) + turned.min(axis=0)) / 2)
    return pose


# -- cutting into pieces ------------------------------------------------------------------


def _pieces(mesh: Mesh) -> list[Floats]:
    """Points of the pieces that a mesh is cut into, one set a hull."""
    pieces: list[Any] = [mesh.vertices[mesh.faces]]
    if not _is_closed(mesh):
        return [pieces[0].reshape(-1, 3)]
    while len(pieces) < PIECES:
        total = sum(_volume(piece) for piece in pieces)
        best = None
        for i, piece in enumerate(pieces):
            own = _volume(piece)
            for halves in _splits(piece):
                saved = own - sum(_volume(half) for half in halves)
                if best is None or saved > best[0]:
                    best = saved, i, halves
        if best is None or best[0] < (1 - SAVING) * total:
            break
        pieces[best[1] : best[1] + 1] = best[2]
    return [piece.reshape(-1, 3) for piece in pieces]


def _is_closed(mesh: Mesh) -> bool:
    """Whether every edge is shared by two triangles: only then do pieces cover the inside."""
    _, index = np.unique(np.round(mesh.vertices, 6), axis=0, return_inverse=True)
    faces = index.reshape(-1)[mesh.faces]
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, counts = np.unique(edges, axis=0, return_counts=True)
    return bool((counts % 2 == 0).all())


def _volume(triangles: Floats) -> float:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(triangles.reshape(-1, 3)).volume)
    except QhullError:
        return 0.0


def _splits(triangles: Floats) -> list[tuple[Floats, Floats]]:
    """Both sides of the triangles (t, 3, 3), cut across each axis at several places."""
    points = triangles.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    found = []
    for axis in range(3):
        if high[axis] - low[axis] < 0.04:
            continue
        for share in CUTS:
            level = low[axis] + share * (high[axis] - low[axis])
            below = _clip(triangles, axis, level, -1.0)
            above = _clip(triangles, axis, level, 1.0)
            if len(below) and len(above):
                found.append((below, above))
    return found


def _clip(triangles: Floats, axis: int, level: float, side: float) -> Floats:
    """What of some triangles (t, 3, 3) is on one side of a plane across an axis."""
    height = side * (triangles[:, :, axis] - level)
    inside = height >= 0
    kept = [triangles[inside.all(axis=1)]]
    for triangle, own, up in zip(
        *(array[inside.any(axis=1) & ~inside.all(axis=1)] for array in (triangles, inside, height)),
        strict=True,
    ):
        polygon = []
        for i in range(3):
            j = (i + 1) % 3
            if own[i]:
                polygon.append(triangle[i])
            if own[i] != own[j]:
                share = up[i] / (up[i] - up[j])
                polygon.append(triangle[i] + share * (triangle[j] - triangle[i]))
        fan = range(1, len(polygon) - 1)
        kept.append(np.array([[polygon[0], polygon[k], polygon[k + 1]] for k in fan]))
    return np.concatenate(kept) if kept else triangles[:0]
