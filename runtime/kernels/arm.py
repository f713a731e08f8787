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

from runtime.kernels.boxes import gap_to_pose, gap_to_upright, pose_vs_pose, pose_vs_upright


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


COARSE = 0.05
"""Radians between the samples that look for gross contact, at least."""

FAR = 0.3
"""Metres of clearance beyond which nobody asks how much further away something is."""


@njit(cache=True)
def free_until(  # type: ignore[no-untyped-def]
    origins, prismatic, box_frame, box_pose, box_half, box_radius, pairs, world, margin,
    sweep, q0, dq, t, frames, placed, speeds,
):  # fmt: skip
    """How far the line q0 + t dq is certainly free from t on, or -1 for contact at t.

    Conservative advancement: a box whose gap to everything is g cannot touch anything
    before it has moved by g, and `sweep[f, i]` bounds how far a box of frame f moves for
    one unit of joint i. Contact means a gap below `margin`; between the values returned,
    the gap stays above half of it.
    """
    n = q0.shape[0]
    forward(origins, prismatic, q0 + t * dq, frames)
    place_boxes(frames, box_frame, box_pose, placed)
    for f in range(n + 1):
        speeds[f] = 0.0
        for i in range(f):
            speeds[f] += sweep[f, i] * abs(dq[i])
    advance = 1e9
    for b in range(box_frame.shape[0]):
        frame = box_frame[b]
        if frame == 0:
            continue
        # What is further away than the way that is left does not matter.
        enough = min(FAR, (1.0 - t) * speeds[frame] + margin)
        for w in range(world.shape[0]):
            gap = gap_to_upright(placed[b], box_half[b], box_radius[b], world[w], enough)
            if gap >= enough:
                if enough == FAR:
                    advance = min(advance, (FAR - 0.5 * margin) / max(speeds[frame], 1e-12))
                continue
            if gap < margin:
                if pose_vs_upright(placed[b], box_half[b], box_radius[b], world[w], margin):
                    return -1.0
                gap = margin
            advance = min(advance, (gap - 0.5 * margin) / max(speeds[frame], 1e-12))
    for k in range(pairs.shape[0]):
        a = pairs[k, 0]
        b = pairs[k, 1]
        low = min(box_frame[a], box_frame[b])
        high = max(box_frame[a], box_frame[b])
        speed = 0.0
        for i in range(low, high):
            speed += sweep[high, i] * abs(dq[i])
        dx = placed[a, 0, 3] - placed[b, 0, 3]
        dy = placed[a, 1, 3] - placed[b, 1, 3]
        dz = placed[a, 2, 3] - placed[b, 2, 3]
        enough = min(FAR, (1.0 - t) * speed + margin)
        reach = box_radius[a] + box_radius[b] + enough
        if dx * dx + dy * dy + dz * dz >= reach * reach:
            if enough == FAR:
                advance = min(advance, (FAR - 0.5 * margin) / max(speed, 1e-12))
            continue
        gap = gap_to_pose(placed[a], box_half[a], placed[b], box_half[b])
        gap = max(gap, math.sqrt(dx * dx + dy * dy + dz * dz) - box_radius[a] - box_radius[b])
        if gap < margin:
            if pose_vs_pose(placed[a], box_half[a], placed[b], box_half[b], margin):
                return -1.0
            gap = margin
        advance = min(advance, (gap - 0.5 * margin) / max(speed, 1e-12))
    return advance


@njit(cache=True)
def path_collides(  # type: ignore[no-untyped-def]
    origins, prismatic, box_frame, box_pose, box_half, box_radius, pairs, world, margin,
    sweep, path,
):  # fmt: skip
    """Index of the first segment of a path (p, n) that comes within the margin of something
    at one of its samples, or -1: then the whole path keeps half the margin, in between too.
    """
    n = path.shape[1]
    frames = np.empty((n + 1, 3, 4))
    placed = np.empty((box_frame.shape[0], 3, 4))
    speeds = np.empty(n + 1)
    # Most paths that fail do so grossly: a few samples, the middle first, find them.
    for k in range(path.shape[0] - 1):
        dq = path[k + 1] - path[k]
        longest = 0.0
        for i in range(n):
            longest = max(longest, abs(dq[i]))
        parts = 2
        while parts <= 16 and longest / parts > COARSE:
            for j in range(1, parts, 2):
                if collides(
                    origins, prismatic, box_frame, box_pose, box_half, box_radius, pairs,
                    world, margin, path[k] + (j / parts) * dq, frames, placed,
                ):  # fmt: skip
                    return k
            parts *= 2
    for k in range(path.shape[0] - 1):
        dq = path[k + 1] - path[k]
        t = 0.0
        while True:
            advance = free_until(
                origins, prismatic, box_frame, box_pose, box_half, box_radius, pairs, world,
                margin, sweep, path[k], dq, t, frames, placed, speeds,
            )  # fmt: skip
            if advance < 0.0:
                return k
            if t >= 1.0:
                break
            t = min(1.0, t + advance)
    return -1
