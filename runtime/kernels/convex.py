"""Distances between convex solids: GJK (Gilbert, Johnson & Keerthi 1988).

Solids are packed one a row, as a core and a rounding radius around it:

    [BOX, hx, hy, hz, rounding, 0, 0]                   half extents
    [CYLINDER, radius, 0, half height, rounding, 0, 0]
    [HULL, 0, 0, 0, rounding, first, count]             of the vertices of the table

A sphere is a box without extent and its radius, a capsule a box that extends along z only.

Every answer is a *lower bound*: the support points of a direction bound the distance from
below whatever the direction is, so neither rounding nor an early end of the iteration can
make a solid look further away than it is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runtime.kernels.boxes import to_base_frame, within_reach
from runtime.kernels.compiled import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BOX = 0
CYLINDER = 1
HULL = 2

EXACT = -1
"""The index of the shape of what is exactly the box that it is packed as."""

ITERATIONS = 60
TOLERANCE = 1e-7
"""Metres between the bounds at which the iteration ends where nobody asks for less."""

NOTHING = 1e-10
"""Metres: cores that are nearer touch."""

FLAT = 1e-12
"""A tetrahedron whose volume is less than this part of the product of its edges is flat."""


class Shapes(NamedTuple):
    """A table of solids, packed as the top of this file says."""

    solids: Floats  # (s, 7)
    vertices: Floats  # (v, 3)


class Obstacles(NamedTuple):
    """What stands around: the smallest upright box around each solid, packed as in
    `runtime.kernels.boxes`, the index of its shape or EXACT, and its pose where it has one."""

    rows: Floats  # (w, 8)
    shape: Ints  # (w,)
    pose: Floats  # (w, 3, 4)
    shapes: Shapes


NO_SHAPES = Shapes(np.empty((0, 7)), np.empty((0, 3)))


def boxes_only(rows: Floats) -> Obstacles:
    """Upright boxes (w, 8) as obstacles: none has a shape but its box."""
    return Obstacles(rows, np.full(len(rows), EXACT), np.empty((0, 3, 4)), NO_SHAPES)


def join(*groups: Obstacles) -> Obstacles:
    """Several obstacles as one; those that have shapes share one table."""
    tables = [group.shapes for group in groups if group.shapes is not NO_SHAPES]
    if not tables:
        return boxes_only(np.vstack([group.rows for group in groups]))
    return Obstacles(
        np.vstack([group.rows for group in groups]),
        np.concatenate([group.shape for group in groups]),
        np.concatenate([_poses(group) for group in groups]),
        tables[0],
    )


def _poses(group: Obstacles) -> Floats:
    return group.pose if len(group.pose) else np.zeros((len(group.rows), 3, 4))


def seen_from(obstacles: Obstacles, x: float, y: float, yaw: float, reach: float) -> Obstacles:
    """The obstacles within `reach` (in the plane) of a base pose, in the base frame."""
    rows = to_base_frame(obstacles.rows, x, y, yaw, reach)
    if obstacles.shapes is NO_SHAPES:
        return boxes_only(rows)
    near = within_reach(obstacles.rows, x, y, reach)
    pose = obstacles.pose[near]
    c, s = math.cos(yaw), math.sin(yaw)
    pose[:, 0, 3] -= x
    pose[:, 1, 3] -= y
    pose[:, 0], pose[:, 1] = c * pose[:, 0] + s * pose[:, 1], c * pose[:, 1] - s * pose[:, 0]
    return Obstacles(rows, obstacles.shape[near], pose, obstacles.shapes)


@njit(cache=True)
def support_point(solid, vertices, pose, dx, dy, dz):  # type: ignore[no-untyped-def]
    """The point of the core of a solid (7,) at a pose (3, 4) that is furthest along a direction,
    both in the frame that the pose is given in: three coordinates."""
    lx = pose[0, 0] * dx + pose[1, 0] * dy + pose[2, 0] * dz
    ly = pose[0, 1] * dx + pose[1, 1] * dy + pose[2, 1] * dz
    lz = pose[0, 2] * dx + pose[1, 2] * dy + pose[2, 2] * dz
    if solid[0] == BOX:
        px = solid[1] if lx >= 0.0 else -solid[1]
        py = solid[2] if ly >= 0.0 else -solid[2]
        pz = solid[3] if lz >= 0.0 else -solid[3]
    elif solid[0] == CYLINDER:
        flat = math.sqrt(lx * lx + ly * ly)
        px = py = 0.0
        if flat > 0.0:
            px = solid[1] * lx / flat
            py = solid[1] * ly / flat
        pz = solid[3] if lz >= 0.0 else -solid[3]
    else:
        best = -math.inf
        first = int(solid[5])
        at = first
        for i in range(first, first + int(solid[6])):
            along = lx * vertices[i, 0] + ly * vertices[i, 1] + lz * vertices[i, 2]
            if along > best:
                best = along
                at = i
        px = vertices[at, 0]
        py = vertices[at, 1]
        pz = vertices[at, 2]
    return (
        pose[0, 0] * px + pose[0, 1] * py + pose[0, 2] * pz + pose[0, 3],
        pose[1, 0] * px + pose[1, 1] * py + pose[1, 2] * pz + pose[1, 3],
        pose[2, 0] * px + pose[2, 1] * py + pose[2, 2] * pz + pose[2, 3],
    )


@njit(cache=True)
def _nearest_of_simplex(points, n, kept):  # type: ignore[no-untyped-def]
    """The point nearest to the origin of the simplex of the first n rows of `points` (4, 3),
    among the faces that have its last, newest point; n is then how many points span it.

    Every face is tried and the nearest of the valid ones taken: no decision hangs on the sign
    of a number that is almost zero. n is 4 where the origin is inside. `kept` (4, 3) is scratch.
    """
    new = n - 1
    wx, wy, wz = points[new, 0], points[new, 1], points[new, 2]
    best = wx * wx + wy * wy + wz * wz
    vx, vy, vz = wx, wy, wz
    first = -1
    second = -1
    for i in range(new):
        ex, ey, ez = points[i, 0] - wx, points[i, 1] - wy, points[i, 2] - wz
        length = ex * ex + ey * ey + ez * ez
        if length == 0.0:
            continue
        t = -(wx * ex + wy * ey + wz * ez) / length
        if 0.0 < t < 1.0:
            x, y, z = wx + t * ex, wy + t * ey, wz + t * ez
            squared = x * x + y * y + z * z
            if squared < best:
                best = squared
                vx, vy, vz = x, y, z
                first, second = i, -1
        for j in range(i):
            fx, fy, fz = points[j, 0] - wx, points[j, 1] - wy, points[j, 2] - wz
            nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
            area = nx * nx + ny * ny + nz * nz
            if area <= FLAT * FLAT * length * (fx * fx + fy * fy + fz * fz):
                continue
            # Weights of the points i and j by areas, with q = -w the origin seen from w.
            s = (
                nx * (-wy * fz + wz * fy) + ny * (-wz * fx + wx * fz) + nz * (-wx * fy + wy * fx)
            ) / area
            r = (
                nx * (ey * -wz + ez * wy) + ny * (ez * -wx + ex * wz) + nz * (ex * -wy + ey * wx)
            ) / area
            if s > 0.0 and r > 0.0 and s + r < 1.0:
                along = (nx * wx + ny * wy + nz * wz) / area
                x, y, z = along * nx, along * ny, along * nz
                squared = x * x + y * y + z * z
                if squared < best:
                    best = squared
                    vx, vy, vz = x, y, z
                    first, second = i, j
    if n == 4 and _holds_origin(points):
        return 4, 0.0, 0.0, 0.0
    n = 0
    for i in (first, second):
        if i >= 0:
            kept[n] = points[i]
            n += 1
    kept[n, 0], kept[n, 1], kept[n, 2] = wx, wy, wz
    n += 1
    for i in range(n):
        points[i] = kept[i]
    return n, vx, vy, vz


@njit(cache=True)
def _holds_origin(points):  # type: ignore[no-untyped-def]
    """Whether the origin is in the tetrahedron of four points (4, 3)."""
    wx, wy, wz = points[3, 0], points[3, 1], points[3, 2]
    ax, ay, az = points[0, 0] - wx, points[0, 1] - wy, points[0, 2] - wz
    bx, by, bz = points[1, 0] - wx, points[1, 1] - wy, points[1, 2] - wz
    cx, cy, cz = points[2, 0] - wx, points[2, 1] - wy, points[2, 2] - wz
    ux, uy, uz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    volume = ax * ux + ay * uy + az * uz
    edges = (
        (ax * ax + ay * ay + az * az)
        * (bx * bx + by * by + bz * bz)
        * (cx * cx + cy * cy + cz * cz)
    )
    if volume * volume <= FLAT * FLAT * edges:
        return False
    s = -(wx * ux + wy * uy + wz * uz) / volume
    ux, uy, uz = cy * az - cz * ay, cz * ax - cx * az, cx * ay - cy * ax
    t = -(wx * ux + wy * uy + wz * uz) / volume
    ux, uy, uz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    r = -(wx * ux + wy * uy + wz * uz) / volume
    return s >= 0.0 and t >= 0.0 and r >= 0.0 and s + t + r <= 1.0


@njit(cache=True)
def gjk_distance(  # type: ignore[no-untyped-def]
    solid_a, vertices_a, pose_a, solid_b, vertices_b, pose_b, near, enough, tolerance
):
    """A lower bound on the distance between two solids (7,) at their poses (3, 4), less than
    `tolerance` below it, 0 where they touch.

    It ends early, with a bound that is less good, as soon as the distance is known to be at
    most `near` (then the bound is at most `near` too) or at least `enough`.
    """
    rounding = solid_a[4] + solid_b[4]
    points = np.empty((4, 3))
    kept = np.empty((4, 3))
    vx = pose_a[0, 3] - pose_b[0, 3]
    vy = pose_a[1, 3] - pose_b[1, 3]
    vz = pose_a[2, 3] - pose_b[2, 3]
    length = math.sqrt(vx * vx + vy * vy + vz * vz)
    if length < NOTHING:
        vx, vy, vz, length = 1.0, 0.0, 0.0, 1.0
    started = False
    n = 0
    low = 0.0
    for _ in range(ITERATIONS):
        ax, ay, az = support_point(solid_a, vertices_a, pose_a, -vx, -vy, -vz)
        bx, by, bz = support_point(solid_b, vertices_b, pose_b, vx, vy, vz)
        wx, wy, wz = ax - bx, ay - by, az - bz
        low = max(low, (vx * wx + vy * wy + vz * wz) / length)
        if low - rounding > enough:  # at 0, what is known of all solids is not enough
            break
        if started and length - low <= tolerance:
            break
        known = False
        for i in range(n):
            known = known or (points[i, 0] == wx and points[i, 1] == wy and points[i, 2] == wz)
        if known:
            break
        points[n, 0], points[n, 1], points[n, 2] = wx, wy, wz
        n, vx, vy, vz = _nearest_of_simplex(points, n + 1, kept)
        if n == 4:
            return 0.0
        before = length
        length = math.sqrt(vx * vx + vy * vy + vz * vz)
        if length < NOTHING:
            return 0.0
        if length - rounding <= near:
            return max(0.0, min(near, low - rounding))
        if started and length >= before:
            break
        started = True
    return max(0.0, low - rounding)


@njit(cache=True)
def solid_of(shape, solids, half):  # type: ignore[no-untyped-def]
    """The solid (7,) of an index into a table; of EXACT, a box of half extents (3,)."""
    if shape >= 0:
        return solids[shape]
    box = np.zeros(7)
    box[1:4] = half
    return box


@njit(cache=True)
def pose_of_row(row):  # type: ignore[no-untyped-def]
    """The pose (3, 4) of a packed upright box."""
    pose = np.zeros((3, 4))
    pose[0, 0] = pose[1, 1] = row[6]
    pose[1, 0], pose[0, 1] = row[7], -row[7]
    pose[2, 2] = 1.0
    pose[:, 3] = row[:3]
    return pose
