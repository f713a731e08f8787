"""Base motions: turn on the spot, drive straight, turn; shortest along a visibility graph.

While it drives, the robot keeps its posture: home, or the one in which it carries something.
Turning on the spot it sweeps a stack of
rings, one a box: a position is safe in every heading if it keeps, from each obstacle, the
largest outer radius of the robot's boxes at the obstacle's height. This is conservative,
needs no heading in the search, and holds for everything in between as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from runtime.angles import wrap
from runtime.kernels import arm, plane
from runtime.kernels.convex import CYLINDER, HULL
from runtime.kernels.ways import shortest_way
from runtime.robot.model import Body, Floats, RobotModel

MARGIN = 0.01
"""Metres added to every clearance."""

CORNER = 1.002 / math.cos(math.pi / 8)
"""Way points stand around the corners of obstacles, two a corner, this factor outside their
clearance: so the lines between neighbours just pass, around a corner and along a side."""


SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))
"""The corners of a box of half extents 1."""

SIDES = 32
ROUND = np.array(
    [
        (
            math.cos(angle) / math.cos(math.pi / SIDES),
            math.sin(angle) / math.cos(math.pi / SIDES),
            z,
        )
        for angle in np.arange(SIDES) * (2 * math.pi / SIDES)
        for z in (-1.0, 1.0)
    ]
)
"""Corners of a prism around a cylinder of radius 1 and half height 1."""


@dataclass(frozen=True, eq=False)
class Footprint:
    """For each box of the robot in a posture: height from-to and outer radius (m, 3)."""

    rings: Floats

    def clearances(self, boxes: Floats) -> Floats:
        """Clearance (w,) that the base axis keeps from each upright box, 0 for none."""
        low, high, radius = self.rings.T
        bottom = (boxes[:, 2] - boxes[:, 5])[:, None]
        top = (boxes[:, 2] + boxes[:, 5])[:, None]
        meets = (low[None] < top + MARGIN) & (high[None] > bottom - MARGIN)
        clearance = np.where(meets, radius[None] + MARGIN, 0.0)
        return clearance.max(axis=1) if clearance.size else np.zeros(len(boxes))


def footprint(robot: RobotModel, body: Body, posture: Floats | None = None) -> Footprint:
    """The rings of a robot in a posture (n,); without one, at home."""
    placed = np.empty((len(body.frame), 3, 4))
    frames = robot.frames(robot.home if posture is None else posture)
    arm.place_boxes(frames, body.frame, body.pose, placed)
    rings = []
    for i, pose in enumerate(placed):
        points, rounding = outline(body, i)
        points = points @ pose[:, :3].T + pose[:, 3]
        rings.append(
            (
                points[:, 2].min() - rounding,
                points[:, 2].max() + rounding,
                np.hypot(points[:, 0], points[:, 1]).max() + rounding,
            )
        )
    return Footprint(np.array(rings))


def outline(body: Body, part: int) -> tuple[Floats, float]:
    """Points (k, 3), in the frame of a part, and a radius: the convex hull of balls of that
    radius around the points holds the part."""
    index = body.shape[part]
    if index < 0:
        return SIGNS * body.half[part], 0.0
    kind, *size, rounding, first, count = body.shapes.solids[index].tolist()
    if kind == HULL:
        return body.shapes.vertices[int(first) : int(first + count)], rounding
    if kind == CYLINDER:
        return ROUND * [size[0], size[0], size[2]], rounding
    return SIGNS * size, rounding


class BaseRoads:
    """Shortest drives among fixed obstacles; way points are made once for a set of boxes and
    clearances."""

    def __init__(self, boxes: Floats, clearance: Floats) -> None:
        self.boxes = boxes
        self.clearance = clearance
        self.nodes = self._corners()

    def _corners(self) -> Floats:
        found = []
        for box, clearance in zip(self.boxes, self.clearance, strict=True):
            if clearance <= 0.0:
                continue
            for k in range(8):
                bearing = (k + 0.5) * math.pi / 4
                c, s = math.cos(bearing), math.sin(bearing)
                lx = math.copysign(box[3], c) + clearance * CORNER * c
                ly = math.copysign(box[4], s) + clearance * CORNER * s
                x = box[0] + box[6] * lx - box[7] * ly
                y = box[1] + box[7] * lx + box[6] * ly
                if self.is_clear(x, y):
                    found.append((x, y))
        return np.array(found).reshape(-1, 2)

    def is_clear(self, x: float, y: float) -> bool:
        """Whether the robot can stand and turn at a position."""
        clear: bool = plane.point_is_clear(self.boxes, self.clearance, x, y)
        return clear

    def route(self, start: tuple[float, float], goal: tuple[float, float]) -> Floats | None:
        """Way points (k, 2) of a shortest drive from start to goal, both included."""
        if not self.is_clear(*start) or not self.is_clear(*goal):
            return None
        if plane.segment_is_clear(self.boxes, self.clearance, *start, *goal):
            return np.array([start, goal])
        points = np.vstack([self.nodes, start, goal])
        way = shortest_way(self.boxes, self.clearance, points)
        return points[way] if len(way) else None


def drive(route: Floats, start_yaw: float, goal_yaw: float) -> Floats:
    """Poses (k, 3) of a differential drive along way points: turns and straight lines.

    Consecutive poses differ in position or in heading, never in both.
    """
    poses = [(route[0, 0], route[0, 1], start_yaw)]
    yaw = start_yaw
    for (x0, y0), (x1, y1) in pairwise(route):
        if math.hypot(x1 - x0, y1 - y0) < 1e-9:
            continue
        heading = yaw + wrap(math.atan2(y1 - y0, x1 - x0) - yaw)
        if abs(wrap(heading - yaw)) > math.pi / 2 and math.hypot(x1 - x0, y1 - y0) < 0.4:
            heading = yaw + wrap(heading + math.pi - yaw)  # a short way back is driven backwards
        poses.append((x0, y0, heading))
        poses.append((x1, y1, heading))
        yaw = heading
    poses.append((route[-1, 0], route[-1, 1], yaw + wrap(goal_yaw - yaw)))
    kept = [poses[0]]
    for pose in poses[1:]:
        if max(abs(a - b) for a, b in zip(pose, kept[-1], strict=True)) > 1e-9:
            kept.append(pose)
    if len(kept) == 1:
        kept.append(kept[0])
    return np.array(kept)
