"""Contacts between solids, exactly: axis-aligned bounds to sort out, FCL to decide."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import fcl
import numpy as np

from runtime.world.poses import Floats
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere


@dataclass(frozen=True, eq=False)
class Track:
    """A solid of a thing (`owner`) and its world poses (N, 4, 4) over N samples, or one pose
    (1, 4, 4) for all."""

    owner: str
    solid: Solid
    poses: Floats

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Centres and half extents (N, 3) of axis-aligned boxes around it."""
        return self.poses[:, :3, 3], np.abs(self.poses[:, :3, :3]) @ np.array(self.solid.half)

    @cached_property
    def hull(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner (3,) of the axis-aligned box around all samples."""
        centre, half = self.bounds
        return (centre - half).min(axis=0), (centre + half).max(axis=0)


def close_pairs(first: Sequence[Track], second: Sequence[Track]) -> list[tuple[Track, Track]]:
    """Pairs of one track of each kind that come near each other, if at different samples."""
    if not first or not second:
        return []
    low_a, high_a = (np.array(side)[:, None] for side in zip(*(t.hull for t in first), strict=True))
    low_b, high_b = (np.array(side) for side in zip(*(t.hull for t in second), strict=True))
    near = np.all((low_a <= high_b) & (low_b <= high_a), axis=2)
    return [(first[i], second[j]) for i, j in np.argwhere(near)]


@dataclass(frozen=True)
class Hit:
    """Two things that touch in a sample."""

    sample: int
    first: str
    second: str


def shape_of(solid: Solid) -> Any:
    """A solid as FCL has it."""
    match solid:
        case Box():
            return fcl.Box(*solid.size)
        case Cylinder():
            return fcl.Cylinder(solid.radius, solid.height)
        case Sphere():
            return fcl.Sphere(solid.radius)
        case Capsule():
            return fcl.Capsule(solid.radius, solid.height)
        case Hull():
            return _convex(solid)


def _convex(hull: Hull) -> Any:
    from scipy.spatial import ConvexHull

    points = hull.points
    sides = ConvexHull(points)
    faces: list[int] = []
    for corners, normal in zip(sides.simplices, sides.equations[:, :3], strict=True):
        a, b, c = corners.tolist()
        if np.cross(points[b] - points[a], points[c] - points[a]) @ normal < 0:
            b, c = c, b  # FCL wants corners counter-clockwise from outside
        faces += [3, a, b, c]
    return fcl.Convex(points, len(sides.simplices), np.array(faces, dtype=np.int32))


class Exact:
    """FCL objects, made once for each solid."""

    def __init__(self) -> None:
        self._objects: dict[Solid, tuple[Any, Any]] = {}

    def _pair(self, solid: Solid) -> tuple[Any, Any]:
        """Two objects, for a solid may be tested against one that is like it."""
        if solid not in self._objects:
            shape = shape_of(solid)
            self._objects[solid] = fcl.CollisionObject(shape), fcl.CollisionObject(shape)
        return self._objects[solid]

    def _first_touch(self, a: Track, b: Track, samples: Iterable[int]) -> int | None:
        """The first of some samples in which two solids touch."""
        first, second = self._pair(a.solid)[0], self._pair(b.solid)[1]
        request = fcl.CollisionRequest()
        for thing, track in ((first, a), (second, b)):
            if len(track.poses) == 1:
                thing.setTransform(_transform(track.poses[0]))
        for sample in samples:
            for thing, track in ((first, a), (second, b)):
                if len(track.poses) > 1:
                    thing.setTransform(_transform(track.poses[sample]))
            if fcl.collide(first, second, request, fcl.CollisionResult()):
                return sample
        return None

    def first_hit(self, pairs: Sequence[tuple[Track, Track]]) -> Hit | None:
        """The earliest contact among pairs of tracks, or None."""
        earliest: Hit | None = None
        for a, b in pairs:
            (ca, ha), (cb, hb) = a.bounds, b.bounds
            near = np.flatnonzero(np.all(np.abs(ca - cb) <= ha + hb, axis=1))
            if earliest is not None:
                near = near[near < earliest.sample]
            found = self._first_touch(a, b, near.tolist())
            if found is not None:
                earliest = Hit(found, a.owner, b.owner)
        return earliest

    def distance(self, a: Track, b: Track, sample: int) -> float:
        """Metres between two solids in a sample; 0 or less where they touch."""
        first, second = self._pair(a.solid)[0], self._pair(b.solid)[1]
        for thing, track in ((first, a), (second, b)):
            thing.setTransform(_transform(track.poses[min(sample, len(track.poses) - 1)]))
        found: float = fcl.distance(first, second, fcl.DistanceRequest(), fcl.DistanceResult())
        return found


def _transform(pose: Floats) -> Any:
    return fcl.Transform(pose[:3, :3], pose[:3, 3])
