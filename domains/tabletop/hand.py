"""What grasps and features need to know of a robot's hand and arm."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from domains.tabletop.state import PINCH, SIDE, TOP
from runtime.robot.model import Floats, RobotModel


@dataclass(frozen=True, eq=False)
class Hand:
    """A parallel gripper and the arm behind it. Metres, newtons, newton metres.

    From the grasp centre, along the approach: the fingers end `tip` in front of it and the palm
    is `back` behind it; `pad` is half the height of the fingers. `sweeps[f]` are the volumes
    (v, 7) that an approach of family f sweeps, as `features.swept` takes them.
    """

    tip: float
    back: float
    pad: float
    clearance: float
    max_opening: float
    max_weight: float
    max_torque: float
    sweeps: tuple[Floats, ...]
    reach: tuple[float, float, float]

    def workspace(self, family: int, height: float) -> tuple[float, float, float] | None:
        """Where the wrist has to be for a grasp centre at a height above the floor: how far
        behind the centre it is, and from where to where from the shoulder axis; None where the
        arm does not reach."""
        return self.reach


def hand_of(robot: RobotModel) -> Hand:
    """The hand of a robot."""
    strip = robot.strip
    pad = 0.012
    fingers = [-strip.finger_back, strip.finger_tip]
    thick = strip.finger_width
    wide = strip.arm_half_width
    side = [
        [*fingers, -thick, thick, -pad, pad, 1.0],
        [-strip.arm_length, -strip.finger_back, -wide, wide, -0.05, 0.2, 0.0],
    ]
    top = [
        [-pad, pad, -thick, thick, -strip.finger_tip, strip.finger_back, 1.0],
        [-0.06, 0.06, -wide, wide, strip.finger_back, strip.arm_length, 0.0],
    ]
    pinch = [
        [*fingers, -pad, pad, -thick, thick, 2.0],
        [-strip.arm_length, -strip.finger_back, -0.05, 0.05, -wide, wide, 0.0],
    ]
    sweeps: list[Floats] = [np.zeros((0, 7))] * 3
    sweeps[SIDE], sweeps[TOP], sweeps[PINCH] = np.array(side), np.array(top), np.array(pinch)
    return Hand(
        tip=strip.finger_tip,
        back=strip.finger_back,
        pad=pad,
        clearance=robot.gripper.clearance,
        max_opening=robot.gripper.max_opening,
        max_weight=math.inf,
        max_torque=math.inf,
        sweeps=tuple(sweeps),
        reach=(robot.annulus.wrist_offset, robot.annulus.inner, robot.annulus.outer),
    )
