"""When the robot is where: fastest trajectories along given paths within the limits.

Arm paths are followed exactly, with the velocity and acceleration limits of every joint. The
speed along the path is bounded by the joints' velocities, at the corners by what their
accelerations can turn within a corner's neighbourhood, and in between by speeding up and
slowing down as hard as the tightest joint allows: one pass forwards and one backwards, as in
time-optimal path parametrisation (Bobrow et al. 1985, Pham 2014), closed form on each line.
The base turns and drives from rest to rest.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from runtime.motion.motion import ArmMove, BaseMove, Carried, GripperMove, Motion, Piece
from runtime.plan.model import TimedPiece
from runtime.robot.model import Floats, RobotModel
from runtime.world.quaternions import between

BLEND = 0.02
"""Radians of path around a corner within which the joints change their velocities: what a
controller rounds off, some tenths of a millimetre at the hand."""

SHORT = 2e-3
"""Seconds; way points that are closer in time are one."""

FINGER_RAMP = 0.2
"""Share of a gripper piece in which the fingers speed up, and again slow down."""

STEP = 0.1
"""Seconds between the way points of a timed arm path, at most."""


def trapezoid(distance: float, velocity: float, acceleration: float) -> float:
    """Seconds for a distance from rest to rest."""
    if distance <= 0.0:
        return 0.0
    if distance * acceleration < velocity * velocity:
        return 2.0 * math.sqrt(distance / acceleration)
    return distance / velocity + velocity / acceleration


def timed_motion(
    robot: RobotModel, motion: Motion, opening: float
) -> tuple[tuple[TimedPiece, ...], float]:
    """The pieces of a motion with their times, and how far the fingers are open then, who were
    `opening` metres apart before."""
    found = []
    for piece in motion:
        found.append(TimedPiece(*timed(robot, piece, opening)))
        if isinstance(piece, GripperMove):
            opening = piece.opening
    return tuple(found), opening


def finger_time(robot: RobotModel, before: float, after: float) -> float:
    """Seconds that the fingers take at full speed from one opening to another, by the limits of
    their joints; where these have none, by the time that the robot file gives for a stroke."""
    gripper = robot.gripper
    marks = gripper.openings
    speeds = np.array([max(0.0, _velocity(robot, name)) for name in gripper.joints])
    if not speeds.any():
        marks, seconds = marks[[0, -1]], np.array([0.0, gripper.time])
    else:
        moved = np.abs(np.diff(gripper.values, axis=0))[:, speeds > 0] / speeds[speeds > 0]
        seconds = np.concatenate([[0.0], np.cumsum(moved.max(axis=1))])
    return float(abs(np.interp(after, marks, seconds) - np.interp(before, marks, seconds)))


def _velocity(robot: RobotModel, name: str) -> float:
    joint = robot.urdf.joint(name)
    return 0.0 if joint is None else joint.velocity


def timed(robot: RobotModel, piece: Piece, opening: float) -> tuple[Piece, Floats]:
    """A piece and the seconds from its start at each of its way points (k,), the first 0; the
    fingers are `opening` metres apart before it.

    Arm paths come back with further way points on the same lines, dense enough in time for
    linear interpolation between them.
    """
    match piece:
        case BaseMove(poses, _):
            durations = [_base_duration(robot, a, b) for a, b in pairwise(poses)]
        case ArmMove(path, kind, along, pace):
            limits = robot.velocity * pace, robot.acceleration * pace**2
            points, times, places = _time_path(path, *limits)
            return ArmMove(points, kind, tuple(_carried(c, places) for c in along), pace), times
        case GripperMove(goal):
            stroke = finger_time(robot, opening, goal) / (1 - FINGER_RAMP)
            durations = [max(robot.gripper.time, stroke)]
    return piece, np.concatenate([[0.0], np.cumsum(durations)])


def _base_duration(robot: RobotModel, a: Floats, b: Floats) -> float:
    base = robot.base
    drive = trapezoid(math.hypot(b[0] - a[0], b[1] - a[1]), base.velocity, base.acceleration)
    turn = trapezoid(abs(b[2] - a[2]), base.angular_velocity, base.angular_acceleration)
    return max(drive, turn)


def _carried(carried: Carried, places: Floats) -> Carried:
    """A carried body at places (k,) along the way points, counted from 0."""
    last = len(carried.poses) - 1
    rows = []
    for place in places:
        i = min(int(place), max(0, last - 1))
        rows.append(between(carried.poses[i], carried.poses[min(i + 1, last)], place - i))
    return Carried(carried.body, np.array(rows))


def time_path(path: Floats, velocity: Floats, acceleration: Floats) -> tuple[Floats, Floats]:
    """Way points (k, n) along a polyline (p, n) and their times (k,), from rest to rest.

    Limits (n,) are those of the joints; lengths are joint-space distances.
    """
    points, times, _ = _time_path(path, velocity, acceleration)
    return points, times


def _time_path(
    path: Floats, velocity: Floats, acceleration: Floats
) -> tuple[Floats, Floats, Floats]:
    """The same, and where the new way points (k,) are among the old: 1.5 is half way from the
    second to the third."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    keep = np.concatenate([[True], lengths > 1e-9])
    number = np.flatnonzero(keep).astype(np.float64)
    path, lengths = path[keep], lengths[keep[1:]]
    if not len(lengths):
        return np.vstack([path, path]), np.zeros(2), np.zeros(2)
    directions = np.diff(path, axis=0) / lengths[:, None]
    with np.errstate(divide="ignore"):
        fastest = (velocity / np.abs(directions)).min(axis=1)
        hardest = (acceleration / np.abs(directions)).min(axis=1)
    speeds = _speeds(directions, lengths, fastest, hardest, acceleration)
    points, times, places, now = [path[0]], [0.0], [0.0], 0.0
    for i, length in enumerate(lengths):
        first, last = speeds[i], speeds[i + 1]
        seconds, travelled = _along(length, first, last, fastest[i], hardest[i])
        points += [path[i] + s * directions[i] for s in travelled]
        times += [now + t for t in seconds]
        places += [number[i] + (number[i + 1] - number[i]) * s / length for s in travelled]
        points[-1], places[-1] = path[i + 1], number[i + 1]
        now = times[-1]
    return np.array(points), np.array(times), np.array(places)


def _speeds(
    directions: Floats, lengths: Floats, fastest: Floats, hardest: Floats, acceleration: Floats
) -> Floats:
    """Speeds along the path at its corners, the first and the last 0."""
    speeds = np.zeros(len(lengths) + 1)
    for i in range(1, len(lengths)):
        turn = np.abs(directions[i] - directions[i - 1])
        room = min(lengths[i - 1], lengths[i], BLEND)
        with np.errstate(divide="ignore"):
            corner = math.sqrt(float((acceleration * room / turn).min()))
        speeds[i] = min(corner, fastest[i - 1], fastest[i])
    for i in range(len(lengths)):
        reached = math.sqrt(speeds[i] ** 2 + 2 * hardest[i] * lengths[i])
        speeds[i + 1] = min(speeds[i + 1], reached)
    for i in range(len(lengths) - 1, -1, -1):
        reached = math.sqrt(speeds[i + 1] ** 2 + 2 * hardest[i] * lengths[i])
        speeds[i] = min(speeds[i], reached)
    return speeds


def _along(
    length: float, first: float, last: float, fastest: float, hardest: float
) -> tuple[list[float], list[float]]:
    """Times and distances along one line, from speed `first` to speed `last`: speed up,
    keep the speed, slow down."""
    peak = min(fastest, math.sqrt((2 * hardest * length + first**2 + last**2) / 2))
    peak = max(peak, first, last)
    up, down = (peak - first) / hardest, (peak - last) / hardest
    covered = (peak**2 - first**2 + peak**2 - last**2) / (2 * hardest)
    level = max(0.0, length - covered) / peak
    total = up + level + down
    count = max(1, math.ceil(total / STEP))
    marks = sorted([*(total * i / count for i in range(1, count)), up, up + level])
    seconds = [b for a, b in pairwise([0.0, *marks]) if b - a > SHORT and total - b > SHORT]
    seconds.append(total)
    travelled = []
    for t in seconds:
        if t <= up:
            s = first * t + hardest * t * t / 2
        elif t <= up + level:
            s = (peak**2 - first**2) / (2 * hardest) + peak * (t - up)
        else:
            s = length - (last * (total - t) + hardest * (total - t) ** 2 / 2)
        travelled.append(s)
    return seconds, travelled


def duration(robot: RobotModel, motion: Motion) -> float:
    """Seconds that a motion takes."""
    pieces, _ = timed_motion(robot, motion, robot.gripper.max_opening)
    return float(sum(piece.times[-1] for piece in pieces))
