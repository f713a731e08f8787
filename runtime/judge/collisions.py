"""What touches what it must not while robot and bodies move."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from runtime.judge.contacts import Exact, Hit, Track, close_pairs
from runtime.judge.extents import lowest
from runtime.judge.skeleton import Skeleton
from runtime.robot.model import BOLTED
from runtime.world.world import FLOOR

BELOW = 1e-4
"""Metres below the floor that nothing is."""


@dataclass(frozen=True, eq=False)
class Crowd:
    """The solids of all that is there, over the same samples or not moving at all.

    `held` is what the gripper holds, `resting` what stands on that, `guided` what the tool moves
    along a constraint of its own, `standing` everything else.
    """

    robot: Sequence[Track]
    held: Sequence[Track]
    resting: Sequence[Track]
    guided: Sequence[Track]
    standing: Sequence[Track]


def first_collision(
    exact: Exact, skeleton: Skeleton, hand: Collection[str], crowd: Crowd
) -> Hit | None:
    """The earliest contact that must not be, the floor's included. `hand` are the links that
    may touch what is held or guided."""
    arm = [track for track in crowd.robot if track.owner not in hand]
    pairs = close_pairs([_bolted(skeleton, track) for track in crowd.robot], crowd.standing)
    pairs += [
        (a, b)
        for i, a in enumerate(crowd.robot)
        for b in crowd.robot[:i]
        if not skeleton.may_touch(a.owner, b.owner)
    ]
    moved = [*crowd.held, *crowd.resting, *crowd.guided]
    pairs += close_pairs(moved, crowd.standing)
    pairs += close_pairs([*crowd.held, *crowd.guided], arm)
    pairs += close_pairs(crowd.resting, crowd.robot)
    pairs += close_pairs(crowd.guided, [*crowd.held, *crowd.resting])
    swinging = [track for track in crowd.robot if skeleton.rigid[track.owner]]
    hits = [exact.first_hit(pairs), _below_the_floor([*swinging, *moved])]
    return min((hit for hit in hits if hit is not None), key=lambda h: h.sample, default=None)


def _bolted(skeleton: Skeleton, track: Track) -> Track:
    """A solid of the robot as it is tested against what stands: that of a fixed robot's foot a
    little higher."""
    if skeleton.robot.base.type != "fixed" or skeleton.rigid[track.owner]:
        return track
    poses = track.poses.copy()
    poses[:, 2, 3] += BOLTED
    return replace(track, poses=poses)


def _below_the_floor(tracks: Sequence[Track]) -> Hit | None:
    earliest: Hit | None = None
    for track in tracks:
        under = np.flatnonzero(lowest(track.solid, track.poses) < -BELOW)
        if len(under) and (earliest is None or under[0] < earliest.sample):
            earliest = Hit(int(under[0]), track.owner, f"the {FLOOR}")
    return earliest
