"""Plain twins of the compiled kernels, and FCL as the judge of what touches what.

Written for being right at a glance: 4x4 matrices, loops over every axis and heading, dense
sampling where the kernels reason.
"""

from __future__ import annotations

import math
from itertools import pairwise, product

import fcl
import numpy as np
from numpy.typing import NDArray

from runtime.motion.room import Room
from runtime.robot.model import Body, Chain
from runtime.world.solids import Box

Floats = NDArray[np.float64]

HEADINGS = 24
UNREACHABLE = 1_000_000


# -- poses and boxes ---------------------------------------------------------------------------


def homogeneous(pose: Floats) -> Floats:
    """A 3x4 pose as a 4x4 matrix."""
    return np.vstack([pose, [0.0, 0.0, 0.0, 1.0]])


def turn_z(angle: float) -> Floats:
    """A rotation about z (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def random_pose(rng: np.random.Generator, spread: float) -> Floats:
    """A 3x4 pose with any orientation, up to `spread` from the origin along each axis."""
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return np.column_stack([rotation, rng.uniform(-spread, spread, 3)])


def upright_row(centre: Floats, half: Floats, yaw: float) -> Floats:
    """An upright box packed as the kernels take it (8,)."""
    return np.array([*centre, *half, math.cos(yaw), math.sin(yaw)])


def random_uprights(rng: np.random.Generator, count: int, spread: float) -> Floats:
    """Upright boxes around the origin (count, 8)."""
    return np.array(
        [
            upright_row(
                rng.uniform(-spread, spread, 3),
                rng.uniform(0.01, 0.25, 3),
                rng.uniform(-math.pi, math.pi),
            )
            for _ in range(count)
        ]
    ).reshape(-1, 8)


def upright_pose(row: Floats) -> Floats:
    """The pose (3, 4) of a packed upright box; its half extents are row[3:6]."""
    c, s = row[6], row[7]
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.column_stack([rotation, row[:3]])


def corners(pose: Floats, half: Floats) -> Floats:
    """The eight corners of a box (8, 3)."""
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    return (signs * half) @ pose[:, :3].T + pose[:, 3]


def _fcl_object(pose: Floats, half: Floats) -> fcl.CollisionObject:
    return fcl.CollisionObject(fcl.Box(*(2 * half)), fcl.Transform(pose[:, :3], pose[:, 3]))


def fcl_touch(pose_a: Floats, half_a: Floats, pose_b: Floats, half_b: Floats) -> bool:
    """Whether FCL finds a contact between two boxes."""
    first, second = _fcl_object(pose_a, half_a), _fcl_object(pose_b, half_b)
    return bool(fcl.collide(first, second, fcl.CollisionRequest(), fcl.CollisionResult()))


def fcl_distance(pose_a: Floats, half_a: Floats, pose_b: Floats, half_b: Floats) -> float:
    """FCL's distance between two boxes, 0 where they touch."""
    first, second = _fcl_object(pose_a, half_a), _fcl_object(pose_b, half_b)
    found = fcl.distance(first, second, fcl.DistanceRequest(), fcl.DistanceResult())
    return max(0.0, float(found))


def boxes_overlap(pose_a: Floats, half_a: Floats, pose_b: Floats, half_b: Floats) -> bool:
    """The separating-axis test on corner points, over all fifteen axes."""
    axes = [*pose_a[:, :3].T, *pose_b[:, :3].T]
    axes += [np.cross(a, b) for a in pose_a[:, :3].T for b in pose_b[:, :3].T]
    a, b = corners(pose_a, half_a), corners(pose_b, half_b)
    for axis in axes:
        if np.linalg.norm(axis) < 1e-9:
            continue  # parallel edges: the face normals settle it
        on_a, on_b = a @ axis, b @ axis
        if on_a.max() < on_b.min() or on_b.max() < on_a.min():
            return False
    return True


# -- the arm -----------------------------------------------------------------------------------


def forward(chain: Chain, q: Floats) -> list[Floats]:
    """Frames 0..n of a chain as 4x4 matrices."""
    frames = [np.eye(4)]
    for origin, prismatic, value in zip(chain.origins, chain.prismatic, q, strict=True):
        motion = np.eye(4)
        if prismatic:
            motion[2, 3] = value
        else:
            motion[:3, :3] = turn_z(value)
        frames.append(frames[-1] @ homogeneous(origin) @ motion)
    return frames


def placed_boxes(chain: Chain, body: Body, q: Floats) -> list[Floats]:
    """The poses (3, 4) of a body's boxes."""
    frames = forward(chain, q)
    return [
        (frames[frame] @ homogeneous(pose))[:3]
        for frame, pose in zip(body.frame, body.pose, strict=True)
    ]


def arm_touches(chain: Chain, body: Body, world: Floats, q: Floats) -> bool:
    """Whether FCL sees the arm touch the world or itself; frame 0 does not meet the world."""
    placed = placed_boxes(chain, body, q)
    against_world = (
        fcl_touch(placed[b], body.half[b], upright_pose(row), row[3:6])
        for b in range(len(placed))
        if body.frame[b] != 0
        for row in world
    )
    against_itself = (
        fcl_touch(placed[a], body.half[a], placed[b], body.half[b]) for a, b in body.pairs
    )
    return any(against_world) or any(against_itself)


def arm_distance(chain: Chain, body: Body, world: Floats, q: Floats) -> float:
    """FCL's smallest distance between the arm and the world or between its own pairs."""
    placed = placed_boxes(chain, body, q)
    gaps = [
        fcl_distance(placed[b], body.half[b], upright_pose(row), row[3:6])
        for b in range(len(placed))
        if body.frame[b] != 0
        for row in world
    ]
    gaps += [fcl_distance(placed[a], body.half[a], placed[b], body.half[b]) for a, b in body.pairs]
    return min(gaps)


def along(path: Floats, samples: int) -> Floats:
    """Configurations evenly spaced on every segment of a path, way points included."""
    rows = [path[:1]]
    for a, b in pairwise(path):
        rows.append(a + (b - a) * (np.arange(1, samples + 1) / samples)[:, None])
    return np.vstack(rows)


# -- the plane ---------------------------------------------------------------------------------


def point_distance(row: Floats, x: float, y: float) -> float:
    """Distance in the plane from a point to the footprint of an upright box."""
    local = upright_pose(row)[:2, :2].T @ (np.array([x, y]) - row[:2])
    nearest = np.clip(local, -row[3:5], row[3:5])
    return float(np.linalg.norm(local - nearest))


def segment_distance(row: Floats, start: Floats, end: Floats, samples: int = 2000) -> float:
    """The same for a segment, over points on it: too large by half a sample at most."""
    points = np.linspace(start, end, samples + 1)
    local = (points - row[:2]) @ upright_pose(row)[:2, :2]
    outside = np.maximum(np.abs(local) - row[3:5], 0.0)
    return float(np.linalg.norm(outside, axis=1).min())


# -- approach directions -----------------------------------------------------------------------


def barred_headings(
    site: Floats,
    hold: Floats,
    height: float,
    own: tuple[float, float],
    row: Floats,
    hand: Floats,
    play: float,
    level: float,
) -> set[int]:
    """Headings along which an upright box bars the way to something at a site (3,).

    `hold` (K, 3), `own` and `hand` (v, 7) are as in `domains.tabletop.features.swept`.
    """
    box = corners(upright_pose(row), row[3:6])
    bottom, top = box[:, 2].min() - site[2], box[:, 2].max() - site[2]
    beside = point_distance(row, site[0], site[1]) >= own[0] + play
    above_or_below = bottom >= own[1] - level or top <= level
    # Seen along a heading a box counts as a larger, upright one: out of reach it does not.
    reach = np.hypot(*np.abs(hand[:, :4]).reshape(-1, 2, 2).max(axis=2).T).max()
    if point_distance(row, site[0], site[1]) > reach + np.abs(hold).sum(axis=1).max():
        return set()
    if not beside and not above_or_below:
        return set(range(HEADINGS))
    barred = set()
    for k in range(HEADINGS):
        half, along, aside = hold[k]
        frame = turn_z(2 * math.pi * k / HEADINGS)
        seen = (box - site) @ frame - [along, aside, height]
        low, high = seen.min(axis=0), seen.max(axis=0)
        for volume in hand:
            lower, upper = volume[[0, 2, 4]].copy(), volume[[1, 3, 5]].copy()
            if volume[6]:
                axis = int(volume[6])
                lower[axis] -= half
                upper[axis] += half
            if (low < upper).all() and (high > lower).all():
                barred.add(k)
    return barred


def headings_of(bits: int) -> set[int]:
    """The headings whose bits are set."""
    return {k for k in range(HEADINGS) if bits >> k & 1}


def bits_of(headings: set[int]) -> int:
    """The other way round."""
    return sum(1 << k for k in headings)


def bar_counts(
    barred: list[list[set[int]]], present: list[bool], reachable: list[set[int]]
) -> Floats:
    """For each site and heading, how many present objects bar it."""
    out = np.zeros((len(barred), HEADINGS))
    for i, k in product(range(len(barred)), range(HEADINGS)):
        out[i, k] = sum(
            k in headings and here for headings, here in zip(barred[i], present, strict=True)
        )
        if k not in reachable[i]:
            out[i, k] += UNREACHABLE
    return out


def in_room(room: Room, point: Floats) -> bool:
    """Whether a point keeps its clearances, in a cell of the room or next to one."""
    if any(
        needed > 0 and point_distance(row, *point) < needed
        for row, needed in zip(room.floor.boxes, room.floor.clearance, strict=True)
    ):
        return False
    i, j = np.floor((point - [room.floor.x0, room.floor.y0]) / room.floor.cell).astype(int)
    rows, columns = room.cells.shape
    if not (0 <= i < rows and 0 <= j < columns):
        return False
    around = room.cells[max(0, i - 1) : i + 2, max(0, j - 1) : j + 2]
    return bool(around.any())


def has_stand(
    site: Floats,
    k: int,
    shoulder: Floats,
    tool_offset: float,
    ring: tuple[float, float],
    room: Room,
) -> bool:
    """Whether a base position on the fan behind the wrist is in the room."""
    heading = 2 * math.pi * k / HEADINGS
    wrist = site - tool_offset * np.array([math.cos(heading), math.sin(heading)])
    inner, outer = ring
    for turn, step in product(range(-6, 7), range(4)):
        bearing = heading + 0.2 * turn
        reach = outer - step * (outer - inner) / 4
        axis = wrist - reach * np.array([math.cos(bearing), math.sin(bearing)])
        yaw = math.atan2(site[1] - axis[1], site[0] - axis[0])
        if in_room(room, axis - turn_z(yaw)[:2, :2] @ shoulder):
            return True
    return False


def solid_box(half: Floats) -> Box:
    """A box by its half extents."""
    x, y, z = (2 * np.asarray(half)).tolist()
    return Box((x, y, z))
