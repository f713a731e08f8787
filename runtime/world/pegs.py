"""Places on which only the middle will do: around a knob or a peg, or around a hole.

What is hollow from below around its middle, a ring or a lid with a knob, can be put down over a
peg, and then rests on what is level around that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from runtime.world.body import Body, Part
from runtime.world.outline import vertices_and_edges
from runtime.world.poses import Pose, apply, compose, invert, upright
from runtime.world.solids import Floats
from runtime.world.stable import StablePose
from runtime.world.tops import LEVEL, SLENDER, WIDE, Rectangle, level_tops
from runtime.world.world import Peg, Support

SUFFIX = "/ring"

SHOULDER = 0.005
"""Metres that is level around a peg or a hole, on all sides, at least."""

PLAY = 0.003
"""Metres between a peg and what goes over it, on all sides, at least."""

ABOVE = 0.001
"""Metres between the top of a peg and the roof of a hollow, at least."""

TURNS = np.arange(64) * (2 * math.pi / 64)
"""Directions in which it is looked at what is level around a hole, ..."""

RADII = 0.001
"""... and metres from one place to the next along them."""


@dataclass(frozen=True)
class Hollow:
    """The room for an upright cylinder in a body, about its middle and from its bottom upwards:
    radius and depth, metres; the depth of a hole that goes through is infinite."""

    radius: float
    depth: float

    def goes_over(self, peg: Peg) -> bool:
        """Whether there is room for a peg."""
        return peg.radius + PLAY <= self.radius and peg.height + ABOVE <= self.depth


def name_of_ring(owner: str) -> str:
    """What the place around a knob or a hole of an object is called."""
    return owner + SUFFIX


def owner_of_ring(name: str) -> str:
    """The object that such a place belongs to; the name itself where it is none."""
    return name.removesuffix(SUFFIX)


def ring_of(name: str, body: Body, stable: StablePose, air: float) -> Support | None:
    """The place around a knob or a hole of a body in a stable pose, in the body's frame, `air`
    metres above it; None where it has none. The largest of several ones."""
    placed = [Part(part.solid, compose(stable.pose, part.pose)) for part in body.parts]
    if len(placed) == 1:
        return None
    found = [
        ring
        for ring in (*_around_knobs(placed), _around_hole(placed))
        if ring is not None and 2 * min(ring[0].half) >= max(WIDE, SLENDER * ring[0].height)
    ]
    if not found:
        return None
    ring, peg = max(found, key=lambda each: (round(each[0].area, 6), each[0].height))
    x, y, z = (ring.turn().T @ ring.middle(air)).tolist()
    pose = compose(invert(stable.pose), upright(x, y, z, ring.yaw))
    risen = Peg(peg.radius, max(0.0, peg.height - air))
    return Support(name_of_ring(name), name, pose, ring.half, peg=risen)


def _around_knobs(placed: Sequence[Part]) -> list[tuple[Rectangle, Peg]]:
    """Level tops around all that rises above them, where that is in one place and leaves them free
    on all sides, and the peg that it is; its height is measured from the top."""
    found = []
    for part in placed:
        others = [other for other in placed if other is not part]
        for top in level_tops(part):
            ring = _around_knob(top, others)
            if ring is not None:
                found.append(ring)
    return found


def _around_knob(top: Rectangle, others: Sequence[Part]) -> tuple[Rectangle, Peg] | None:
    corners = [apply(p.pose, vertices_and_edges(p.solid)[0]) @ top.turn().T for p in others]
    risen = [
        points
        for points in corners
        if points[:, 2].max() > top.height + LEVEL
        and (points[:, :2].max(axis=0) > (top.x0, top.y0)).all()
        and (points[:, :2].min(axis=0) < (top.x1, top.y1)).all()
    ]
    if not risen:
        return None
    points = np.vstack(risen)
    (x, y), highest = (points.min(axis=0) + points.max(axis=0))[:2] / 2, float(points[:, 2].max())
    radius = float(np.hypot(points[:, 0] - x, points[:, 1] - y).max())
    hx, hy = min(x - top.x0, top.x1 - x), min(y - top.y0, top.y1 - y)
    if min(hx, hy) < radius + SHOULDER:
        return None
    around = Rectangle(x - hx, x + hx, y - hy, y + hy, top.yaw, top.height)
    return around, Peg(radius, highest - top.height)


def _around_hole(placed: Sequence[Part]) -> tuple[Rectangle, Peg] | None:
    """The square within what is level, all around the middle, at the very top of a body that is
    open there; what comes through it is not known here, so the peg is nothing."""
    corners = [apply(part.pose, vertices_and_edges(part.solid)[0]) for part in placed]
    height = max(float(points[:, 2].max()) for points in corners)
    tops = [points[points[:, 2] > height - 10 * LEVEL, :2] for points in corners]
    facets = [points for points in tops if len(points) > 2 and np.ptp(points, axis=0).min() > LEVEL]
    if not facets:
        return None
    reach = max(float(np.hypot(*points.T).max()) for points in facets)
    radii = np.arange(0.0, reach, RADII)
    rays = np.column_stack([np.cos(TURNS), np.sin(TURNS)])
    points = (radii[:, None, None] * rays).reshape(-1, 2)
    covered = np.zeros((len(radii), len(TURNS)), dtype=np.bool_)
    for facet in facets:
        covered |= _are_within(facet, points).reshape(covered.shape)
    closed: NDArray[np.bool_] = np.logical_and.reduce(covered, axis=1)
    if not closed.any() or closed[0]:
        return None
    inner = int(np.argmax(closed))
    outer = inner + int(np.argmin(np.append(closed[inner:], False))) - 1
    if radii[outer] - radii[inner] < SHOULDER:
        return None
    half = float(radii[outer]) / math.sqrt(2)
    return Rectangle(-half, half, -half, half, 0.0, height), Peg(0.0, 0.0)


def _are_within(facet: Floats, points: Floats) -> NDArray[np.bool_]:
    """Which points (n, 2) are in the convex hull of some others (k, 2)."""
    from scipy.spatial import ConvexHull

    sides = ConvexHull(facet).equations
    inside: NDArray[np.bool_] = (points @ sides[:, :2].T + sides[:, 2] <= LEVEL).all(axis=1)
    return inside


def hollow_of_body(body: Body, pose: Pose) -> Hollow | None:
    """The hollow of a body at a pose (3, 4) in which it stands on the plane z = 0, about z."""
    return hollow_of(tuple(Part(part.solid, compose(pose, part.pose)) for part in body.parts))


@lru_cache(maxsize=256)
def hollow_of(parts: tuple[Part, ...]) -> Hollow | None:
    """The hollow of a body whose solids stand on the plane z = 0 around the z axis; None where a
    solid is on that axis at the bottom."""
    if len(parts) == 1:
        return None
    roof = min(_entered(part) for part in parts)
    if roof < LEVEL:
        return None
    radius = math.inf
    for part in parts:
        points, edges = vertices_and_edges(part.solid)
        radius = min(radius, _beside(apply(part.pose, points), edges, roof - LEVEL))
    return Hollow(radius, roof) if 0.0 < radius < math.inf else None


def _entered(part: Part) -> float:
    """The height at which the z axis, from below, enters a solid; infinite where it misses it."""
    from scipy.spatial import ConvexHull

    points = apply(part.pose, vertices_and_edges(part.solid)[0])
    sides = ConvexHull(points).equations  # outward normals and offsets
    rise, off = sides[:, 2], sides[:, 3]
    level = np.abs(rise) < 1e-12
    if np.any(off[level] > -1e-9):
        return math.inf
    heights = -off[~level] / rise[~level]
    enter, leave = heights[rise[~level] < 0].max(), heights[rise[~level] > 0].min()
    return float(enter) if enter < leave - 1e-9 else math.inf


def _beside(points: Floats, edges: Sequence[tuple[int, int]], high: float) -> float:
    """Metres between the z axis and what of a convex solid beside it is below a height."""
    ends = points[np.array(edges)]
    a, b = ends[:, 0], ends[:, 1]
    crosses = (a[:, 2] - high) * (b[:, 2] - high) < 0
    a, b = a[crosses], b[crosses]
    share = (high - a[:, 2]) / (b[:, 2] - a[:, 2])
    seen = np.vstack([points[points[:, 2] <= high, :2], (a + share[:, None] * (b - a))[:, :2]])
    if not len(seen):
        return math.inf
    # The axis is outside of it: the nearest point is on a line between two of the corners.
    a, b = (seen[k] for k in np.triu_indices(len(seen)))
    along = b - a
    share = -(a * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-18)
    nearest = a + np.clip(share, 0.0, 1.0)[:, None] * along
    return float(np.hypot(*nearest.T).min())
