"""Whether motions keep the limits of a robot, and what the plan format promises of times.

Each function says in one sentence what is wrong, or None. Tolerances are for the six places
of numbers in files, and no more.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from runtime.angles import wrap
from runtime.robot.model import MobileBase, RobotModel
from runtime.world.poses import Floats

LIMIT_SLACK = 1e-5
"""Radians or metres by which a joint may pass its limits."""

SPEED_SLACK = 1.01
"""Factor by which speeds and accelerations may pass theirs."""

TICK = 2e-6
"""What rounding does to the difference of two numbers."""

CREEP = 2e-5
"""Metres (radians) that count as no motion of the base."""

CORNER = 0.02
"""Radians (metres) of joint-space path around a corner that a controller may round off."""


def least_time(distance: float, velocity: float, acceleration: float) -> float:
    """Seconds from rest to rest: half of it at full acceleration each way, if the limit of
    speed is not reached before."""
    if distance <= 0:
        return 0.0
    if velocity <= 0 or acceleration <= 0:
        return math.inf
    ramp = velocity / acceleration
    if distance >= velocity * ramp:
        return distance / velocity + ramp
    return 2 * math.sqrt(distance / acceleration)


def base_fault(base: MobileBase, poses: Floats, times: Floats) -> str | None:
    """What is wrong with a motion of the base through poses (k, 3), at rest at each."""
    kind = base.type
    for a, b, seconds in zip(poses[:-1], poses[1:], np.diff(times), strict=True):
        distance, turn = math.hypot(b[0] - a[0], b[1] - a[1]), abs(float(b[2] - a[2]))
        if kind == "fixed" and max(distance, turn) > CREEP:
            return "the base moves, which is fixed"
        if kind == "differential":
            if distance > CREEP and turn > CREEP:
                return "the base drives and turns at once"
            off = wrap(math.atan2(b[1] - a[1], b[0] - a[0]) - float(a[2]))
            if distance * abs(math.sin(off)) > CREEP + TICK * distance:
                return "the base moves sideways, which a differential drive cannot"
        least = max(
            least_time(distance - TICK, base.velocity, base.acceleration),
            least_time(turn - TICK, base.angular_velocity, base.angular_acceleration),
        )
        if least > seconds * SPEED_SLACK + TICK:
            return (
                f"the base is faster than its limits: {seconds:.2f} s for what takes "
                f"{least:.2f} s from rest to rest"
            )
    return None


def arm_fault(robot: RobotModel, path: Floats, times: Floats) -> str | None:
    """What is wrong with a motion of the planning joints through a path (k, n), which starts
    and ends at rest."""
    beyond = np.maximum(robot.lower - path, path - robot.upper)
    if beyond.max() > LIMIT_SLACK:
        joint = robot.joints[int(beyond.max(axis=0).argmax())]
        return f"{joint} leaves its limits by {beyond.max():.4f}"
    steps, seconds = np.diff(path, axis=0), np.diff(times)
    moved = np.abs(steps).max(axis=1, initial=0.0) > TICK
    if np.any(moved & (seconds <= 0)):
        return "the arm jumps: there is no time between two of its way points"
    steps, seconds = steps[seconds > 0], seconds[seconds > 0]
    if not len(steps):
        return None
    speeds, rounding = steps / seconds[:, None], TICK / seconds[:, None]
    fast = np.abs(speeds) - robot.velocity * (SPEED_SLACK + rounding) - rounding
    if fast.max() > 0:
        joint = robot.joints[int(fast.max(axis=0).argmax())]
        return f"{joint} is faster than its limit"
    return _acceleration_fault(robot, speeds, seconds)


def _acceleration_fault(robot: RobotModel, speeds: Floats, seconds: Floats) -> str | None:
    """Mean speeds (k, n) over stretches of time (k,) that no motion within the accelerations
    has: from stretch to stretch they change by no more than acceleration times the time from
    middle to middle, corners aside; and a motion that rests has half a stretch to get going."""
    limit = robot.acceleration
    half = limit * seconds[:, None] / 2
    # A speed is known to the rounding of positions and of the time, which shorter stretches
    # have more of.
    rounding = (TICK + TICK * np.abs(speeds)) / seconds[:, None]
    for row, end in ((0, "starts"), (-1, "ends")):
        over = np.abs(speeds[row]) - half[row] * SPEED_SLACK - rounding[row]
        if over.max() > 0:
            return f"{robot.joints[int(over.argmax())]} is not at rest where the motion {end}"
    if len(speeds) < 2:
        return None
    change = np.abs(np.diff(speeds, axis=0))
    allowed = (half[1:] + half[:-1]) * SPEED_SLACK + rounding[1:] + rounding[:-1]
    over = change - allowed - _corners(speeds, half, limit)
    if over.max() > 0:
        joint = robot.joints[int(over.max(axis=0).argmax())]
        return f"{joint} changes its speed faster than its acceleration allows"
    return None


def _corners(speeds: Floats, half: Floats, limit: Floats) -> Floats:
    """How much more (k - 1, n) the speeds may change at way points where the path has a corner:
    by the turn at the most speed with which the way point can be passed, and by no more than
    the accelerations do in the time that `CORNER` of path takes at the least such speed."""
    lengths = np.linalg.norm(speeds, axis=1)
    moving = np.where(lengths > 0, lengths, 1.0)
    directions = speeds / moving[:, None]
    # The most that the speed along the path may differ from its mean within a stretch.
    size = np.abs(directions)
    slack = np.where(size > 0, half / np.where(size > 0, size, 1.0), np.inf).min(axis=1)
    slack = np.where(np.isfinite(slack), slack, 0.0)
    least = np.maximum(lengths - slack, 0.0)
    slowest = np.maximum(least[1:], least[:-1])
    fastest = np.minimum((lengths + slack)[1:], (lengths + slack)[:-1])
    time = np.where(slowest > 0, CORNER / np.where(slowest > 0, slowest, 1.0), np.inf)
    turn = np.abs(np.diff(directions, axis=0)) * fastest[:, None]
    allowed: Floats = np.minimum(limit * time[:, None], turn)
    return allowed


def finger_time(robot: RobotModel, before: float, after: float) -> float:
    """Seconds that the fingers need at least from one opening to another: by the limits of
    their joints, or where the URDF has none, by the robot file's time for a stroke."""
    gripper = robot.gripper
    limits = {joint.name: joint.velocity for joint in robot.urdf.joints.values()}
    ends = [gripper.joint_values(opening) for opening in _between(gripper.openings, before, after)]
    if not any(limits[name] > 0 for name in gripper.joints):
        stroke = gripper.max_opening - gripper.min_opening
        return abs(after - before) / stroke * gripper.time
    return sum(
        max(abs(float(b[name] - a[name])) / limits[name] for name in a if limits[name] > 0)
        for a, b in pairwise(ends)
    )


def _between(openings: Floats, before: float, after: float) -> list[float]:
    """Two openings, with those of a table that are between them."""
    low, high = sorted((before, after))
    return [low, *(o for o in openings.tolist() if low < o < high), high]


def finger_fault(robot: RobotModel, before: float, after: float, seconds: float) -> str | None:
    """What is wrong with fingers that go from one opening to another."""
    if (
        not robot.gripper.min_opening - LIMIT_SLACK
        <= after
        <= robot.gripper.max_opening + LIMIT_SLACK
    ):
        return f"the gripper cannot open {after:.4f} m"
    if finger_time(robot, before, after) > (seconds + TICK) * SPEED_SLACK + TICK:
        return "the fingers are faster than their limit"
    return None
