"""Rounded shapes as triangles: what looks are made of. Metres; faces counter-clockwise."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from runtime.world.poses import Floats

Ints = NDArray[np.int64]
Triangles = tuple[Floats, Ints]
"""Vertices (n, 3) and faces (m, 3)."""

AROUND = 28
"""Corners of a circle."""

STEPS = 6
"""Rings of a rounded end, and stretches between two points of a tube."""


def rounded_box(size: Sequence[float], radius: float, steps: int = 2) -> Triangles:
    """A box about the origin whose edges are rounded, as far as its sides allow."""
    half = np.asarray(size, dtype=float) / 2
    radius = min(radius, 0.999 * float(half.min()))
    angles = np.tan(np.linspace(0, math.pi / 4, steps + 1))
    slopes = np.concatenate([-angles[::-1], angles])
    sides = np.concatenate([-np.ones(steps + 1), np.ones(steps + 1)])
    vertices: list[Floats] = []
    faces: list[Ints] = []
    count = len(slopes)
    corner = np.arange(count * count).reshape(count, count)
    a, b, c, d = (
        corner[i : count - 1 + i, j : count - 1 + j].ravel()
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    grid = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            out = np.empty((count, count, 3))
            out[..., axis], out[..., u], out[..., v] = sign, slopes[:, None], slopes[None, :]
            out /= np.linalg.norm(out, axis=-1, keepdims=True)
            middle = np.empty((count, count, 3))
            middle[..., axis] = sign * (half[axis] - radius)
            middle[..., u] = (sides * (half[u] - radius))[:, None]
            middle[..., v] = (sides * (half[v] - radius))[None, :]
            faces.append((grid if sign > 0 else grid[:, ::-1]) + sum(map(len, vertices)))
            vertices.append((middle + radius * out).reshape(-1, 3))
    return welded(np.concatenate(vertices), np.concatenate(faces))


def turned(profile: Sequence[Sequence[float]], around: int = AROUND) -> Triangles:
    """What a profile of (radius, height), from below, sweeps about z; its ends are closed."""
    rings = [np.full((around, 3), z, dtype=float) for _, z in profile]
    turn = np.linspace(0, 2 * math.pi, around, endpoint=False)
    for ring, (radius, _) in zip(rings, profile, strict=True):
        ring[:, 0], ring[:, 1] = radius * np.cos(turn), radius * np.sin(turn)
    return skin(rings)


def cylinder(radius: float, height: float, bevel: float, around: int = AROUND) -> Triangles:
    """A cylinder about the origin, along z, whose rims are rounded."""
    bevel = min(bevel, 0.999 * radius, 0.499 * height)
    bend = np.linspace(0, math.pi / 2, 4)
    low = [
        (radius - bevel * (1 - math.sin(t)), -height / 2 + bevel * (1 - math.cos(t))) for t in bend
    ]
    return turned([*low, *((r, -z) for r, z in reversed(low))], around)


def loft(sections: Sequence[Sequence[float]], power: float, bevel: float) -> Triangles:
    """A body along z through rounded rectangles: each section is z, half width along x, along y,
    and perhaps where its middle is, x, y. `power` 2 makes ellipses, larger ones squarer; the ends
    are rounded by `bevel`."""
    rows = np.array([[*row, 0.0, 0.0][:5] for row in sections], dtype=float)
    bend = np.linspace(0, math.pi / 2, 5)
    for end, step in ((0, -1), (-1, 1)):
        row = rows[end]
        size = min(bevel, 0.9 * float(row[1:3].min()))
        more = np.repeat(row[None], len(bend) - 1, axis=0)
        turn = bend[1:]
        more[:, 0] += step * size * np.sin(turn)
        more[:, 1:3] -= size * (1 - np.cos(turn))[:, None]
        if end == 0:
            rows[0, 0] = row[0]
            rows = np.concatenate([more[::-1], rows])
        else:
            rows = np.concatenate([rows, more])
    turn = np.linspace(0, 2 * math.pi, AROUND, endpoint=False)
    c, s = np.cos(turn), np.sin(turn)
    around = np.column_stack(
        [np.sign(c) * np.abs(c) ** (2 / power), np.sign(s) * np.abs(s) ** (2 / power)]
    )
    rings = []
    for z, a, b, x, y in rows.tolist():
        rings.append(np.column_stack([around * [a, b] + [x, y], np.full(AROUND, z)]))
    return skin(rings)


def tube(points: Sequence[Sequence[float]]) -> Triangles:
    """A smooth tube through points x, y, z with a radius each; its ends are domes."""
    rows = np.array(points, dtype=float)
    if len(rows) > 2:
        rows = _through(rows)
    ways = np.gradient(rows[:, :3], axis=0)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    side = np.cross(ways[0], np.eye(3)[int(np.abs(ways[0]).argmin())])
    turn = np.linspace(0, 2 * math.pi, AROUND, endpoint=False)
    rings = []
    bend = np.linspace(0, math.pi / 2, STEPS)[1:]

    def ring(middle: Floats, way: Floats, radius: float) -> None:
        across = side - way * (side @ way)
        across /= np.linalg.norm(across)
        other = np.cross(way, across)
        rings.append(
            middle + radius * (np.outer(np.cos(turn), across) + np.outer(np.sin(turn), other))
        )

    first, last = rows[0], rows[-1]
    for t in bend[::-1]:
        radius = first[3] * math.cos(t)
        ring(first[:3] - ways[0] * first[3] * math.sin(t), ways[0], radius)
    for row, way in zip(rows, ways, strict=True):
        side = side - way * (side @ way)  # carried along: no twist
        side /= np.linalg.norm(side)
        ring(row[:3], way, row[3])
    for t in bend:
        radius = last[3] * math.cos(t)
        ring(last[:3] + ways[-1] * last[3] * math.sin(t), ways[-1], radius)
    return skin(rings)


def _through(rows: Floats) -> Floats:
    """More points on the Catmull-Rom curve through some."""
    padded = np.concatenate([2 * rows[:1] - rows[1:2], rows, 2 * rows[-1:] - rows[-2:-1]])
    share = np.linspace(0, 1, STEPS, endpoint=False)[:, None]
    found = []
    for p, q, r, s in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        linear, square, cube = r - p, 2 * p - 5 * q + 4 * r - s, 3 * q - p - 3 * r + s
        found.append(q + 0.5 * (linear * share + square * share**2 + cube * share**3))
    return np.concatenate([*found, rows[-1:]])


def skin(rings: Sequence[Floats]) -> Triangles:
    """The surface over rings (k, 3) of equally many points, closed at both ends."""
    count = len(rings[0])
    middles = [rings[0].mean(axis=0), rings[-1].mean(axis=0)]
    vertices = np.concatenate([*rings, np.array(middles)])
    here = np.arange(count)
    there = (here + 1) % count
    faces = []
    for k in range(len(rings) - 1):
        low, high = k * count, (k + 1) * count
        faces += [
            np.column_stack([low + here, low + there, high + there]),
            np.column_stack([low + here, high + there, high + here]),
        ]
    bottom, top, last = len(vertices) - 2, len(vertices) - 1, (len(rings) - 1) * count
    faces.append(np.column_stack([there, here, np.full(count, bottom)]))
    faces.append(np.column_stack([last + here, last + there, np.full(count, top)]))
    return welded(vertices, np.concatenate(faces))


def welded(vertices: Floats, faces: Ints) -> Triangles:
    """The same with equal corners (to a micrometre) made one, without faces of no area."""
    keys = np.round(vertices * 1e6).astype(np.int64)
    _, first, back = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    found = back.reshape(-1)[faces]
    a, b, c = found.T
    return vertices[first], found[(a != b) & (b != c) & (c != a)]


def strip(corners: Floats, width: float) -> Triangles:
    """A flat frame: the line along corners (k, 2) of a convex outline, counter-clockwise, of a
    width inwards, in the plane z = 0, seen from above."""
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    a = (corners - before) / np.linalg.norm(corners - before, axis=1, keepdims=True)
    b = (after - corners) / np.linalg.norm(after - corners, axis=1, keepdims=True)
    inward = np.column_stack([-a[:, 1], a[:, 0]]) + np.column_stack([-b[:, 1], b[:, 0]])
    cosine = 1 + (a * b).sum(axis=1, keepdims=True)
    inner = corners + width * inward / np.maximum(cosine, 0.2)
    count = len(corners)
    vertices = np.zeros((2 * count, 3))
    vertices[:count, :2], vertices[count:, :2] = corners, inner
    here = np.arange(count)
    there = (here + 1) % count
    faces = np.concatenate(
        [
            np.column_stack([here, there, count + there]),
            np.column_stack([here, count + there, count + here]),
        ]
    )
    return vertices, faces
