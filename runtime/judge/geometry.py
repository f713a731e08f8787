"""Collisions between boxes, exactly: axis-aligned bounds to sort out, FCL to decide."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import fcl
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Track:
    """A box and its world poses (N, 4, 4) over N samples, or one pose (1, 4, 4) for all."""

    name: str
    owner: str
    half: Floats
    poses: Floats

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Centres and half extents (N, 3) of the axis-aligned boxes around it."""
        return self.poses[:, :3, 3], np.abs(self.poses[:, :3, :3]) @ self.half

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
    """Two boxes that touch in a sample."""

    sample: int
    first: str
    second: str


class ExactBoxes:
    """FCL shapes, made once for each size."""

    def __init__(self) -> None:
        self._objects: dict[tuple[float, ...], tuple[fcl.CollisionObject, fcl.CollisionObject]] = {}

    def _pair(self, half: Floats) -> tuple[fcl.CollisionObject, fcl.CollisionObject]:
        key = tuple(half.tolist())
        if key not in self._objects:
            size = 2 * half
            self._objects[key] = (
                fcl.CollisionObject(fcl.Box(*size)),
                fcl.CollisionObject(fcl.Box(*size)),
            )
        return self._objects[key]

    def _first_touch(self, a: Track, b: Track, samples: Iterable[int]) -> int | None:
        """The first of some samples in which two boxes touch."""
        first, second = self._pair(a.half)[0], self._pair(b.half)[1]
        request = fcl.CollisionRequest()
        for thing, track in ((first, a), (second, b)):
            if len(track.poses) == 1:
                thing.setTransform(_transform(track, 0))
        for sample in samples:
            for thing, track in ((first, a), (second, b)):
                if len(track.poses) > 1:
                    thing.setTransform(_transform(track, sample))
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


def _transform(track: Track, sample: int) -> fcl.Transform:
    pose = track.poses[sample]
    return fcl.Transform(pose[:3, :3], pose[:3, 3])
