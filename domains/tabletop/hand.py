"""What grasps and features need to know of a robot's hand and arm."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from domains.tabletop.state import DOWN, END, PINCH, SIDE, SLANT, TOP
from runtime.robot.approach import Family
from runtime.robot.model import RobotModel
from runtime.robot.open_hand import finger_boxes, flat_of, room_between
from runtime.robot.sweeps import TRAVEL, drawn_out
from runtime.world.poses import Floats

PLAY = 0.003
"""Metres kept on the outside of each finger."""

SIDEWAYS = 0.02
"""Metres added on both sides of hand and arm: where less is left, few postures come through."""

APPROACH = TRAVEL
"""Metres of the straight line in; the fingers are clear of the object behind it."""

LIFT = 0.03
"""Metres that an object is lifted before the hand draws back with it."""

CLOSING = 6
"""Openings at which fingers that always open fully are looked at while they close."""

FAMILY = {
    SIDE: Family.SIDE,
    TOP: Family.TOP,
    PINCH: Family.PINCH,
    SLANT: Family.SLANT,
    END: Family.TOP,
}


class Sweeps(dict[int, Floats]):
    """The volumes of each family, made when they are asked for: few scenes think of all."""

    def __init__(self, robot: RobotModel) -> None:
        super().__init__()
        self.robot = robot

    def __missing__(self, family: int) -> Floats:
        found = self[family] = _volumes(self.robot, family)
        return found


@dataclass(frozen=True, eq=False)
class Hand:
    """A parallel gripper and the arm behind it. Metres, newtons, newton metres.

    From the grasp centre, along the approach: the fingers end `tip` in front of it and the palm,
    or what else is between them, is `back` behind it; `pad` is half the height of the fingers, and
    `fingertip` that of what reaches furthest ahead of them.
    `sweeps[f]` are the volumes (v, 7) that an approach of family f sweeps, as `features.swept`
    takes them.
    """

    robot: RobotModel
    tip: float
    back: float
    pad: float
    fingertip: float
    clearance: float
    max_opening: float
    max_weight: float
    max_torque: float
    sweeps: Sweeps

    @cached_property
    def pads(self) -> Floats:
        """The lowest and the highest x and z (2, 2), in the tool frame, of what is between the
        fingers."""
        return np.array([[-self.back, -self.pad], [self.tip, self.pad]])

    @cached_property
    def flat(self) -> Floats:
        """The same of where they touch what has flat sides: some fingers are further apart near
        the palm, or rounded at the edges."""
        face = flat_of(self.robot)
        if face is None:
            return self.pads
        low, high = np.maximum(face[0], self.pads[0]), np.minimum(face[1], self.pads[1])
        return np.array([low, high]) if (high > low).all() else self.pads

    @cached_property
    def finger_width(self) -> float:
        """Metres beside what is gripped that a finger needs, its play included."""
        return float(_outwards(self.robot, TOP).max())

    def _below(self, family: int) -> float:
        """Metres that the hand reaches below the grasp centre, fingers above and below left out."""
        if family not in self._known_below:
            approach = self.robot.approach(FAMILY[family])
            parts = [approach.hand] if family == PINCH else [approach.hand, approach.fingers]
            self._known_below[family] = -float(np.vstack(parts)[:, 4].min(initial=0.0))
        return self._known_below[family]

    @cached_property
    def _known_below(self) -> dict[int, float]:
        return {}

    def workspace(self, family: int, height: float) -> tuple[float, float, float] | None:
        """Where the wrist has to be for a grasp centre at a height above the floor: how far
        behind the centre it is, and from where to where from the shoulder axis; None where the
        arm does not reach, or where the hand would be in the floor. What comes down from above
        gets up again as well."""
        if height < self._below(family):
            return None
        inner, outer, wrist = self.robot.workspace(FAMILY[family], height)
        if family in DOWN:
            least, most, _ = self.robot.workspace(FAMILY[family], height + APPROACH + LIFT)
            inner, outer = max(inner, least), min(outer, most)
        return (wrist, inner, outer) if outer > inner else None


def hand_of(robot: RobotModel) -> Hand:
    """The hand of a robot, as kinematics derives it."""
    side = robot.approach(Family.SIDE)
    gripper = robot.gripper
    return Hand(
        robot=robot,
        tip=float(side.fingers[:, 1].max()),
        back=min(-float(side.hand[:, 1].max()), room_between(robot)),
        pad=float(side.fingers[:, 5].max()),
        fingertip=float(side.fingers[side.fingers[:, 1].argmax(), 5]),
        clearance=gripper.clearance,
        max_opening=gripper.max_opening,
        max_weight=9.81 * (gripper.payload or math.inf),
        max_torque=gripper.max_torque or math.inf,
        sweeps=Sweeps(robot),
    )


def _outwards(robot: RobotModel, family: int) -> Floats:
    """Metres (f,) that each box of an open finger reaches outwards from the face of what is
    gripped, or from its middle where the gripper always opens fully."""
    fingers, gripper = robot.approach(FAMILY[family]).fingers, robot.gripper
    beside = gripper.max_opening / 2 if gripper.opens_fully else gripper.clearance
    reach: Floats = fingers[:, (4 if family == PINCH else 2) + 1] + beside + PLAY
    return reach


def _volumes(robot: RobotModel, family: int) -> Floats:
    """The volumes (v, 7) of a family: the fingers with all that is between them, then hand and
    arm."""
    approach = robot.approach(FAMILY[family])
    wide = 4 if family == PINCH else 2
    if robot.gripper.opens_fully:
        fingers = _closing(robot, family)
        axis = np.zeros((len(fingers), 1))  # whatever the width of what is taken
        outwards = fingers[:, wide + 1] + PLAY
    else:
        fingers = approach.fingers.copy()
        axis = np.full((len(fingers), 1), 2.0 if family == PINCH else 1.0)
        outwards = _outwards(robot, family)
    fingers[:, wide], fingers[:, wide + 1] = -outwards, outwards
    rest = approach.hand_and_arm.copy()
    rest[:, 2] -= SIDEWAYS
    rest[:, 3] += SIDEWAYS
    rows = np.vstack([np.hstack([fingers, axis]), np.hstack([rest, np.zeros((len(rest), 1))])])
    return outermost(np.unique(rows.round(6), axis=0))


def outermost(rows: Floats) -> Floats:
    """Those of some different volumes (v, 7) that are not within another one."""
    low, high = rows[:, 0:6:2], rows[:, 1:6:2]
    within = (
        (low[:, None] >= low).all(axis=2)
        & (high[:, None] <= high).all(axis=2)
        & (rows[:, None, 6] == rows[:, 6])
    )
    kept: Floats = rows[within.sum(axis=1) == 1]  # within itself only
    return kept


def _closing(robot: RobotModel, family: int) -> Floats:
    """Boxes (f, 6) of the fingers that come in wide open and then close."""
    gripper, direction = robot.gripper, FAMILY[family]
    open_wide = finger_boxes(robot, direction, gripper.max_opening)
    closing = [
        finger_boxes(robot, direction, opening)
        for opening in np.linspace(gripper.min_opening, gripper.max_opening, CLOSING).tolist()
    ]
    return np.vstack([drawn_out(open_wide, direction), *closing])
