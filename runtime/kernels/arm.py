"""Forward kinematics, Jacobian and collision test of a serial chain on a fixed base.

A chain of n joints is two arrays: `origins` (n, 3, 4), the pose of each joint in the frame
before it, and `prismatic` (n,); every joint acts along its own z axis. Frame 0 is the base,
frame i + 1 moves with joint i. A body is boxes fixed to frames: `box_frame` (m,),
`box_pose` (m, 3, 4), `box_half` (m, 3), `box_radius` (m,), and `pairs` (k, 2), the boxes
that can hit one another. All in the base frame.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from runtime.kernels.boxes import pose_vs_pose, pose_vs_upright


@njit(cache=True, inline="always")
def _compose(a, b, out):  # type: ignore[no-untyped-def]
    for i in range(3):
        for j in range(4):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]
        out[i, 3] += a[i, 3]


@njit(cache=True)
def forward(origins, prismatic, q, frames):  # type: ignore[no-untyped-def]
    """Write the pose of every frame (n + 1, 3, 4) for joint positions q (n,)."""
    for i in range(3):
        for j in range(4):
            frames[0, i, j] = 1.0 if i == j else 0.0
    for k in range(q.shape[0]):
        before = frames[k]
        after = frames[k + 1]
        _compose(before, origins[k], after)
        if prismatic[k]:
            for i in range(3):
                after[i, 3] += after[i, 2] * q[k]
        else:
            c = math.cos(q[k])
            s = math.sin(q[k])
            for i in range(3):
                x = after[i, 0]
                y = after[i, 1]
                after[i, 0] = c * x + s * y
                after[i, 1] = c * y - s * x


@njit(cache=True)
def place_boxes(frames, box_frame, box_pose, out):  # type: ignore[no-untyped-def]
    """Write the poses of the boxes (m, 3, 4) for given frames."""
    for b in range(box_frame.shape[0]):
        _compose(frames[box_frame[b]], box_pose[b], out[b])


@njit(cache=True)
def jacobian(frames, prismatic, point, out):  # type: ignore[no-untyped-def]
    """Write the geometric Jacobian (6, n) of a point that moves with the last frame:
    rows 0-2 linear, rows 3-5 angular velocity, in the base frame."""
    for k in range(prismatic.shape[0]):
        axis = frames[k + 1, :, 2]
        if prismatic[k]:
            for i in range(3):
                out[i, k] = axis[i]
                out[3 + i, k] = 0.0
        else:
            dx = point[0] - frames[k + 1, 0, 3]
            dy = point[1] - frames[k + 1, 1, 3]
            dz = point[2] - frames[k + 1, 2, 3]
            out[0, k] = axis[1] * dz - axis[2] * dy
            out[1, k] = axis[2] * dx - axis[0] * dz
            out[2, k] = axis[0] * dy - axis[1] * dx
            for i in range(3):
                out[3 + i, k] = axis[i]




@njit(cache=True)
def collides(  # type: ignore[no-untyped-def]
    origins, prismatic, box_frame, box_pose, box_half, box_radius, pairs, world, margin,
    q, frames, placed,
):  # fmt: skip
    """Whether the arm at q touches the world (w, 8) grown by `margin`, or itself.

    Boxes of frame 0 do not move with the arm: they are not tested against the world here
    (the base pose is tested once, by `body_collides`). `frames` and `placed` are scratch.
    """
    forward(origins, prismatic, q, frames)
    place_boxes(frames, box_frame, box_pose, placed)
    for b in range(box_frame.shape[0]):
        if box_frame[b] == 0:
            continue
        for w in range(world.shape[0]):
            if pose_vs_upright(placed[b], box_half[b], box_radius[b], world[w], margin):
                return True
    for k in range(pairs.shape[0]):
        a = pairs[k, 0]
        b = pairs[k, 1]
        dx = placed[a, 0, 3] - placed[b, 0, 3]
        dy = placed[a, 1, 3] - placed[b, 1, 3]
        dz = placed[a, 2, 3] - placed[b, 2, 3]
        reach = box_radius[a] + box_radius[b] + margin
        if dx * dx + dy * dy + dz * dz < reach * reach and pose_vs_pose(
            placed[a], box_half[a], placed[b], box_half[b], margin
        ):
            return True
    return False


@njit(cache=True)
def body_collides(placed, box_half, box_radius, world, margin):  # type: ignore[no-untyped-def]
    """Whether any placed box, those of the base included, touches the world."""
    for b in range(placed.shape[0]):
        for w in range(world.shape[0]):
            if pose_vs_upright(placed[b], box_half[b], box_radius[b], world[w], margin):
                return True
    return False


@njit(cache=True)
def path_collides(  # type: ignore[no-untyped-def]
    origins, prismatic, box_frame, box_pose, box_half, box_radius, pairs, world, margin,
    reach, path, resolution,
):  # fmt: skip
    """Index of the first segment of a path (p, n) that touches something, or -1.

    `reach[i]` bounds how far any point of the body moves for a unit of joint i, so between
    two samples nothing moves further than `resolution`: with resolution <= 2 margin a
    segment that passes is free in between, too.
    """
    frames = np.empty((origins.shape[0] + 1, 3, 4))
    placed = np.empty((box_frame.shape[0], 3, 4))
    for k in range(path.shape[0] - 1):
        travel = 0.0
        for i in range(reach.shape[0]):
            travel += reach[i] * abs(path[k + 1, i] - path[k, i])
        steps = max(1, int(math.ceil(travel / resolution)))
        first = 0 if k == 0 else 1
        for j in range(first, steps + 1):
            t = j / steps
            if collides(
                origins, prismatic, box_frame, box_pose, box_half, box_radius, pairs, world,
                margin, path[k] + t * (path[k + 1] - path[k]), frames, placed,
            ):  # fmt: skip
                return k
    return -1
