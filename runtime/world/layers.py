"""A mesh that is a stack of prisms as convex pieces, exactly.

All faces of such a mesh are level or upright: plates with holes, cups, steps, brackets. Between
two neighbouring heights of its corners it has one cross-section. That is cut into trapezoids
(Preparata & Shamos 1985, section 2.2.2.3), which are joined again as long as they stay convex.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from runtime.world.body import Mesh
from runtime.world.poses import Floats

SQUARE = 1e-4
"""By how much the z of a face's normal may differ from 0 or 1."""

SAME = 1e-6
"""Metres below which two corners are one."""

THIN = 1e-9
"""Square metres below which a piece of a cross-section is nothing."""

ROUNDED = 0.01
"""Corners of a hole are left out where that fills it up by this part of the mesh's size at most."""

Loop = Floats
"""Corners (n, 2) of a closed line."""


def layers_of(mesh: Mesh) -> list[Floats] | None:
    """Corners (k, 3) of convex pieces that together are a mesh; None where it is no stack of
    prisms, or its sides are not closed.

    Holes are rounded off: they lose corners where they get narrower by 1 % of the mesh at most.
    """
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    upright = _upright(vertices, faces)
    if upright is None:
        return None
    heights = _distinct(vertices[:, 2])
    tolerance = ROUNDED * float(np.ptp(vertices, axis=0).max())
    pieces: list[Floats] = []
    for low, high in pairwise(heights):
        loops = _loops(_cut(vertices[faces[upright]], (low + high) / 2))
        if loops is None:
            return None
        corners = np.vstack(loops) if loops else np.empty((0, 2))
        rounded = [_rounded(x, tolerance, corners) if _is_hole(x, loops) else x for x in loops]
        for outline in _joined(_trapezoids(rounded)) if rounded else ():
            ends = [np.column_stack([outline, np.full(len(outline), z)]) for z in (low, high)]
            pieces.append(np.vstack(ends))
    return pieces or None


def _upright(vertices: Floats, faces: Floats) -> Floats | None:
    """Which faces (m,) are upright; None where one leans."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    rise = np.abs(normals[:, 2]) / np.maximum(lengths, 1e-300)
    some = lengths > 1e-14
    if np.any(some & (rise > SQUARE) & (rise < 1 - SQUARE)):
        return None
    found: Floats = some & (rise <= SQUARE)
    return found


def _distinct(values: Floats) -> list[float]:
    ordered = np.sort(values)
    kept: list[float] = ordered[np.concatenate([[True], np.diff(ordered) > SAME])].tolist()
    return kept


def _cut(triangles: Floats, z: float) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Where upright triangles (m, 3, 3) pass through a height: lines in the plane."""
    found = []
    for corners in triangles:
        points = []
        for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if (p[2] - z) * (q[2] - z) < 0:
                x, y = (p + (z - p[2]) / (q[2] - p[2]) * (q - p))[:2].tolist()
                points.append((round(x / SAME) * SAME, round(y / SAME) * SAME))
        if len(points) == 2 and points[0] != points[1]:
            found.append((points[0], points[1]))
    return found


def _loops(lines: list[tuple[tuple[float, float], tuple[float, float]]]) -> list[Loop] | None:
    """Closed lines, without corners at which they go straight on; None where one is open."""
    ends: dict[tuple[float, float], list[int]] = {}
    for number, line in enumerate(lines):
        for point in line:
            ends.setdefault(point, []).append(number)
    if any(len(numbers) != 2 for numbers in ends.values()):
        return None
    found, used = [], [False] * len(lines)
    for first, (start, at) in enumerate(lines):
        if used[first]:
            continue
        loop, number = [start], first
        while at != start:
            used[number] = True
            loop.append(at)
            number = next(k for k in ends[at] if k != number)
            a, b = lines[number]
            at = b if a == at else a
        used[number] = True
        found.append(_without_straight(np.array(loop)))
    return [loop for loop in found if len(loop) > 2]


def _without_straight(loop: Loop) -> Loop:
    """A closed line without corners that are no corners, one after the other: of two that are all
    but one point, one is needed."""
    kept, i = loop.tolist(), 0
    while i < len(kept) and len(kept) > 2:
        if _goes_on(kept[i - 1], kept[i], kept[(i + 1) % len(kept)]):
            del kept[i]
            i = max(0, i - 1)
        else:
            i += 1
    return np.array(kept)


def _goes_on(a: list[float], p: list[float], b: list[float]) -> bool:
    """Whether a point is on the straight line between two others, or is one of them."""
    x, y, px, py = b[0] - a[0], b[1] - a[1], p[0] - a[0], p[1] - a[1]
    along = math.hypot(x, y)
    if along < SAME or math.hypot(px, py) < SAME:
        return math.hypot(px, py) < SAME
    return abs(x * py - y * px) < SAME * along


def _is_hole(loop: Loop, loops: list[Loop]) -> bool:
    """Whether a closed line is within an odd number of the others."""
    others = [other for other in loops if other is not loop]
    return sum(_is_inside(loop[0], other) for other in others) % 2 == 1


def _is_inside(point: Floats, loop: Loop) -> bool:
    after = np.roll(loop, -1, axis=0)
    crosses = (loop[:, 1] > point[1]) != (after[:, 1] > point[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        x = loop[:, 0] + (point[1] - loop[:, 1]) / (after - loop)[:, 1] * (after - loop)[:, 0]
    return bool((crosses & (x > point[0])).sum() % 2)


def _rounded(loop: Loop, tolerance: float, corners: Floats) -> Loop:
    """A hole without corners that stick out of it by little, those that stick out least first; what
    is filled up holds none of the corners (n, 2) of anything."""
    area = _area(loop)
    kept = list(loop if area > 0 else loop[::-1])
    lost = [0.0] * len(kept)  # how much is filled up already, beside each side
    while len(kept) > 4:
        best, at = tolerance, -1
        for i, point in enumerate(kept):
            a, b = kept[i - 1], kept[(i + 1) % len(kept)]
            side = b - a
            out = float(side[1] * (point - a)[0] - side[0] * (point - a)[1]) / np.hypot(*side)
            filled = out + max(lost[i - 1], lost[i])
            if out > 0.0 and filled < best and not _are_between(corners, a, point, b).any():
                best, at = filled, i
        if at < 0:
            break
        lost[at - 1] = best
        del kept[at], lost[at]
    return np.array(kept)


def _are_between(points: Floats, a: Floats, b: Floats, c: Floats) -> NDArray[np.bool_]:
    """Which points (n, 2) are inside of a triangle whose corners run counter-clockwise."""
    inside = np.ones(len(points), dtype=np.bool_)
    for start, end in ((a, b), (b, c), (c, a)):
        x, y = end - start
        off = points - start
        inside &= x * off[:, 1] - y * off[:, 0] > SAME * math.hypot(x, y)
    return inside


def _area(loop: Loop) -> float:
    """Square metres, negative where a closed line runs clockwise."""
    x, y = (loop - loop[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def _trapezoids(loops: list[Loop]) -> list[Loop]:
    """The inside of closed lines (what is within an odd number of them), cut at every corner."""
    sides = np.vstack([np.stack([x, np.roll(x, -1, axis=0)], axis=1) for x in loops])  # (n, 2, 2)
    swapped = sides[:, 0, 0] > sides[:, 1, 0]
    sides[swapped] = sides[swapped, ::-1]
    found = []
    for left, right in pairwise(_distinct(sides[:, :, 0].ravel())):
        across = sides[(sides[:, 0, 0] <= left + SAME) & (sides[:, 1, 0] >= right - SAME)]
        across = across[across[:, 1, 0] - across[:, 0, 0] > SAME]
        slope = (across[:, 1, 1] - across[:, 0, 1]) / (across[:, 1, 0] - across[:, 0, 0])
        ends = [across[:, 0, 1] + slope * (x - across[:, 0, 0]) for x in (left, right)]
        order = np.argsort(ends[0] + ends[1])
        for below, above in zip(order[::2], order[1::2], strict=False):
            corners = [
                (left, ends[0][below]), (right, ends[1][below]),
                (right, ends[1][above]), (left, ends[0][above]),
            ]  # fmt: skip
            if _area(np.array(corners)) > THIN:
                found.append(np.array(corners))
    return found


def _joined(pieces: list[Loop]) -> list[Loop]:
    """Convex pieces, two at a time made one where that is convex, too."""
    pieces = list(pieces)
    i = 0
    while i < len(pieces):
        for j in range(i + 1, len(pieces)):
            both = _hull(np.vstack([pieces[i], pieces[j]]))
            # Pieces do not overlap: a hull that is no larger than both has nothing between them.
            if _area(both) <= _area(pieces[i]) + _area(pieces[j]) + THIN:
                pieces[i] = both
                del pieces[j]
                break
        else:
            i += 1
    return pieces


def _hull(points: Floats) -> Loop:
    from scipy.spatial import ConvexHull

    return _without_straight(points[ConvexHull(points).vertices])
