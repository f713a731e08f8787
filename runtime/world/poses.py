"""Rigid poses: 3x4 matrices [R | t], metres and radians."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

Pose = NDArray[np.float64]
"""A 3x4 matrix [R | t]."""


def identity() -> Pose:
    """The pose that changes nothing."""
    return np.eye(3, 4)


def compose(a: Pose, b: Pose) -> Pose:
    """The pose `a b` of 3x4 matrices."""
    out = np.empty((3, 4))
    out[:, :3] = a[:, :3] @ b[:, :3]
    out[:, 3] = a[:, :3] @ b[:, 3] + a[:, 3]
    return out


def invert(pose: Pose) -> Pose:
    """The inverse of a 3x4 pose."""
    out = np.empty((3, 4))
    out[:, :3] = pose[:, :3].T
    out[:, 3] = -out[:, :3] @ pose[:, 3]
    return out


def apply(pose: Pose, points: Floats) -> Floats:
    """Points (n, 3) of the pose's frame in the frame that the pose is given in."""
    moved: Floats = points @ pose[:, :3].T + pose[:, 3]
    return moved


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Floats:
    """Fixed-axis roll, pitch, yaw (as in URDF) as a rotation matrix (3, 3)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def upright(x: float, y: float, z: float, yaw: float) -> Pose:
    """The pose of something that is turned about z only."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0, x], [s, c, 0.0, y], [0.0, 0.0, 1.0, z]])


def heading(pose: Pose) -> float:
    """The angle by which a pose turns x about z, radians; for poses turned about z only."""
    return math.atan2(pose[1, 0], pose[0, 0])
