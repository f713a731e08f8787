"""Bodies that a constraint of their own moves along with the tool: doors, drawers, pushes."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from runtime.judge.contacts import Exact, Track
from runtime.judge.extents import homogeneous
from runtime.judge.footing import Poses, footings
from runtime.world.body import Body
from runtime.world.poses import Floats
from runtime.world.quaternions import between, matrix
from runtime.world.world import Guide, World

TOUCH = 0.005
"""Metres from the gripper within which what it moves must stay."""

SLIDES = 50
"""Samples of a push in which it is looked at what the pushed thing slides on, at most."""

STRAY = 0.002
"""Metres (and with it, 5 times as many radians) by which it may leave its guide."""


def dense_poses(poses: Floats, counts: list[int]) -> Floats:
    """World poses (N, 4, 4) of poses (k, 7) with counts[i] samples from way point i to the
    next, that one included."""
    rows = [matrix(poses[0])]
    for (a, b), count in zip(pairwise(poses), counts, strict=True):
        rows += [matrix(between(a, b, j / count)) for j in range(1, count + 1)]
    return np.array(rows)


def tracks_of(name: str, body: Body, poses: Floats) -> list[Track]:
    """The solids of a body at poses (N, 4, 4)."""
    return [Track(name, part.solid, poses @ homogeneous(part.pose)) for part in body.parts]


def touch_fault(exact: Exact, body: list[Track], hand: list[Track], name: str) -> str | None:
    """Why a gripper cannot have moved a body: it is away from it in some sample."""
    for sample in range(len(body[0].poses)):
        nearest = min(exact.distance(a, b, sample) for a in body for b in hand)
        if nearest > TOUCH:
            return f"{name} moves, and the gripper is {1000 * nearest:.0f} mm away from it"
    return None


def guide_fault(guide: Guide, start: Floats, poses: Floats, name: str) -> str | None:
    """Why a fixed thing that started at a pose (4, 4) cannot be at poses (N, 4, 4)."""
    axis, origin = np.array(guide.axis), np.array(guide.origin)
    for pose in poses:
        moved = pose @ np.linalg.inv(start)
        if guide.type == "prismatic":
            value = float(moved[:3, 3] @ axis)
            wanted = np.eye(4)
            wanted[:3, 3] = value * axis
        else:
            value, wanted = _turned(moved, axis, origin)
        off = np.abs(moved - wanted)
        if off[:3, :3].max() > 5 * STRAY or off[:3, 3].max() > STRAY:
            return f"{name} leaves its guide"
        if not guide.lower - STRAY <= value <= guide.upper + STRAY:
            return f"{name} goes beyond the end of its guide"
    return None


def _turned(moved: Floats, axis: Floats, origin: Floats) -> tuple[float, Floats]:
    """The turn about an axis that is nearest to a motion, and its matrix."""
    turn = moved[:3, :3]
    skew = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    value = math.atan2(float(skew @ axis), float(np.trace(turn)) - 1.0)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    wanted = np.eye(4)
    wanted[:3, :3] += math.sin(value) * cross + (1 - math.cos(value)) * (cross @ cross)
    wanted[:3, 3] = origin - wanted[:3, :3] @ origin
    return value, wanted


def slide_fault(world: World, poses: Poses, index: int, way: Floats) -> str | None:
    """Why a thing that is pushed cannot be at poses (N, 4, 4): it leaves what it slides on."""
    count = min(len(way), SLIDES)
    for sample in np.linspace(0, len(way) - 1, count).round().astype(int):
        if not footings(world, {**poses, index: way[sample]}, index):
            name = world.movables[index].name
            return f"{name} is moved along, but not on what it could rest on"
    return None
