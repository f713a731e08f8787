"""Where the base can drive: roads between places at which it can turn, and lanes out of those
at which it cannot.

A lane is the straight line backwards from a pose, with the heading kept: the way on which a
robot came in is a way out, also where a cabinet or a shelf leaves no room to turn.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from runtime.kernels import arm, plane
from runtime.kernels.boxes import to_base_frame
from runtime.kernels.convex import boxes_only
from runtime.kernels.lanes import way_back
from runtime.motion.base import MARGIN, BaseRoads, Footprint, drive, footprint
from runtime.robot.model import Body, RobotModel
from runtime.world.poses import Floats

LANE = 1.5
"""Metres that a lane is long at most."""

STEP = 0.02
"""Metres between the poses of a lane that are tested, with half of that added to the margin."""

STEPS = math.ceil(LANE / STEP) + 1

Stand = tuple[float, float, float]
"""x, y (m) and heading (rad) of the base."""


@dataclass(frozen=True, eq=False)
class Roads:
    """Roads of a robot with a body in a posture (n,), among boxes (w, 8)."""

    robot: RobotModel
    body: Body
    rings: Footprint
    boxes: Floats
    clearance: Floats
    posture: Floats

    @classmethod
    def of(cls, robot: RobotModel, body: Body, boxes: Floats) -> Roads:
        """Roads among some boxes, in the home posture."""
        rings = footprint(robot, body)
        return cls(robot, body, rings, boxes, rings.clearances(boxes), robot.home)

    @cached_property
    def graph(self) -> BaseRoads:
        """Shortest drives between places at which the robot can turn."""
        return BaseRoads(self.boxes, self.clearance)

    def among(self, more: Floats, body: Body | None, posture: Floats | None = None) -> Roads:
        """Roads with further boxes (n, 8) about, for the robot with another body and in another
        posture if they are given; these very roads where that changes nothing for drives."""
        posture = self.posture if posture is None else posture
        rings = self.rings if body is None else footprint(self.robot, body, posture)
        clearance = rings.clearances(more)
        free = _dominated(more, clearance, self.boxes, self.clearance)
        narrow = np.flatnonzero((clearance > 0) & ~free)
        fixed = self.clearance if body is None else rings.clearances(self.boxes)
        if not len(narrow) and np.array_equal(fixed, self.clearance):
            return self
        return Roads(
            self.robot,
            self.body if body is None else body,
            rings,
            np.vstack([self.boxes, more[narrow]]),
            np.concatenate([fixed, clearance[narrow]]),
            posture,
        )

    def can_turn(self, x: float, y: float) -> bool:
        """Whether the robot can stand at a position with any heading."""
        clear: bool = plane.point_is_clear(self.boxes, self.clearance, x, y)
        return clear

    def can_leave(self, stand: Stand) -> bool:
        """Whether the robot can drive off from a pose."""
        return self.lane(stand) is not None

    def lane(self, stand: Stand) -> tuple[float, float] | None:
        """Where, straight back from a pose, the robot can turn: the pose's own position where
        it can turn there; None where there is no such lane."""
        x, y, yaw = stand
        if self.can_turn(x, y):
            return x, y
        near = boxes_only(to_base_frame(self.boxes, x, y, yaw, LANE + 1.5))
        back = way_back(
            self.body, self._placed, near, MARGIN + STEP / 2, STEP, STEPS,
            self.boxes, self.clearance, x, y, yaw,
        )  # fmt: skip
        return None if back < 0 else (x - math.cos(yaw) * back, y - math.sin(yaw) * back)

    @cached_property
    def _placed(self) -> Floats:
        """The boxes of the body in the posture (m, 3, 4), in the base frame."""
        placed = np.empty((len(self.body.frame), 3, 4))
        frames = self.robot.frames(self.posture)
        arm.place_boxes(frames, self.body.frame, self.body.pose, placed)
        return placed

    def route(self, start: Stand, goal: Stand) -> Floats | None:
        """Base poses (k, 3) of a shortest drive: turns on the spot, and straight lines. None
        where there is no way."""
        out, into = self.lane(start), self.lane(goal)
        if out is None or into is None:
            return None
        points = self.graph.route(out, into)
        if points is None:
            return None
        poses = drive(points, start[2], goal[2])
        if out != start[:2]:
            poses = np.vstack([start, poses])
        if into != goal[:2]:
            poses = np.vstack([poses, [goal[0], goal[1], poses[-1, 2]]])
        return poses


def _dominated(
    rows: Floats, clearance: Floats, statics: Floats, static_clearance: Floats
) -> NDArray[np.bool_]:
    """For each box (n, 8): whether some static box keeps the base away from it anyway."""
    reach = np.hypot(rows[:, 3], rows[:, 4])[:, None]
    dx = rows[:, 0, None] - statics[:, 0]
    dy = rows[:, 1, None] - statics[:, 1]
    lx = np.abs(statics[:, 6] * dx + statics[:, 7] * dy) + reach
    ly = np.abs(statics[:, 6] * dy - statics[:, 7] * dx) + reach
    slack = np.minimum(statics[:, 3] - lx, statics[:, 4] - ly)
    dominated: NDArray[np.bool_] = np.any(
        (slack >= 0) & (clearance[:, None] <= static_clearance + slack), axis=1
    )
    return dominated
