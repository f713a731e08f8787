"""How far solids reach down, and where they touch what is below; and rays through them."""

from __future__ import annotations

import math

import numpy as np

from runtime.world.body import Body
from runtime.world.poses import Floats
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere

RIM = 48
"""Points on the rim of a cylinder; one of them is always the lowest."""


def lowest(solid: Solid, poses: Floats) -> Floats:
    """Height (N,) of the lowest point of a solid at poses (N, 4, 4)."""
    down = poses[:, 2, :3]  # the world's z axis in the solid's frame
    if isinstance(solid, Hull):
        reach = (down @ solid.points.T).min(axis=1)
    elif isinstance(solid, Box):
        reach = -np.abs(down) @ np.array(solid.half)
    elif isinstance(solid, Sphere):
        reach = np.full(len(poses), -solid.radius)
    else:
        reach = -np.abs(down[:, 2]) * solid.height / 2
        if isinstance(solid, Cylinder):
            reach = reach - solid.radius * np.hypot(down[:, 0], down[:, 1])
        else:
            reach = reach - solid.radius
    found: Floats = poses[:, 2, 3] + reach
    return found


def lowest_of(body: Body, poses: Floats) -> Floats:
    """The same for a body at poses (N, 4, 4)."""
    heights = [lowest(part.solid, poses @ homogeneous(part.pose)) for part in body.parts]
    found: Floats = np.min(heights, axis=0)
    return found


def homogeneous(pose: Floats) -> Floats:
    """A 3x4 pose as a 4x4 matrix."""
    return np.vstack([pose[:3], [0.0, 0.0, 0.0, 1.0]])


def foot(body: Body, pose: Floats, within: float) -> Floats:
    """Points (k, 2) of the plane whose convex hull is what of a body at a pose (4, 4) is not
    more than `within` metres above its lowest point."""
    points = np.vstack([_corners(part.solid, pose @ homogeneous(part.pose)) for part in body.parts])
    found: Floats = points[points[:, 2] <= points[:, 2].min() + within, :2]
    return found


def _corners(solid: Solid, pose: Floats) -> Floats:
    """World points (k, 3) whose hull is a solid, or that stand for its curved sides: the lowest
    point of the solid is always among them."""
    down = -pose[2, :3]
    match solid:
        case Box():
            signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
            local = signs * np.array(solid.half)
        case Hull():
            local = solid.points
        case Sphere():
            local = down[None] * solid.radius
        case Capsule():
            ends = np.array([[0, 0, -solid.height / 2], [0, 0, solid.height / 2]])
            local = ends + down * solid.radius
        case Cylinder():
            first = math.atan2(down[1], down[0])
            angles = first + np.linspace(0, 2 * math.pi, RIM, endpoint=False)
            ring = solid.radius * np.column_stack([np.cos(angles), np.sin(angles)])
            local = np.vstack(
                [np.column_stack([ring, np.full(RIM, z * solid.height / 2)]) for z in (-1, 1)]
            )
    found: Floats = local @ pose[:3, :3].T + pose[:3, 3]
    return found


def along_y(solid: Solid, pose: Floats, x: Floats, z: Floats) -> tuple[Floats, Floats]:
    """Where lines parallel to y through points x, z (k,) enter and leave a solid at a pose
    (4, 4): y (k,) and y (k,), inf and -inf where they miss it."""
    turn, place = pose[:3, :3], pose[:3, 3]
    origin = (np.column_stack([x, np.zeros_like(x), z]) - place) @ turn
    way = turn[1]  # the y axis in the solid's frame
    with np.errstate(divide="ignore", invalid="ignore"):
        enter, leave = _through(solid, origin, way)
    missed = ~(enter < leave)
    return np.where(missed, np.inf, enter), np.where(missed, -np.inf, leave)


def _through(solid: Solid, origin: Floats, way: Floats) -> tuple[Floats, Floats]:
    match solid:
        case Box():
            sides = np.vstack([np.eye(3), -np.eye(3)])
            return _planes(sides, np.array(solid.half * 2), origin, way)
        case Hull():
            normals, offsets = _faces(solid)
            return _planes(normals, offsets, origin, way)
        case Sphere():
            return _ball(np.zeros(3), solid.radius, origin, way)
        case Cylinder():
            return _can(solid.radius, solid.height, origin, way)
        case Capsule():
            end = np.array([0.0, 0.0, solid.height / 2])
            pieces = [
                _can(solid.radius, solid.height, origin, way),
                _ball(end, solid.radius, origin, way),
                _ball(-end, solid.radius, origin, way),
            ]
            whole = [(np.where(a < b, a, np.inf), np.where(a < b, b, -np.inf)) for a, b in pieces]
            return np.min([a for a, _ in whole], axis=0), np.max([b for _, b in whole], axis=0)


def _planes(normals: Floats, offsets: Floats, origin: Floats, way: Floats) -> tuple[Floats, Floats]:
    """Through half spaces: normals (m, 3) times points at most offsets (m,)."""
    room, speed = offsets - origin @ normals.T, normals @ way
    still = np.abs(speed) < 1e-12
    hits = np.where(still, 0.0, room / np.where(still, 1.0, speed))
    enter = np.where(speed < -1e-12, hits, -np.inf).max(axis=1)
    leave = np.where(speed > 1e-12, hits, np.inf).min(axis=1)
    outside = (room[:, still] < 0).any(axis=1)
    return np.where(outside, np.inf, enter), np.where(outside, -np.inf, leave)


def _faces(hull: Hull) -> tuple[Floats, Floats]:
    from scipy.spatial import ConvexHull

    equations = ConvexHull(hull.points).equations
    return equations[:, :3], -equations[:, 3]


def _ball(centre: Floats, radius: float, origin: Floats, way: Floats) -> tuple[Floats, Floats]:
    off = origin - centre
    middle = -off @ way
    square = radius**2 - (off**2).sum(axis=1) + middle**2
    half = np.sqrt(square)  # nan where the line misses
    return middle - half, middle + half


def _can(radius: float, height: float, origin: Floats, way: Floats) -> tuple[Floats, Floats]:
    caps = _planes(
        np.array([[0, 0, 1.0], [0, 0, -1.0]]), np.array([height, height]) / 2, origin, way
    )
    a = way[0] ** 2 + way[1] ** 2
    flat = (origin[:, :2] ** 2).sum(axis=1) - radius**2
    if a < 1e-12:
        inside = flat <= 0
        return np.where(inside, caps[0], np.inf), np.where(inside, caps[1], -np.inf)
    b = origin[:, :2] @ way[:2]
    half = np.sqrt(b * b - a * flat)
    return np.maximum(caps[0], (-b - half) / a), np.minimum(caps[1], (-b + half) / a)
