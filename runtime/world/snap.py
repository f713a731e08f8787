"""From an orientation that somebody wrote down to the nearest stable pose."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from runtime.world.body import Body
from runtime.world.poses import Pose, compose, upright
from runtime.world.solids import Capsule, Cylinder, Floats, Sphere
from runtime.world.stable import StablePose, stable_poses


def nearest_stable(
    body: Body, poses: Sequence[StablePose], rotation: Floats
) -> tuple[int, float, float]:
    """The stable pose nearest to an orientation (3, 3) of the body: its number, its heading and
    the angle between the two, radians. What is round may have turned about its axis."""
    ups = [_tilt(body, pose, rotation[2]) for pose in poses]
    number = int(np.argmin(ups))
    return number, _heading(body, poses[number], rotation), ups[number]


def middle_of(body: Body, pose: Pose) -> Floats:
    """Where the middle (3,) of the box around a body, along its own axes, is at a pose."""
    low, high = body.bounds
    middle: Floats = pose[:3, :3] @ ((low + high) / 2) + pose[:3, 3]
    return middle


def resting_heading(body: Body, pose: Pose) -> float:
    """The heading of a body that rests in one of its stable poses, radians."""
    return nearest_stable(body, stable_poses(body), pose[:3, :3])[1]


def resting_pose(stable: StablePose, x: float, y: float, z: float, yaw: float) -> Pose:
    """The pose of a body that rests on the height z, its middle at (x, y), turned by `yaw`."""
    return compose(upright(x, y, z, yaw), stable.pose)


def _tilt(body: Body, pose: StablePose, up: Floats) -> float:
    """The angle between what points up in the body's frame and what does in a stable pose."""
    solid = body.parts[0].solid if len(body.parts) == 1 else None
    if isinstance(solid, Sphere):
        return 0.0
    if isinstance(solid, Cylinder | Capsule) and pose.rolls:
        return abs(math.asin(min(1.0, max(-1.0, up[2]))))
    return math.acos(min(1.0, max(-1.0, float(up @ pose.up))))


def _heading(body: Body, pose: StablePose, rotation: Floats) -> float:
    if pose.rolls and isinstance(body.parts[0].solid, Cylinder | Capsule):
        return math.atan2(rotation[1, 2], rotation[0, 2])  # of its axis
    turn = rotation @ pose.pose[:, :3].T
    return math.atan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])
