"""The open hand in the approach frame of each family: its poses, and boxes around its parts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from runtime.robot.approach import Family
from runtime.robot.gripper import FingerPart
from runtime.robot.model import RobotModel
from runtime.robot.outline import outline
from runtime.world.poses import Pose, apply, compose, invert
from runtime.world.solids import Floats


def tools(family: Family, turn: float) -> list[Pose]:
    """Both ways in which the tool can be in the approach frame. From above, `turn` is the angle
    between the direction in which the fingers close and the frame's y axis."""
    match family:
        case Family.SIDE:
            x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
        case Family.PINCH:
            x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        case Family.TOP:
            x = np.array([0.0, 0.0, -1.0])
            y = np.array([-math.sin(turn), math.cos(turn), 0.0])
    found = []
    for side in (y, -y):
        pose = np.zeros((3, 4))
        pose[:, :3] = np.column_stack([x, side, np.cross(x, side)])
        found.append(pose)
    return found


def hand_boxes(robot: RobotModel, family: Family) -> tuple[Floats, Floats]:
    """Boxes of the hand (h, 6) and of the fingers of one side (f, 6) in the approach frame, at
    the grasp; the fingers are measured from the face of their pad (`Approach`), and reach as far
    ahead as they ever do: those that turn come forward as they close."""
    # Either way in which the hand can be turned: boxes hold both.
    turned = tools(family, 0.0)
    back = invert(robot.tool)
    fingers = {finger.part for finger in robot.finger_parts}
    hand = []
    for index, part in enumerate(robot.parts):
        if part.frame == len(robot.joints) and index not in fingers:
            cloud = apply(compose(back, part.shape.pose), outline(part.shape.solid))
            hand.append(_around([apply(tool, cloud) for tool in turned]))
    gripper = robot.gripper
    opening = gripper.max_opening
    found = []
    for finger, cloud in _clouds(robot, back, opening):
        cloud = cloud - np.array([0.0, opening / 2, 0.0])
        ahead = cloud + np.array([_advance(robot, finger, back), 0.0, 0.0])
        both = [each * (1.0, 1.0, flip) for each in (cloud, ahead) for flip in (1.0, -1.0)]
        found.append(_around([apply(turned[0], each) for each in both]))
    return np.array(hand).reshape(-1, 6), np.array(found).reshape(-1, 6)


def finger_boxes(robot: RobotModel, family: Family, opening: float) -> Floats:
    """Boxes (f, 6) of the fingers of one side in the approach frame, at the grasp, so far apart
    as they are then."""
    turned = tools(family, 0.0)[0]
    return np.array(
        [
            _around([apply(turned, cloud * (1.0, 1.0, flip)) for flip in (1.0, -1.0)])
            for _, cloud in _clouds(robot, invert(robot.tool), opening)
        ]
    ).reshape(-1, 6)


def _clouds(robot: RobotModel, back: Pose, opening: float) -> Iterator[tuple[FingerPart, Floats]]:
    """The outline (n, 3) of each finger part in the tool frame, mirrored to one side."""
    values = np.array([*robot.gripper.joint_values(opening).values()])
    sides = dict(robot.gripper.fingers)
    for finger in robot.finger_parts:
        points = outline(robot.parts[finger.part].shape.solid)
        cloud = apply(compose(back, finger.pose(values)), points)
        yield finger, cloud * (1.0, sides.get(finger.part, 1.0), 1.0)


def _advance(robot: RobotModel, finger: FingerPart, back: Pose) -> float:
    """Metres by which a finger reaches further ahead at some opening than at the widest."""
    points = outline(robot.parts[finger.part].shape.solid)
    reach = [
        float(apply(compose(back, finger.pose(values)), points)[:, 0].max())
        for values in robot.gripper.values
    ]
    return max(0.0, max(reach) - reach[-1])


def _around(clouds: Sequence[Floats]) -> list[float]:
    """The box around points, as a row."""
    points = np.vstack(clouds)
    pairs = zip(points.min(axis=0).tolist(), points.max(axis=0).tolist(), strict=True)
    return [value for pair in pairs for value in pair]
