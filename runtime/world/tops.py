"""Where things can rest on an object: the level top of a body, the floor of a tray."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from runtime.world.body import Body, Part
from runtime.world.poses import Pose, compose, invert, upright
from runtime.world.solids import Box, Cylinder, Floats, Hull
from runtime.world.stable import StablePose
from runtime.world.world import Support

WIDE = 0.03
"""Metres that a top measures along each side, at least: on less nothing is put."""

SLENDER = 0.33
"""A top is at least that part of the height of its object wide: nothing is put on a stick."""

LEVEL = 1e-6
"""Metres, and radians, by which a top may be off the level."""


@dataclass(frozen=True)
class Rectangle:
    """A level rectangle: from (x0, y0) to (x1, y1) in a frame turned by `yaw`, at a height."""

    x0: float
    x1: float
    y0: float
    y1: float
    yaw: float
    height: float

    @property
    def area(self) -> float:
        """Square metres, 0 for a rectangle that is inside out."""
        return max(0.0, self.x1 - self.x0) * max(0.0, self.y1 - self.y0)

    @property
    def half(self) -> tuple[float, float]:
        """Half its sides, metres."""
        return float(self.x1 - self.x0) / 2, float(self.y1 - self.y0) / 2

    def middle(self, above: float = 0.0) -> Floats:
        """The point (3,) so many metres above its middle, in its frame."""
        return np.array([(self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2, self.height + above])

    def turn(self) -> Floats:
        """The rotation (3, 3) from the frame around into that of the rectangle."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def top_of(name: str, body: Body, stable: StablePose, air: float) -> Support | None:
    """The support that a body offers in a stable pose, in the body's frame, `air` metres above
    it; None where it offers none.

    It is the largest level rectangle on top of one of its solids that no other one reaches
    over; of two that are alike, the higher one.
    """
    placed = [Part(part.solid, compose(stable.pose, part.pose)) for part in body.parts]
    tops = [
        _free_of(top, [other for other in placed if other is not part])
        for part in placed
        for top in level_tops(part)
    ]
    tops = [t for t in tops if min(t.x1 - t.x0, t.y1 - t.y0) >= max(WIDE, SLENDER * t.height)]
    if not tops:
        return None
    best = max(tops, key=lambda top: (round(top.area, 6), top.height))
    x, y, z = (best.turn().T @ best.middle(air)).tolist()
    pose = compose(invert(stable.pose), upright(x, y, z, best.yaw))
    return Support(name, name, pose, best.half)


def level_tops(part: Part) -> list[Rectangle]:
    """The level top of a solid, if it has one."""
    pose, solid = part.pose, part.solid
    up = pose[2, :3]
    match solid:
        case Box():
            axis = int(np.argmax(np.abs(up)))
            if abs(up[axis]) < 1 - LEVEL:
                return []
            side = (axis + 1) % 3
            yaw = math.atan2(pose[1, side], pose[0, side])
            x, y = solid.half[side], solid.half[(axis + 2) % 3]
            return [_around(pose, x, y, yaw, solid.half[axis])]
        case Cylinder():
            if abs(up[2]) < 1 - LEVEL:
                return []
            inside = solid.radius / math.sqrt(2)
            yaw = math.atan2(pose[1, 0], pose[0, 0])
            return [_around(pose, inside, inside, yaw, solid.height / 2)]
        case Hull():
            return _hull_top(solid, pose)
    return []


def _around(pose: Pose, x: float, y: float, yaw: float, above: float) -> Rectangle:
    flat = Rectangle(0.0, 0.0, 0.0, 0.0, yaw, 0.0)
    cx, cy, cz = (flat.turn() @ pose[:, 3]).tolist()
    return Rectangle(cx - x, cx + x, cy - y, cy + y, yaw, cz + above)


def _hull_top(hull: Hull, pose: Pose) -> list[Rectangle]:
    """A rectangle of the proportions of a level facet, as large as fits into it."""
    points = hull.points @ pose[:, :3].T + pose[:, 3]
    height = float(points[:, 2].max())
    facet = points[points[:, 2] > height - 10 * LEVEL][:, :2]
    if len(facet) < 3:
        return []
    low, high = facet.min(axis=0), facet.max(axis=0)
    if min(high - low) < WIDE:
        return []
    from scipy.spatial import ConvexHull

    edges = ConvexHull(facet).equations  # outward normal and offset of each
    middle, half = (low + high) / 2, (high - low) / 2
    room = -(edges[:, :2] @ middle + edges[:, 2])
    scale = float((room / (np.abs(edges[:, :2]) @ half)).min())
    if scale <= 0.0:
        return []
    (x0, y0), (x1, y1) = (middle - scale * half).tolist(), (middle + scale * half).tolist()
    return [Rectangle(x0, x1, y0, y1, 0.0, height)]


def _free_of(top: Rectangle, others: list[Part]) -> Rectangle:
    """What is left of a top beside the solids that reach higher: for each, the largest of the
    four rectangles that its box leaves."""
    turn = top.turn()
    for part in others:
        rotation = turn @ part.pose[:, :3]
        cx, cy, cz = (turn @ part.pose[:, 3]).tolist()
        hx, hy, hz = (np.abs(rotation) @ np.array(part.solid.half)).tolist()
        beside = cx + hx <= top.x0 or cx - hx >= top.x1 or cy + hy <= top.y0 or cy - hy >= top.y1
        if cz + hz <= top.height + LEVEL or beside:
            continue
        left = [
            Rectangle(top.x0, cx - hx, top.y0, top.y1, top.yaw, top.height),
            Rectangle(cx + hx, top.x1, top.y0, top.y1, top.yaw, top.height),
            Rectangle(top.x0, top.x1, top.y0, cy - hy, top.yaw, top.height),
            Rectangle(top.x0, top.x1, cy + hy, top.y1, top.yaw, top.height),
        ]
        top = max(left, key=lambda rectangle: rectangle.area)
    return top
