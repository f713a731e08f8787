"""When the robot is where: trapezoidal speed along each straight piece of a motion.

Every straight line, in joint space or on the floor, starts and ends at rest and keeps the
velocity and acceleration limits of every joint.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from runtime.motion.motion import ArmMove, BaseMove, GripperMove, Motion, Piece
from runtime.robot.model import Floats, RobotModel


def trapezoid(distance: float, velocity: float, acceleration: float) -> float:
    """Seconds for a distance from rest to rest."""
    if distance <= 0.0:
        return 0.0
    if distance * acceleration < velocity * velocity:
        return 2.0 * math.sqrt(distance / acceleration)
    return distance / velocity + velocity / acceleration


def times(robot: RobotModel, piece: Piece) -> Floats:
    """Seconds from the start of a piece at each of its way points (k,), the first 0."""
    match piece:
        case BaseMove(poses):
            durations = [_base_duration(robot, a, b) for a, b in pairwise(poses)]
        case ArmMove(path, _):
            durations = [_arm_duration(robot, a, b) for a, b in pairwise(path)]
        case GripperMove():
            durations = [robot.gripper.time]
    return np.concatenate([[0.0], np.cumsum(durations)])


def _arm_duration(robot: RobotModel, a: Floats, b: Floats) -> float:
    step = np.abs(b - a)
    moving = step > 1e-12
    if not moving.any():
        return 0.0
    # The line is s in [0, 1]; the tightest joint limits the speed of s.
    velocity = float((robot.velocity[moving] / step[moving]).min())
    acceleration = float((robot.acceleration[moving] / step[moving]).min())
    return trapezoid(1.0, velocity, acceleration)


def _base_duration(robot: RobotModel, a: Floats, b: Floats) -> float:
    base = robot.base
    drive = trapezoid(math.hypot(b[0] - a[0], b[1] - a[1]), base.velocity, base.acceleration)
    turn = trapezoid(abs(b[2] - a[2]), base.angular_velocity, base.angular_acceleration)
    return max(drive, turn)


def duration(robot: RobotModel, motion: Motion) -> float:
    """Seconds that a motion takes."""
    return float(sum(times(robot, piece)[-1] for piece in motion))
