"""Separating-axis test between boxes.

World boxes are upright (they turn about z only) and packed one a row:

    [cx, cy, cz, hx, hy, hz, cos yaw, sin yaw]     centre, half extents, heading

Robot boxes turn freely: a 3x4 pose and half extents.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.compiled import njit

PARALLEL = 1e-9
"""Added to absolute rotation entries so that near-parallel edges give no false axis."""


@njit(cache=True, inline="always")
def _between(a, b):  # type: ignore[no-untyped-def]
    """Rotation (row by row) and position of pose b in the frame of pose a."""
    dx = b[0, 3] - a[0, 3]
    dy = b[1, 3] - a[1, 3]
    dz = b[2, 3] - a[2, 3]
    tx = a[0, 0] * dx + a[1, 0] * dy + a[2, 0] * dz
    ty = a[0, 1] * dx + a[1, 1] * dy + a[2, 1] * dz
    tz = a[0, 2] * dx + a[1, 2] * dy + a[2, 2] * dz
    r00 = a[0, 0] * b[0, 0] + a[1, 0] * b[1, 0] + a[2, 0] * b[2, 0]
    r01 = a[0, 0] * b[0, 1] + a[1, 0] * b[1, 1] + a[2, 0] * b[2, 1]
    r02 = a[0, 0] * b[0, 2] + a[1, 0] * b[1, 2] + a[2, 0] * b[2, 2]
    r10 = a[0, 1] * b[0, 0] + a[1, 1] * b[1, 0] + a[2, 1] * b[2, 0]
    r11 = a[0, 1] * b[0, 1] + a[1, 1] * b[1, 1] + a[2, 1] * b[2, 1]
    r12 = a[0, 1] * b[0, 2] + a[1, 1] * b[1, 2] + a[2, 1] * b[2, 2]
    r20 = a[0, 2] * b[0, 0] + a[1, 2] * b[1, 0] + a[2, 2] * b[2, 0]
    r21 = a[0, 2] * b[0, 1] + a[1, 2] * b[1, 1] + a[2, 2] * b[2, 1]
    r22 = a[0, 2] * b[0, 2] + a[1, 2] * b[1, 2] + a[2, 2] * b[2, 2]
    return r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz


@njit(cache=True, inline="always")
def distance_squared(poses, a, x, y, z, hx, hy, hz, c, s):  # type: ignore[no-untyped-def]
    """The square of the distance from the middle of a free box, at the a-th of poses (m, 3, 4), to
    an upright box at x, y, z, with half extents hx, hy, hz, turned by an angle of cosine c and
    sine s: what most pairs are settled by, without a call for each."""
    dx = poses[a, 0, 3] - x
    dy = poses[a, 1, 3] - y
    ex = max(abs(c * dx + s * dy) - hx, 0.0)
    ey = max(abs(c * dy - s * dx) - hy, 0.0)
    ez = max(abs(poses[a, 2, 3] - z) - hz, 0.0)
    return ex * ex + ey * ey + ez * ez


@njit(cache=True)
def pose_vs_upright(pose, half, radius, box, margin):  # type: ignore[no-untyped-def]
    """Whether a free box touches an upright box grown by `margin` on every side.

    `radius` is the circumscribed radius of the free box: it settles most pairs cheaply.
    """
    # Centre of the free box in the frame of the upright one.
    dx = pose[0, 3] - box[0]
    dy = pose[1, 3] - box[1]
    c = box[6]
    s = box[7]
    tx = c * dx + s * dy
    ty = c * dy - s * dx
    tz = pose[2, 3] - box[2]
    bx = box[3] + margin
    by = box[4] + margin
    bz = box[5] + margin
    ex = max(abs(tx) - bx, 0.0)
    ey = max(abs(ty) - by, 0.0)
    ez = max(abs(tz) - bz, 0.0)
    if ex * ex + ey * ey + ez * ez > radius * radius:
        return False
    r00 = c * pose[0, 0] + s * pose[1, 0]
    r01 = c * pose[0, 1] + s * pose[1, 1]
    r02 = c * pose[0, 2] + s * pose[1, 2]
    r10 = c * pose[1, 0] - s * pose[0, 0]
    r11 = c * pose[1, 1] - s * pose[0, 1]
    r12 = c * pose[1, 2] - s * pose[0, 2]
    return _overlap(
        r00, r01, r02, r10, r11, r12, pose[2, 0], pose[2, 1], pose[2, 2],
        tx, ty, tz, bx, by, bz, half[0], half[1], half[2],
    )  # fmt: skip


@njit(cache=True)
def pose_vs_pose(a, half_a, b, half_b, margin):  # type: ignore[no-untyped-def]
    """Whether two free boxes touch, the first grown by `margin` on every side."""
    r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz = _between(a, b)
    return _overlap(
        r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz,
        half_a[0] + margin, half_a[1] + margin, half_a[2] + margin,
        half_b[0], half_b[1], half_b[2],
    )  # fmt: skip


@njit(cache=True, inline="always")
def _overlap(  # type: ignore[no-untyped-def]
    r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz, ax, ay, az, bx, by, bz
):
    """The fifteen axes (Gottschalk et al. 1996) for box B turned by r, moved by t, in A."""
    a00, a01, a02 = abs(r00) + PARALLEL, abs(r01) + PARALLEL, abs(r02) + PARALLEL
    a10, a11, a12 = abs(r10) + PARALLEL, abs(r11) + PARALLEL, abs(r12) + PARALLEL
    a20, a21, a22 = abs(r20) + PARALLEL, abs(r21) + PARALLEL, abs(r22) + PARALLEL
    if abs(tx) > ax + bx * a00 + by * a01 + bz * a02:
        return False
    if abs(ty) > ay + bx * a10 + by * a11 + bz * a12:
        return False
    if abs(tz) > az + bx * a20 + by * a21 + bz * a22:
        return False
    if abs(tx * r00 + ty * r10 + tz * r20) > bx + ax * a00 + ay * a10 + az * a20:
        return False
    if abs(tx * r01 + ty * r11 + tz * r21) > by + ax * a01 + ay * a11 + az * a21:
        return False
    if abs(tx * r02 + ty * r12 + tz * r22) > bz + ax * a02 + ay * a12 + az * a22:
        return False
    if abs(tz * r10 - ty * r20) > ay * a20 + az * a10 + by * a02 + bz * a01:
        return False
    if abs(tz * r11 - ty * r21) > ay * a21 + az * a11 + bx * a02 + bz * a00:
        return False
    if abs(tz * r12 - ty * r22) > ay * a22 + az * a12 + bx * a01 + by * a00:
        return False
    if abs(tx * r20 - tz * r00) > ax * a20 + az * a00 + by * a12 + bz * a11:
        return False
    if abs(tx * r21 - tz * r01) > ax * a21 + az * a01 + bx * a12 + bz * a10:
        return False
    if abs(tx * r22 - tz * r02) > ax * a22 + az * a02 + bx * a11 + by * a10:
        return False
    if abs(ty * r00 - tx * r10) > ax * a10 + ay * a00 + by * a22 + bz * a21:
        return False
    if abs(ty * r01 - tx * r11) > ax * a11 + ay * a01 + bx * a22 + bz * a20:
        return False
    return not abs(ty * r02 - tx * r12) > ax * a12 + ay * a02 + bx * a21 + by * a20


@njit(cache=True)
def gap_to_upright(pose, half, radius, box, enough):  # type: ignore[no-untyped-def]
    """A lower bound on the distance from a free box to an upright box, negative or zero
    where they may touch; any bound of at least `enough` will do for the caller.

    The circumscribed sphere settles most pairs; else the widest gap along a face normal of
    either box is a bound, and exactly the separating-axis test tells 0 from contact.
    """
    dx = pose[0, 3] - box[0]
    dy = pose[1, 3] - box[1]
    c = box[6]
    s = box[7]
    tx = c * dx + s * dy
    ty = c * dy - s * dx
    tz = pose[2, 3] - box[2]
    ex = max(abs(tx) - box[3], 0.0)
    ey = max(abs(ty) - box[4], 0.0)
    ez = max(abs(tz) - box[5], 0.0)
    squared = ex * ex + ey * ey + ez * ez
    if squared > (radius + enough) * (radius + enough):
        return enough
    r00 = c * pose[0, 0] + s * pose[1, 0]
    r01 = c * pose[0, 1] + s * pose[1, 1]
    r02 = c * pose[0, 2] + s * pose[1, 2]
    r10 = c * pose[1, 0] - s * pose[0, 0]
    r11 = c * pose[1, 1] - s * pose[0, 1]
    r12 = c * pose[1, 2] - s * pose[0, 2]
    gap = _face_gap(
        r00, r01, r02, r10, r11, r12, pose[2, 0], pose[2, 1], pose[2, 2],
        tx, ty, tz, box[3], box[4], box[5], half[0], half[1], half[2],
    )  # fmt: skip
    return max(gap, math.sqrt(squared) - radius)


@njit(cache=True)
def gap_to_pose(a, half_a, b, half_b):  # type: ignore[no-untyped-def]
    """The same bound for two free boxes, by the face normals of both."""
    r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz = _between(a, b)
    return _face_gap(
        r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz,
        half_a[0], half_a[1], half_a[2], half_b[0], half_b[1], half_b[2],
    )  # fmt: skip


@njit(cache=True, inline="always")
def _face_gap(  # type: ignore[no-untyped-def]
    r00, r01, r02, r10, r11, r12, r20, r21, r22, tx, ty, tz, ax, ay, az, bx, by, bz
):
    """The widest gap along the six face normals, a lower bound on the distance."""
    gap = abs(tx) - ax - bx * abs(r00) - by * abs(r01) - bz * abs(r02)
    gap = max(gap, abs(ty) - ay - bx * abs(r10) - by * abs(r11) - bz * abs(r12))
    gap = max(gap, abs(tz) - az - bx * abs(r20) - by * abs(r21) - bz * abs(r22))
    gap = max(
        gap,
        abs(tx * r00 + ty * r10 + tz * r20) - bx - ax * abs(r00) - ay * abs(r10) - az * abs(r20),
    )
    gap = max(
        gap,
        abs(tx * r01 + ty * r11 + tz * r21) - by - ax * abs(r01) - ay * abs(r11) - az * abs(r21),
    )
    return max(
        gap,
        abs(tx * r02 + ty * r12 + tz * r22) - bz - ax * abs(r02) - ay * abs(r12) - az * abs(r22),
    )


@njit(cache=True)
def within_reach(world, x, y, reach):  # type: ignore[no-untyped-def]
    """Indices of the upright boxes (w, 8) within `reach`, in the plane, of a position."""
    found = np.empty(world.shape[0], dtype=np.int64)
    count = 0
    for i in range(world.shape[0]):
        dx = world[i, 0] - x
        dy = world[i, 1] - y
        # Distance from the position to the footprint of the box.
        lx = max(abs(world[i, 6] * dx + world[i, 7] * dy) - world[i, 3], 0.0)
        ly = max(abs(world[i, 6] * dy - world[i, 7] * dx) - world[i, 4], 0.0)
        if lx * lx + ly * ly <= reach * reach:
            found[count] = i
            count += 1
    return found[:count]


@njit(cache=True)
def to_base_frame(world, x, y, yaw, reach):  # type: ignore[no-untyped-def]
    """The upright boxes within `reach` (in the plane) of a base pose, in the base frame."""
    near = within_reach(world, x, y, reach)
    c = math.cos(yaw)
    s = math.sin(yaw)
    out = np.empty((near.shape[0], 8))
    for k in range(near.shape[0]):
        i = near[k]
        dx = world[i, 0] - x
        dy = world[i, 1] - y
        out[k, 0] = c * dx + s * dy
        out[k, 1] = c * dy - s * dx
        out[k, 2:6] = world[i, 2:6]
        out[k, 6] = c * world[i, 6] + s * world[i, 7]
        out[k, 7] = c * world[i, 7] - s * world[i, 6]
    return out
