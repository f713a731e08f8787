"""Collisions between boxes, exactly: axis-aligned bounds to sort out, FCL to decide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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

    def bounds(self) -> tuple[Floats, Floats]:
        """Centres and half extents (N, 3) of the axis-aligned boxes around it."""
        return self.poses[:, :3, 3], np.abs(self.poses[:, :3, :3]) @ self.half


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

    def touch(self, a: Track, b: Track, sample: int) -> bool:
        """Whether two boxes touch in a sample."""
        first, second = self._pair(a.half)[0], self._pair(b.half)[1]
        for thing, track in ((first, a), (second, b)):
            pose = track.poses[sample if len(track.poses) > 1 else 0]
            thing.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
        request, result = fcl.CollisionRequest(), fcl.CollisionResult()
        return bool(fcl.collide(first, second, request, result))

    def first_hit(self, pairs: Sequence[tuple[Track, Track]]) -> Hit | None:
        """The earliest contact among pairs of tracks, or None."""
        earliest: Hit | None = None
        for a, b in pairs:
            (ca, ha), (cb, hb) = a.bounds(), b.bounds()
            near = np.all(np.abs(ca - cb) <= ha + hb, axis=1)
            for sample in np.flatnonzero(near):
                if earliest is not None and sample >= earliest.sample:
                    break
                if self.touch(a, b, int(sample)):
                    earliest = Hit(int(sample), a.owner, b.owner)
                    break
        return earliest
