"""Forward kinematics, Jacobian and collision test of a serial chain on a fixed base; motions are
tested in `runtime.kernels.advance`.

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

from runtime.kernels.boxes import distance_squared, pose_vs_pose, pose_vs_upright
from runtime.kernels.compiled import njit
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
    for w in range(rows.shape[0]):
        x, y, z, c, s = rows[w, 0], rows[w, 1], rows[w, 2], rows[w, 6], rows[w, 7]
        hx, hy, hz = rows[w, 3] + margin, rows[w, 4] + margin, rows[w, 5] + margin
        for b in range(frame.shape[0]):
            if (
                frame[b] >= first_frame
                and distance_squared(placed, b, x, y, z, hx, hy, hz, c, s) <= radius[b] * radius[b]
                and pose_vs_upright(placed[b], half[b], radius[b], rows[w], margin)
            ):
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


CLOSE = 0.03
"""Metres between boxes below which it is worth while to ask for the distance of solids."""

ROUGH = 1e-4
"""Metres by which distances may be underestimated where a part only has to know how long it
stays free."""
