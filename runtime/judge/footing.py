"""What stands on what: the parts of supports that are under a body."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runtime.judge.extents import foot, homogeneous, lowest_of
from runtime.judge.polygon import convex_hull, within
from runtime.world.poses import Floats
from runtime.world.world import Support, World

REST = 0.002
"""Metres by which the bottom of a body may miss the height of what it rests on."""

FLUSH = 0.0005
"""Metres above its lowest point in which the foot of a body lies."""

LEVEL = 0.02
"""Radians by which a support may lean and still be one."""

Poses = Mapping[int, Floats]
"""World poses (4, 4) of the bodies that are not held, by their index in the world."""


@dataclass(frozen=True, eq=False)
class Footing:
    """A support under a body, the part (k, 2) of the body's foot that is on it, and the whole
    foot (n, 2), both convex."""

    support: Support
    patch: Floats
    foot: Floats


def support_pose(world: World, support: Support, poses: Poses) -> Floats | None:
    """Where the middle of a support is (4, 4); None where its owner is held, or does not
    stand so that the support is level."""
    pose = homogeneous(support.pose)
    owner = movable(world, support.owner)
    if owner is not None:
        if owner not in poses:
            return None
        pose = poses[owner] @ pose
    return pose if pose[2, 2] >= np.cos(LEVEL) else None


def movable(world: World, name: str) -> int | None:
    """The index of what can be moved under a name."""
    names = [thing.name for thing in world.movables]
    return names.index(name) if name in names else None


def footings(
    world: World, poses: Poses, index: int, rest: float = REST, supports: Iterable[Support] = ()
) -> list[Footing]:
    """What a body stands on."""
    body, pose = world.movables[index].body, poses[index]
    bottom = float(lowest_of(body, pose[None])[0])
    found, outline = [], None
    for support in supports or world.supports:
        if support.owner == world.movables[index].name:
            continue
        place = support_pose(world, support, poses)
        if place is None or abs(place[2, 3] - bottom) > rest:
            continue
        if outline is None:
            outline = convex_hull(foot(body, pose, FLUSH))
        axes = place[:2, :2].T / np.linalg.norm(place[:2, :2], axis=0)[:, None]
        patch = within(outline, place[:2, 3], axes, support.half)
        if len(patch):
            found.append(Footing(support, convex_hull(patch), outline))
    return found


def above(world: World, poses: Poses, roots: Sequence[int]) -> set[int]:
    """The bodies that stand on some bodies, on what stands on them, and so on."""
    under = {i: {f.support.owner for f in footings(world, poses, i)} for i in poses}
    found: set[int] = set()
    pending = list(roots)
    while pending:
        name = world.movables[pending.pop()].name
        new = {i for i, owners in under.items() if name in owners} - found - set(roots)
        found |= new
        pending += sorted(new)
    return found
