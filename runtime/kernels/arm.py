"""Forward kinematics, Jacobian and collision test of a serial chain on a fixed base.

A chain of n joints is two arrays: `origins` (n, 3, 4), the pose of each joint in the frame
before it, and `prismatic` (n,); every joint acts along its own z axis. Frame 0 is the base,
frame i + 1 moves with joint i. A `body` is parts fixed to frames: a box each (`frame` (m,),
`pose` (m, 3, 4), `half` (m, 3), `radius` (m,)), the index of its shape in `shapes` where it is
not exactly that box, and `pairs` (k, 2), the parts that can hit one another. `obstacles` are
those of `runtime.kernels.convex`. All in the base frame.

Boxes decide what boxes can: only where the boxes of a pair come near each other and one of the
two is not exactly its box is the distance of the solids asked for.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from runtime.kernels.boxes import gap_to_pose, gap_to_upright, pose_vs_pose, pose_vs_upright
from runtime.kernels.convex import TOLERANCE, gjk_distance, pose_of_row, solid_of


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
def gap_to_obstacle(body, b, pose, obstacles, w, near, enough, tolerance):  # type: ignore[no-untyped-def]
    """`gjk_distance` of part b of a body, placed at `pose`, and an obstacle."""
    row = obstacles.rows[w]
    there = obstacles.pose[w] if obstacles.shape[w] >= 0 else pose_of_row(row)
    return gjk_distance(
        solid_of(body.shape[b], body.shapes.solids, body.half[b]), body.shapes.vertices, pose,
        solid_of(obstacles.shape[w], obstacles.shapes.solids, row[3:6]),
        obstacles.shapes.vertices, there, near, enough, tolerance,
    )  # fmt: skip


@njit(cache=True)
def gap_between_parts(body, a, pose_a, b, pose_b, near, enough, tolerance):  # type: ignore[no-untyped-def]
    """`gjk_distance` of two placed parts of a body."""
    solids, vertices = body.shapes.solids, body.shapes.vertices
    return gjk_distance(
        solid_of(body.shape[a], solids, body.half[a]), vertices, pose_a,
        solid_of(body.shape[b], solids, body.half[b]), vertices, pose_b,
        near, enough, tolerance,
    )  # fmt: skip


@njit(cache=True)
def collides(chain, body, obstacles, margin, q, frames, placed):  # type: ignore[no-untyped-def]
    """Whether the arm at q comes within `margin` of an obstacle, or of itself; for two boxes:
    whether they touch when one of them is grown by it on every side.

    Parts of frame 0 do not move with the arm: they are not tested against obstacles here
    (the base pose is tested once, by `body_collides`). `frames` and `placed` are scratch.
    """
    forward(chain.origins, chain.prismatic, q, frames)
    place_boxes(frames, body.frame, body.pose, placed)
    if parts_collide(body, placed, obstacles, margin, 1):
        return True
    half, radius, pairs, shape = body.half, body.radius, body.pairs, body.shape
    for k in range(pairs.shape[0]):
        a = pairs[k, 0]
        b = pairs[k, 1]
        dx = placed[a, 0, 3] - placed[b, 0, 3]
        dy = placed[a, 1, 3] - placed[b, 1, 3]
        dz = placed[a, 2, 3] - placed[b, 2, 3]
        reach = radius[a] + radius[b] + margin
        if dx * dx + dy * dy + dz * dz < reach * reach and pose_vs_pose(
            placed[a], half[a], placed[b], half[b], margin
        ):
            if shape[a] < 0 and shape[b] < 0:
                return True
            gap = gap_between_parts(body, a, placed[a], b, placed[b], margin, margin, TOLERANCE)
            if gap <= margin:
                return True
    return False


@njit(cache=True)
def parts_collide(body, placed, obstacles, margin, first_frame):  # type: ignore[no-untyped-def]
    """The same for the placed parts of frames from `first_frame` on, against obstacles only."""
    frame, half, radius, shape = body.frame, body.half, body.radius, body.shape
    rows, shapes = obstacles.rows, obstacles.shape
    for b in range(frame.shape[0]):
        if frame[b] < first_frame:
            continue
        for w in range(rows.shape[0]):
            if pose_vs_upright(placed[b], half[b], radius[b], rows[w], margin):
                if shape[b] < 0 and shapes[w] < 0:
                    return True
                gap = gap_to_obstacle(body, b, placed[b], obstacles, w, margin, margin, TOLERANCE)
                if gap <= margin:
                    return True
    return False


@njit(cache=True)
def body_collides(body, placed, obstacles, margin):  # type: ignore[no-untyped-def]
    """The same for all placed parts, those of the base included."""
    return parts_collide(body, placed, obstacles, margin, 0)


COARSE = 0.1
"""Radians between the samples that look for gross contact, at least."""

FAR = 0.3
"""Metres of clearance beyond which nobody asks how much further away something is."""

OVER = 2.0
"""A time after the end of a line, which is at 1."""

CLOSE = 0.03
"""Metres between boxes below which it is worth while to ask for the distance of solids."""

ROUGH = 1e-4
"""Metres by which distances may be underestimated where a part only has to know how long it
stays free."""

TINY = 1e-9
TOGETHER = 0.02
"""What is due so soon after is looked at in one go, for the sake of the forward kinematics."""


@njit(cache=True)
def free_of_boxes(pose, half, radius, rows, margin, speed, left):  # type: ignore[no-untyped-def]
    """How long a placed box that moves with at most `speed` certainly stays free of upright
    boxes (w, 8), or -1 for contact now. Nobody asks for more time than is `left`."""
    # What is further away than the way that is left does not matter.
    enough = min(FAR, left * speed + margin)
    nearest = enough
    for w in range(rows.shape[0]):
        gap = gap_to_upright(pose, half, radius, rows[w], nearest)
        if gap < margin:
            if pose_vs_upright(pose, half, radius, rows[w], margin):
                return -1.0
            gap = margin
        nearest = min(nearest, gap)
    if nearest == enough and enough < FAR:
        return left
    return (nearest - 0.5 * margin) / max(speed, 1e-12)


@njit(cache=True)
def free_of_solids(body, b, pose, obstacles, margin, speed, left):  # type: ignore[no-untyped-def]
    """The same for part b of a body and obstacles, some of which are not boxes."""
    half, radius, shape = body.half[b], body.radius[b], body.shape[b]
    rows, shapes = obstacles.rows, obstacles.shape
    enough = min(FAR, left * speed + margin)
    nearest = enough
    for w in range(rows.shape[0]):
        gap = gap_to_upright(pose, half, radius, rows[w], nearest)
        exact = shape < 0 and shapes[w] < 0
        if not exact and gap < min(CLOSE, nearest):
            solids = gap_to_obstacle(body, b, pose, obstacles, w, margin, nearest, ROUGH)
            gap = max(gap, solids)
        if gap < margin:
            if not exact or pose_vs_upright(pose, half, radius, rows[w], margin):
                return -1.0
            gap = margin
        nearest = min(nearest, gap)
    if nearest == enough and enough < FAR:
        return left
    return (nearest - 0.5 * margin) / max(speed, 1e-12)


@njit(cache=True)
def free_of_each_other(  # type: ignore[no-untyped-def]
    pose_a, half_a, radius_a, pose_b, half_b, radius_b, margin, speed, left
):
    """The same for two placed boxes that move with at most `speed` relative to one another."""
    dx = pose_a[0, 3] - pose_b[0, 3]
    dy = pose_a[1, 3] - pose_b[1, 3]
    dz = pose_a[2, 3] - pose_b[2, 3]
    gap = math.sqrt(dx * dx + dy * dy + dz * dz) - radius_a - radius_b
    if gap >= left * speed + margin:
        return left
    if gap < FAR:
        gap = max(gap, gap_to_pose(pose_a, half_a, pose_b, half_b))
    if gap < margin:
        if pose_vs_pose(pose_a, half_a, pose_b, half_b, margin):
            return -1.0
        gap = margin
    return (gap - 0.5 * margin) / max(speed, 1e-12)


@njit(cache=True)
def solids_free_of_each_other(body, a, pose_a, b, pose_b, margin, speed, left):  # type: ignore[no-untyped-def]
    """The same for two parts of a body, one of which is not a box."""
    dx = pose_a[0, 3] - pose_b[0, 3]
    dy = pose_a[1, 3] - pose_b[1, 3]
    dz = pose_a[2, 3] - pose_b[2, 3]
    gap = math.sqrt(dx * dx + dy * dy + dz * dz) - body.radius[a] - body.radius[b]
    enough = left * speed + margin
    if gap >= enough:
        return left
    if gap < FAR:
        gap = max(gap, gap_to_pose(pose_a, body.half[a], pose_b, body.half[b]))
    if gap < min(CLOSE, enough):
        gap = max(gap, gap_between_parts(body, a, pose_a, b, pose_b, margin, enough, ROUGH))
    if gap < margin:
        return -1.0
    return (gap - 0.5 * margin) / max(speed, 1e-12)


@njit(cache=True)
def segment_collides(  # type: ignore[no-untyped-def]
    chain, body, obstacles, margin, sweep, start, dq, with_end, frames, placed, speed, until
):
    """Whether the straight line from `start` (n,) along `dq` comes within the margin of
    something at a sample; else all of it keeps half the margin. The start is a sample, and
    the end `with_end`; `frames`, `placed`, `speed` and `until` are scratch.

    Conservative advancement: a part whose gap to everything is g cannot touch anything before
    it has moved by g, and `sweep[f, i]` bounds how far a part of frame f moves for one unit of
    joint i. Every part (against the obstacles) and every pair of parts has its own `until`, the
    time to which it is known to be free, and is looked at again only then: neighbouring links,
    whose gaps are small, do not make everything else be tested at their pace.
    """
    frame, half, radius = body.frame, body.half, body.radius
    pairs, shape, rows = body.pairs, body.shape, obstacles.rows
    plain = not np.any(obstacles.shape >= 0)
    m = frame.shape[0]
    for b in range(m):
        speed[b] = 0.0
        for i in range(frame[b]):
            speed[b] += sweep[frame[b], i] * abs(dq[i])
        until[b] = 0.0 if frame[b] > 0 else OVER
    for k in range(pairs.shape[0]):
        one = frame[pairs[k, 0]]
        other = frame[pairs[k, 1]]
        speed[m + k] = 0.0
        for i in range(min(one, other), max(one, other)):
            speed[m + k] += sweep[max(one, other), i] * abs(dq[i])
        until[m + k] = 0.0
    while True:
        t = OVER
        for item in range(m + pairs.shape[0]):
            t = min(t, until[item])
        if t == OVER:
            return False
        forward(chain.origins, chain.prismatic, start + t * dq, frames)
        place_boxes(frames, frame, body.pose, placed)
        left = 1.0 - t
        for item in range(m + pairs.shape[0]):
            if until[item] > t + TOGETHER:
                continue
            if item < m and plain and shape[item] < 0:
                free = free_of_boxes(
                    placed[item], half[item], radius[item], rows, margin, speed[item], left
                )
            elif item < m:
                free = free_of_solids(
                    body, item, placed[item], obstacles, margin, speed[item], left
                )
            else:
                a = pairs[item - m, 0]
                b = pairs[item - m, 1]
                if shape[a] < 0 and shape[b] < 0:
                    free = free_of_each_other(
                        placed[a], half[a], radius[a], placed[b], half[b], radius[b],
                        margin, speed[item], left,
                    )  # fmt: skip
                else:
                    free = solids_free_of_each_other(
                        body, a, placed[a], b, placed[b], margin, speed[item], left
                    )
            if free < 0.0:
                return True
            if t + free < 1.0 - TINY:
                until[item] = t + free
            else:
                until[item] = 1.0 if with_end and t < 1.0 else OVER


@njit(cache=True)
def path_collides(chain, body, obstacles, margin, sweep, path):  # type: ignore[no-untyped-def]
    """Index of the first segment of a path (p, n) that comes within the margin of something
    at one of its samples, or -1: then the whole path keeps half the margin, in between too.
    """
    n = path.shape[1]
    items = body.frame.shape[0] + body.pairs.shape[0]
    frames = np.empty((n + 1, 3, 4))
    placed = np.empty((body.frame.shape[0], 3, 4))
    speed = np.empty(items)
    until = np.empty(items)
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
                    chain, body, obstacles, margin, path[k] + (j / parts) * dq, frames, placed
                ):
                    return k
            parts *= 2
    for k in range(path.shape[0] - 1):
        if segment_collides(
            chain, body, obstacles, margin, sweep, path[k], path[k + 1] - path[k],
            k == path.shape[0] - 2, frames, placed, speed, until,
        ):  # fmt: skip
            return k
    return -1
