"""Convex polygons in the plane, counter-clockwise; points and segments count as polygons."""

from __future__ import annotations

import numpy as np

from runtime.world.poses import Floats

SAME = 1e-9
"""Metres (square metres) below which points are one, and corners lie on a line."""


def convex_hull(points: Floats) -> Floats:
    """The corners (k, 2) of the hull of points (n, 2), by Andrew's monotone chain."""
    ordered = sorted({(round(x, 9), round(y, 9)) for x, y in points.tolist()})
    if len(ordered) < 3:
        return np.array(ordered).reshape(-1, 2)

    def chain(row: list[tuple[float, float]]) -> list[tuple[float, float]]:
        found: list[tuple[float, float]] = []
        for point in row:
            while len(found) > 1 and _turn(found[-2], found[-1], point) <= 1e-15:
                found.pop()
            found.append(point)
        return found[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def clip(polygon: Floats, normal: Floats, offset: float) -> Floats:
    """What of a polygon (k, 2) is where `normal` times the point is at most `offset`
    (Sutherland and Hodgman)."""
    if not len(polygon):
        return polygon
    over = polygon @ normal - offset
    found: list[Floats] = []
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        if over[i] <= SAME:
            found.append(polygon[i])
        if (over[i] > SAME) != (over[j] > SAME):
            share = over[i] / (over[i] - over[j])
            found.append(polygon[i] + share * (polygon[j] - polygon[i]))
    return np.array(found).reshape(-1, 2)


def within(polygon: Floats, middle: Floats, axes: Floats, half: tuple[float, float]) -> Floats:
    """What of a polygon lies in a rectangle: its middle (2,), axes (2, 2) as rows, half size."""
    for axis, size in zip(axes, half, strict=True):
        polygon = clip(polygon, axis, float(axis @ middle) + size)
        polygon = clip(polygon, -axis, float(-axis @ middle) + size)
    return polygon


def outside_by(polygon: Floats, point: Floats) -> float:
    """Metres by which a point lies outside a convex polygon; negative inside, by the distance
    from the nearest side."""
    if len(polygon) == 1:
        return float(np.linalg.norm(point - polygon[0]))
    sides = np.roll(polygon, -1, axis=0) - polygon
    lengths = np.linalg.norm(sides, axis=1)
    off = point - polygon
    if len(polygon) > 2:
        inside = (sides[:, 0] * off[:, 1] - sides[:, 1] * off[:, 0]) / lengths
        if inside.min() >= 0:
            return -float(inside.min())
    share = np.clip((off * sides).sum(axis=1) / lengths**2, 0.0, 1.0)
    return float(np.linalg.norm(off - share[:, None] * sides, axis=1).min())
