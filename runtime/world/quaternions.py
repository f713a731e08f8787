"""Poses as seven numbers, as files hold them: x, y, z and a unit quaternion x, y, z, w."""

from __future__ import annotations

import numpy as np

from runtime.world.poses import Floats


def matrix(pose: Floats) -> Floats:
    """A pose x, y, z, quaternion x, y, z, w (7,) as a matrix (4, 4)."""
    x, y, z, w = pose[3:]
    out = np.eye(4)
    out[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    out[:3, 3] = pose[:3]
    return out


def pose_of(transform: Floats) -> Floats:
    """A rigid transform (4, 4) or (3, 4) as x, y, z, quaternion x, y, z, w (7,)."""
    r = transform[:3, :3]
    # The largest of the four squares: none of the divisions is by something small.
    squares = np.array(
        [
            1 + r[0, 0] - r[1, 1] - r[2, 2],
            1 - r[0, 0] + r[1, 1] - r[2, 2],
            1 - r[0, 0] - r[1, 1] + r[2, 2],
            1 + r[0, 0] + r[1, 1] + r[2, 2],
        ]
    )
    rows = [
        [squares[0], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]],
        [r[0, 1] + r[1, 0], squares[1], r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]],
        [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], squares[2], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], squares[3]],
    ]
    quaternion = np.array(rows[int(squares.argmax())])
    quaternion /= np.linalg.norm(quaternion)
    if quaternion[3] < 0:
        quaternion = -quaternion
    return np.concatenate([transform[:3, 3], quaternion])


def between(a: Floats, b: Floats, share: float) -> Floats:
    """The pose (7,) between two: positions on a line, the nearer rotation."""
    near = b if a[3:] @ b[3:] >= 0 else np.concatenate([b[:3], -b[3:]])
    mixed: Floats = a + share * (near - a)
    mixed[3:] /= np.linalg.norm(mixed[3:])
    return mixed
