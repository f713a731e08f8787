"""What grasps and features need to know of a robot's hand and arm."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from domains.tabletop.state import PINCH, SIDE, TOP
from runtime.robot.approach import Family
from runtime.robot.model import RobotModel
from runtime.world.poses import Floats

PLAY = 0.003
"""Metres kept on the outside of each finger."""

SIDEWAYS = 0.02
"""Metres added on both sides of hand and arm: where less is left, few postures come through."""

FAMILY = {SIDE: Family.SIDE, TOP: Family.TOP, PINCH: Family.PINCH}


@dataclass(frozen=True, eq=False)
class Hand:
    """A parallel gripper and the arm behind it. Metres, newtons, newton metres.

    From the grasp centre, along the approach: the fingers end `tip` in front of it and the palm
    is `back` behind it; `pad` is half the height of the fingers. `sweeps[f]` are the volumes
    (v, 7) that an approach of family f sweeps, as `features.swept` takes them.
    """

    robot: RobotModel
    tip: float
    back: float
    pad: float
    clearance: float
    max_opening: float
    max_weight: float
    max_torque: float
    sweeps: tuple[Floats, ...]

    @cached_property
    def finger_width(self) -> float:
        """Metres beside what is gripped that a finger needs, its play included."""
        rows = self.sweeps[TOP]
        return float(rows[rows[:, 6] == 1.0, 3].max())

    def workspace(self, family: int, height: float) -> tuple[float, float, float] | None:
        """Where the wrist has to be for a grasp centre at a height above the floor: how far
        behind the centre it is, and from where to where from the shoulder axis; None where the
        arm does not reach."""
        inner, outer, wrist = self.robot.workspace(FAMILY[family], height)
        return (wrist, inner, outer) if outer > inner else None


def hand_of(robot: RobotModel) -> Hand:
    """The hand of a robot, as kinematics derives it."""
    side = robot.approach(Family.SIDE)
    gripper = robot.gripper
    return Hand(
        robot=robot,
        tip=float(side.fingers[:, 1].max()),
        back=-float(side.hand[:, 1].max()),
        pad=float(side.fingers[:, 5].max()),
        clearance=gripper.clearance,
        max_opening=gripper.max_opening,
        max_weight=9.81 * (gripper.payload or math.inf),
        max_torque=gripper.max_torque or math.inf,
        sweeps=tuple(_volumes(robot, family) for family in (SIDE, TOP, PINCH)),
    )


def _volumes(robot: RobotModel, family: int) -> Floats:
    """The volumes (v, 7) of a family: the fingers with all that is between them, then hand and
    arm."""
    approach = robot.approach(FAMILY[family])
    wide = 4 if family == PINCH else 2
    fingers = approach.fingers.copy()
    outwards = fingers[:, wide + 1] + robot.gripper.clearance + PLAY
    fingers[:, wide], fingers[:, wide + 1] = -outwards, outwards
    axis = np.full((len(fingers), 1), 2.0 if family == PINCH else 1.0)
    rest = approach.hand_and_arm.copy()
    rest[:, 2] -= SIDEWAYS
    rest[:, 3] += SIDEWAYS
    rows: Floats = np.unique(np.hstack([fingers, axis]), axis=0)
    return np.vstack([rows, np.hstack([rest, np.zeros((len(rest), 1))])])
