"""InverseKinematics of X: a collision-free way of the gripper to a grasp and out again.

Picking an object up and putting it down are the same motion, forwards and backwards: the
open gripper comes in along a horizontal line, closes, lifts the object straight up and
backs out. A `Reach` holds both lines.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from domains.tabletop.shapes import Shape
from domains.tabletop.state import UNIT, Grasp
from runtime.kernels import ik
from runtime.motion.arm_context import CONTACT_MARGIN, ArmContext
from runtime.robot.model import Floats, RobotModel
from runtime.robot.urdf import Box
from runtime.world.poses import Pose, compose, invert

APPROACH = 0.10
"""Metres of the straight line in; the fingers are clear of the object behind it."""

LIFT = 0.03
LINE_STEP = 0.02
MAX_TURN = 0.25
"""Radians that a joint may turn in one step of a line: more means another branch."""

ITERATIONS = 60


@dataclass(frozen=True, eq=False)
class Reach:
    """Configurations along the lines, and the gripper openings (m).

    `approach` (p, n) ends at the grasp with the fingers open; `lift` starts there and goes
    straight up with the object; `retreat` backs out from its end. `grasp` is the pose of
    the object's centre in the tool frame.
    """

    approach: Floats
    lift: Floats
    retreat: Floats
    opening: float
    closed: float
    grasp: Pose


@dataclass(frozen=True, eq=False)
class Hand:
    """What a grasp means for gripper and object, whatever the place."""

    opening: float
    closed: float
    tool_in_object: Pose  # the tool frame in the frame of the object's bottom

    @classmethod
    def of(cls, robot: RobotModel, shape: Shape, grasp: Grasp) -> Hand | None:
        """The hand for a grasp, or None where the gripper does not open wide enough."""
        width = shape.width(grasp.heading)
        opening = width + 2 * robot.gripper.clearance
        if opening > robot.gripper.max_opening:
            return None
        c, s = math.cos(grasp.heading), math.sin(grasp.heading)
        turn = -1.0 if grasp.flipped else 1.0
        tool = [
            [c, -s * turn, 0.0, 0.0],
            [s, c * turn, 0.0, 0.0],
            [0.0, 0.0, turn, grasp.height * UNIT],
        ]
        return cls(opening, width, np.array(tool))


def object_pose(x: float, y: float, yaw: float, z: float) -> Pose:
    """Pose of an object's bottom centre."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0, x], [s, c, 0.0, y], [0.0, 0.0, 1.0, z]])


def held_box(shape: Shape, tool_in_object: Pose) -> Box:
    """The object as a box in the tool frame."""
    centre = np.hstack([np.eye(3), [[0.0], [0.0], [shape.size[2] / 2]]])
    return Box("held", compose(invert(tool_in_object), centre), np.array(shape.size) / 2)


class ReachSolver:
    """Solves for reaches of one robot."""

    def __init__(self, robot: RobotModel) -> None:
        self.robot = robot

    def solve(
        self,
        shape: Shape,
        hand: Hand,
        bottom: Pose,
        others: Floats,
        with_object: Floats,
        rng: np.random.Generator,
        seeds: int,
    ) -> Reach | None:
        """A reach to an object whose bottom is at a pose in the base frame.

        `others` are the boxes around without the object, `with_object` those with it, both
        (w, 8) in the base frame. Every second seed starts from the home posture's
        neighbourhood, for short motions; the others anywhere in the joint ranges.
        """
        robot = self.robot
        target = compose(bottom, hand.tool_in_object)
        empty = ArmContext(robot, robot.body(hand.opening), with_object)
        starts = self._starts(rng, seeds)
        number = -1
        while True:
            number = ik.first_free(
                robot.chain,
                robot.lower,
                robot.upper,
                robot.tool,
                target,
                starts,
                number + 1,
                ITERATIONS,
                empty.body,
                empty.obstacles,
                CONTACT_MARGIN,
            )
            if number < 0:
                return None
            reach = self._lines(shape, hand, target, starts[number], empty, others)
            if reach is not None:
                return reach

    def _starts(self, rng: np.random.Generator, number: int) -> Floats:
        """Configurations (number, n) to start from."""
        robot = self.robot
        starts = np.empty((number, len(robot.home)))
        for i in range(number):
            if i % 2 == 0:
                q = robot.home + rng.normal(size=len(robot.home)) * (0.1 * i)
                starts[i] = np.clip(q, robot.lower, robot.upper)
            else:
                starts[i] = rng.uniform(robot.lower, robot.upper)
        return starts

    def _ik(self, target: Pose, q: Floats, iterations: int) -> bool:
        robot = self.robot
        solved: bool = ik.solve(
            *robot.chain, robot.lower, robot.upper, robot.tool, target, q, iterations
        )
        return solved

    def _lines(
        self,
        shape: Shape,
        hand: Hand,
        target: Pose,
        q: Floats,
        empty: ArmContext,
        others: Floats,
    ) -> Reach | None:
        """The lines in, up and out through a free configuration at the grasp."""
        robot = self.robot
        back = -APPROACH * target[:, 0]
        out = self._line(target, back, q)
        if out is None or not empty.path_is_free(out, CONTACT_MARGIN):
            return None
        full = ArmContext(
            robot, robot.body(hand.closed, held_box(shape, hand.tool_in_object)), others
        )
        up = np.array([0.0, 0.0, LIFT])
        lift = self._line(target, up, q)
        if lift is None:
            return None
        lifted = target.copy()
        lifted[:, 3] += up
        retreat = self._line(lifted, back, lift[-1])
        if retreat is None:
            return None
        if not full.path_is_free(np.vstack([lift, retreat[1:]]), CONTACT_MARGIN):
            return None
        return Reach(
            out[::-1].copy(), lift, retreat, hand.opening, hand.closed, invert(hand.tool_in_object)
        )

    def _line(self, target: Pose, offset: Floats, start: Floats) -> Floats | None:
        """Configurations that move the tool on a straight line from the target pose."""
        steps = max(1, math.ceil(float(np.linalg.norm(offset)) / LINE_STEP))
        path = [start]
        pose = target.copy()
        q = start.copy()
        for i in range(1, steps + 1):
            pose[:, 3] = target[:, 3] + offset * (i / steps)
            if not self._ik(pose, q, 12) or np.abs(q - path[-1]).max() > MAX_TURN:
                return None
            path.append(q.copy())
        return np.array(path)
