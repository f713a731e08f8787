"""Convex outlines in the plane, and what of them is between two fingers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runtime.world.poses import Floats

TOUCHING = 2e-4
"""Metres from the outermost point within which an outline touches a finger."""

FRICTION = 0.6
"""Fingers hold what they touch on two sides if the points are nearly opposite: the tangent of
the angle by which they may be beside each other, well within what friction bears."""


def around(points: Floats) -> Floats:
    """The corners (m, 2) of the convex hull of points (n, 2), counter-clockwise (Andrew's
    monotone chain)."""
    rows = sorted(set(map(tuple, np.round(points, 9).tolist())))
    if len(rows) < 3:
        return np.array(rows).reshape(-1, 2)

    def half(ordered: Sequence[tuple[float, ...]]) -> list[tuple[float, ...]]:
        chain: list[tuple[float, ...]] = []
        for x, y in ordered:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 1e-15:
                    break
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return np.array(half(rows) + half(rows[::-1])).reshape(-1, 2)


def room_within(outline: Floats) -> float:
    """How far the origin is from the nearest side of a convex outline (n, 2) that it is in,
    counter-clockwise; negative where it is outside."""
    along = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(along[:, 0], along[:, 1])
    inside = (along[:, 1] * outline[:, 0] - along[:, 0] * outline[:, 1]) / lengths
    return float(inside.min())


@dataclass(frozen=True, eq=False)
class Slab:
    """What of some outlines is within a stretch along each of several headings (k,): `low` to
    `high` (k,), measured from the origin along the heading."""

    outlines: Sequence[Floats]
    angles: Floats
    low: Floats
    high: Floats

    @cached_property
    def _points(self) -> tuple[Floats, Floats]:
        """Along and across (n, k) of the corners of what is within; nan for what is not."""
        c, s = np.cos(self.angles), np.sin(self.angles)
        alongs, acrosses = [], []
        for outline in self.outlines:
            along = outline @ np.array([c, s])
            across = outline @ np.array([-s, c])
            within = (along >= self.low - 1e-12) & (along <= self.high + 1e-12)
            alongs.append(np.where(within, along, np.nan))
            acrosses.append(np.where(within, across, np.nan))
            then, there = np.roll(along, -1, axis=0), np.roll(across, -1, axis=0)
            for limit in (self.low, self.high):
                crosses = (along - limit) * (then - limit) < 0
                share = (limit - along) / np.where(crosses, then - along, 1.0)
                alongs.append(np.where(crosses, np.broadcast_to(limit, along.shape), np.nan))
                acrosses.append(np.where(crosses, across + share * (there - across), np.nan))
        return np.vstack(alongs), np.vstack(acrosses)

    @cached_property
    def _edges(self) -> tuple[Floats, Floats]:
        """The outermost points on the right and on the left (k,); 0 where nothing is within."""
        _, across = self._points
        known = ~np.isnan(across)
        right = np.where(known, across, np.inf).min(axis=0)
        left = np.where(known, across, -np.inf).max(axis=0)
        some = known.any(axis=0)
        return np.where(some, right, 0.0), np.where(some, left, 0.0)

    @property
    def reach(self) -> tuple[Floats, Floats]:
        """How far it reaches to the left and to the right of the heading (k,)."""
        right, left = self._edges
        return left, -right

    @property
    def width(self) -> Floats:
        """How wide it is (k,)."""
        right, left = self._edges
        return left - right

    @property
    def middle(self) -> Floats:
        """Where its middle is, to the left of the heading through the origin (k,)."""
        right, left = self._edges
        return (left + right) / 2

    @property
    def slip(self) -> Floats:
        """How far, along the heading, the points at which fingers touch it on the left and on
        the right are beside each other (k,)."""
        along, across = self._points
        right, left = self._edges
        with np.errstate(invalid="ignore"):
            on_left, on_right = across >= left - TOUCHING, across <= right + TOUCHING
        nearest = [np.where(on, along, np.inf).min(axis=0) for on in (on_left, on_right)]
        farthest = [np.where(on, along, -np.inf).max(axis=0) for on in (on_left, on_right)]
        slip: Floats = np.maximum(
            np.maximum(nearest[0] - farthest[1], nearest[1] - farthest[0]), 0.0
        )
        return slip
