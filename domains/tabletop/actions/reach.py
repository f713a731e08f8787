"""InverseKinematics of X: a collision-free way of the gripper to a grasp and out again.

Picking an object up and putting it down are the same motion, forwards and backwards: the
open gripper comes in along a straight line, closes, lifts the object straight up and backs
out along the line that it came on. A `Reach` holds both lines.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from domains.tabletop.hand import APPROACH, LIFT, Hand
from domains.tabletop.items import Item
from domains.tabletop.state import DOWN, Grasp
from runtime.kernels import ik
from runtime.kernels.convex import Obstacles
from runtime.motion.arm_context import CONTACT_MARGIN, ArmContext
from runtime.motion.base import outline
from runtime.robot.model import Floats, RobotModel
from runtime.world.body import Part
from runtime.world.poses import Pose, compose, invert
from runtime.world.world import Peg

HEADROOM = 0.01
"""Metres above others of its height to which something is drawn out."""

LINE_STEP = 0.02
MAX_TURN = 0.25
"""Radians that a joint may turn in one step of a line: more means another branch."""

ANOTHER = 0.3
"""Radians, or metres, in some joint by which one posture is another than the one before."""

ITERATIONS, LINE_ITERATIONS = 60, 12
"""Of inverse kinematics, from anywhere and from one step of a line to the next."""


@dataclass(frozen=True, eq=False)
class Reach:
    """Configurations along the lines, and the gripper openings (m).

    `approach` (p, n) ends at the grasp with the fingers open; `lift` starts there and goes
    straight up with the object; `retreat` backs out from its end.
    """

    approach: Floats
    lift: Floats
    retreat: Floats
    opening: float
    closed: float


@dataclass(frozen=True, eq=False)
class Grip:
    """What a grasp means for the fingers, whatever the place: how far they are apart before
    they close and then, how far it is lifted, and how far the hand draws back with the object then,
    best first; metres. From among others of its height it is drawn out upwards as a whole."""

    opening: float
    closed: float
    retreats: tuple[float, ...] = (APPROACH,)
    lift: float = LIFT

    def off(self, peg: Peg, family: int) -> Grip:
        """The same where the object is over a peg: a hand that draws back upwards draws it off
        that, another one lifts it off before."""
        least = peg.height + HEADROOM
        if family not in DOWN:
            return replace(self, lift=max(self.lift, least))
        lengths = (max(length, least - self.lift) for length in self.retreats)
        return replace(self, retreats=tuple(dict.fromkeys(lengths)))


def grip_of(item: Item, hand: Hand, grasp: Grasp) -> Grip | None:
    """The grip of a grasp, or None where the hand does not take the object so."""
    hold = item.holds(hand, grasp.family, np.array([grasp.heading]))
    if hold is None or not hold.fits[0]:
        return None
    width = float(hold.width[0])
    return Grip(hand.robot.gripper.opening_for(width), width, _retreats(item, grasp))


def grip_on(grip: Grip, item: Item, grasp: Grasp) -> Grip:
    """A grip as it is where the object is put on another face, `grasp` seen from that."""
    return replace(grip, retreats=_retreats(item, grasp))


def _retreats(item: Item, grasp: Grasp) -> tuple[float, ...]:
    tall = item.size[2] + HEADROOM
    return (tall, APPROACH) if grasp.family in DOWN and tall > APPROACH else (APPROACH,)


def held_parts(item: Item, tool: Pose) -> tuple[Part, ...]:
    """The solids of an object in the tool frame, for a tool in its standing frame (3, 4)."""
    standing = invert(tool)
    return tuple(Part(part.solid, compose(standing, part.pose)) for part in item.parts)


class ReachSolver:
    """Solves for reaches of one robot."""

    def __init__(self, robot: RobotModel) -> None:
        self.robot = robot

    def reaches(
        self,
        held: Sequence[Part],
        grip: Grip,
        target: Pose,
        others: Obstacles,
        with_object: Obstacles,
        rng: np.random.Generator,
        seeds: int,
    ) -> Iterator[Reach]:
        """Reaches that take the tool to `target` (3, 4) in the base frame, each with the arm in
        another posture.

        `held` are the solids of what is held then, in the tool frame; `others` are the obstacles
        around without the object, `with_object` those with it, both in the base frame. Every
        second seed starts from the home posture's neighbourhood, for short motions; the others
        anywhere in the joint ranges.
        """
        robot = self.robot
        empty = ArmContext(robot, robot.body(grip.opening), with_object)
        found: list[Floats] = []
        for q in self._free_from(empty, target, self._starts(rng, seeds)):
            if any(np.abs(q - other).max() < ANOTHER for other in found):
                continue
            reach = self._lines(held, grip, target, q, empty, others)
            if reach is not None:
                found.append(q)
                yield reach

    def postures(
        self, context: ArmContext, target: Pose, seeds: int, seed: int
    ) -> Iterator[Floats]:
        """Configurations (n,) that are free of contact and take the tool to `target` (3, 4) in
        the base frame, found from so many seeds."""
        return self._free_from(context, target, self._starts(np.random.default_rng(seed), seeds))

    def _free_from(self, context: ArmContext, target: Pose, starts: Floats) -> Iterator[Floats]:
        robot, number = self.robot, -1
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
                robot.ease,
                context.body,
                context.obstacles,
                CONTACT_MARGIN,
            )
            if number < 0:
                return
            yield starts[number]

    def ahead(self, opening: float) -> float:
        """Metres that the hand reaches ahead of the grasp centre, the fingers `opening` apart."""
        body = self.robot.body(opening)
        to_tool, most = invert(self.robot.tool), -math.inf
        for i in np.flatnonzero(body.frame == len(self.robot.joints)):
            points, rounding = outline(body, int(i))
            forward = compose(to_tool, body.pose[i])[0]
            most = max(most, float((points @ forward[:3] + forward[3]).max()) + rounding)
        return most

    def _starts(self, rng: np.random.Generator, number: int) -> Floats:
        """Configurations (number, n) to start from."""
        robot, joints = self.robot, len(self.robot.home)
        starts = rng.uniform(robot.lower, robot.upper, (number, joints))
        stray = 0.1 * np.arange(0, number, 2)[:, None]
        near = robot.home + stray * rng.normal(size=(len(stray), joints))
        starts[::2] = np.clip(near, robot.lower, robot.upper)
        return starts

    def _lines(
        self,
        held: Sequence[Part],
        grip: Grip,
        target: Pose,
        q: Floats,
        empty: ArmContext,
        others: Obstacles,
    ) -> Reach | None:
        """The lines in, up and out through a free configuration at the grasp."""
        robot = self.robot
        out = self.line(target, -APPROACH * target[:, 0], q)
        if out is None or not empty.path_is_free(out, CONTACT_MARGIN):
            return None
        full = ArmContext(robot, robot.body(grip.closed, held), others)
        up = np.array([0.0, 0.0, grip.lift])
        lift = self.line(target, up, q)
        if lift is None:
            return None
        lifted = target.copy()
        lifted[:, 3] += up
        for length in grip.retreats:
            retreat = self.line(lifted, -length * target[:, 0], lift[-1])
            if retreat is not None and full.path_is_free(
                np.vstack([lift, retreat[1:]]), CONTACT_MARGIN
            ):
                return Reach(out[::-1].copy(), lift, retreat, grip.opening, grip.closed)
        return None

    def line(self, target: Pose, offset: Floats, start: Floats) -> Floats | None:
        """Configurations that move the tool on a straight line from the target pose."""
        steps = max(1, math.ceil(float(np.linalg.norm(offset)) / LINE_STEP))
        robot = self.robot
        path: Floats = ik.line(
            robot.chain, robot.lower, robot.upper, robot.tool, target, offset, start, steps,
            LINE_ITERATIONS, robot.ease, MAX_TURN,
        )  # fmt: skip
        return path if len(path) == steps + 1 else None
