"""Flat pads that close on what is between them, and whether it stays there.

Each pad pushes along the line on which the fingers close. It holds where the face that it touches
stands across that line, as far as friction goes: the corner of a large cube between the tips
slips out, however well the tips are opposite each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.outlines import FRICTION, TOUCHING, Slab
from runtime.world.poses import Floats

BEYOND = 0.0001
"""Metres beyond the edges of a pad up to which it is seen how a face goes on that it touches."""

SNUG = 0.001
"""Metres by which what is between the pads may be wider or narrower on one side than it seems."""


def across(slab: Slab) -> NDArray[np.bool_]:
    """Whether (k,) pads on both sides touch upright faces that stand across their way, opposite
    each other: both tangents together, of how far they lean and of how far they are beside each
    other, are at most that of the cone of friction."""
    longer = Slab(slab.outlines, slab.angles, slab.low - BEYOND, slab.high + BEYOND)
    more = [a - b for a, b in zip(longer.reach, slab.reach, strict=True)]
    held: NDArray[np.bool_] = _is_within(slab.slip, np.maximum(*more), slab.width)
    return held


def _is_within(beside: Floats, more: Floats, width: Floats) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = beside + more / BEYOND * width <= FRICTION * width
    return found


WAYS = np.array([[math.cos(k * math.pi / 12), math.sin(k * math.pi / 12)] for k in range(12)])
"""Directions along which it is measured how far two contacts are beside each other."""


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """A convex solid: corners (n, 3), edges (e, 2), and faces: normals (f, 3) times points are at
    most offsets (f,)."""

    corners: Floats
    edges: NDArray[np.intp]
    normals: Floats
    offsets: Floats

    @classmethod
    def of(cls, corners: Floats, edges: Sequence[tuple[int, int]]) -> Polyhedron:
        """The one with those corners and edges."""
        from scipy.spatial import ConvexHull

        equations = ConvexHull(corners).equations
        return cls(corners, np.array(edges), equations[:, :3], -equations[:, 3])

    def within(self, tools: Floats, pad: Floats) -> Floats:
        """Points (k, m, 3) in tool frames (k, 3, 4) whose hull is what of it is between pads from
        `pad` (2, 2), the lowest x and z, to the highest; nan for what is not."""
        turn, place = tools[:, :, :3], tools[:, :, 3]
        corners = (self.corners - place[:, None]) @ turn
        low, high = pad
        flat = corners[..., [0, 2]]
        inside = ((flat >= low) & (flat <= high)).all(axis=2)
        found = [np.where(inside[..., None], corners, np.nan)]
        a, b = corners[:, self.edges[:, 0]], corners[:, self.edges[:, 1]]
        for axis, other in ((0, 2), (2, 0)):
            for limit in pad[:, axis // 2]:
                crosses = (a[..., axis] - limit) * (b[..., axis] - limit) < 0
                share = (limit - a[..., axis]) / np.where(crosses, b[..., axis] - a[..., axis], 1.0)
                points = a + share[..., None] * (b - a)
                crosses &= (points[..., other] >= low[other // 2]) & (
                    points[..., other] <= high[other // 2]
                )
                found.append(np.where(crosses[..., None], points, np.nan))
        found.append(self._at_corners(tools, pad))
        return np.concatenate(found, axis=1)

    def _at_corners(self, tools: Floats, pad: Floats) -> Floats:
        """Where lines along y through the corners of the pads enter and leave it (k, 8, 3)."""
        normals = self.normals @ tools[:, :, :3]  # (k, f, 3)
        room = self.offsets - tools[:, :, 3] @ self.normals.T
        x, z = (grid.ravel() for grid in np.meshgrid(pad[:, 0], pad[:, 1]))
        left = room[..., None] - normals[..., :1] * x - normals[..., 2:] * z  # (k, f, 4)
        way = normals[..., 1:2]
        with np.errstate(divide="ignore", invalid="ignore"):
            y = left / way
        enter = np.where(way < -1e-9, y, -np.inf).max(axis=1)
        leave = np.where(way > 1e-9, y, np.inf).min(axis=1)
        missed = (enter >= leave) | ((np.abs(way) <= 1e-9) & (left < 0)).any(axis=1)
        ends = [
            np.stack([np.broadcast_to(x, enter.shape), each, np.broadcast_to(z, enter.shape)], -1)
            for each in (enter, leave)
        ]
        return np.concatenate([np.where(missed[..., None], np.nan, end) for end in ends], axis=1)


def firm(
    parts: Sequence[Polyhedron], tools: Floats, pad: Floats, widths: Floats
) -> NDArray[np.bool_]:
    """Whether (k,) pads that are `widths` (k,) apart in tool frames (k, 3, 4) fit what is between
    them, whatever its shape, and touch it across their way. `pad` (2, 2) are the lowest x and z of
    the pads, and the highest."""
    grown = pad + BEYOND * np.array([[-1.0], [1.0]])
    some = np.zeros(len(tools), dtype=bool)
    left, right = np.full(len(tools), -np.inf), np.full(len(tools), np.inf)
    more_left, more_right = left, right
    points = []
    for part in parts:
        mine = part.within(tools, pad)
        low, high = _range(mine[..., 1])
        # What is wholly beyond a finger is not between them: the other wall of a tray.
        counts = (low <= widths / 2 + SNUG) & (high >= -widths / 2 - SNUG)
        some |= counts
        left = np.where(counts, np.maximum(left, high), left)
        right = np.where(counts, np.minimum(right, low), right)
        low, high = _range(part.within(tools, grown)[..., 1])
        more_left = np.where(counts, np.maximum(more_left, high), more_left)
        more_right = np.where(counts, np.minimum(more_right, low), more_right)
        points.append(np.where(counts[:, None, None], mine, np.nan))
    seen = np.concatenate(points, axis=1)
    left, right = np.where(some, left, 0.0), np.where(some, right, 0.0)
    off = np.maximum(np.abs(left - widths / 2), np.abs(right + widths / 2))
    with np.errstate(invalid="ignore"):
        on_left = seen[..., 1] >= left[:, None] - TOUCHING
        on_right = seen[..., 1] <= right[:, None] + TOUCHING
    beside = np.max([_gap(seen[..., [0, 2]] @ way, on_left, on_right) for way in WAYS], axis=0)
    more = np.where(some, np.maximum(more_left - left, right - more_right), np.inf)
    held: NDArray[np.bool_] = some & (off <= SNUG) & _is_within(beside, more, widths)
    return held


def _range(values: Floats) -> tuple[Floats, Floats]:
    """Least and most of each row (k,); inf and -inf where all are nan."""
    known = ~np.isnan(values)
    return (
        np.where(known, values, np.inf).min(axis=1),
        np.where(known, values, -np.inf).max(axis=1),
    )


def _gap(values: Floats, some: NDArray[np.bool_], others: NDArray[np.bool_]) -> Floats:
    """How far (k,) the ranges of some of the values and of others are from each other."""
    low, high = _range(np.where(some, values, np.nan))
    their_low, their_high = _range(np.where(others, values, np.nan))
    found: Floats = np.maximum(np.maximum(low - their_high, their_low - high), 0.0)
    return found
