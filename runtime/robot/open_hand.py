"""The open hand in the approach frame of each family: its poses, and boxes around its parts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from runtime.robot.approach import SLOPE, Family
from runtime.robot.gripper import FingerPart
from runtime.robot.model import RobotModel
from runtime.robot.outline import outline, slices
from runtime.world.poses import Pose, apply, compose, invert
from runtime.world.solids import Floats

KNUCKLE = 0.004
"""Metres of fingers, along the approach, that are looked at together."""

INWARDS = 0.001
"""Metres that a part of a finger may be nearer to the middle than its pad."""

FLAT = 0.0003
"""Metres by which points of a flat face may be further out than the innermost one."""

LEAST = 0.005
"""Metres that a face is wide and high, at least."""

SLICE = 0.02
"""Metres of a piece of a hand that comes aslant, or of a finger that leans outwards."""

LEANS = 0.8
"""Share of the box around a part of a finger that the boxes around its pieces take at most, where
they are worth their number."""


def tools(family: Family, turn: float) -> list[Pose]:
    """Both ways in which the tool can be in the approach frame. From above, `turn` is the angle
    between the direction in which the fingers close and the frame's y axis."""
    match family:
        case Family.SIDE:
            x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
        case Family.PINCH:
            x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        case Family.SLANT:
            x, y = np.array([SLOPE, 0.0, -SLOPE]), np.array([0.0, 1.0, 0.0])
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
            hand += [
                _around([apply(tool, piece) for tool in turned]) for piece in _pieces(cloud, family)
            ]
    gripper = robot.gripper
    opening = gripper.max_opening
    found = []
    for finger, cloud in _clouds(robot, back, opening):
        cloud = cloud - np.array([0.0, opening / 2, 0.0])
        advance = np.array([_advance(robot, finger, back), 0.0, 0.0])
        cloud = np.vstack([cloud, cloud + advance])
        found += _finger(cloud, family, turned[0])
    return np.array(hand).reshape(-1, 6), np.array(found).reshape(-1, 6)


def finger_boxes(robot: RobotModel, family: Family, opening: float) -> Floats:
    """Boxes (f, 6) of the fingers of one side in the approach frame, at the grasp, so far apart
    as they are then."""
    turned = tools(family, 0.0)[0]
    return np.array(
        [
            box
            for _, cloud in _clouds(robot, invert(robot.tool), opening)
            for box in _finger(cloud, family, turned)
        ]
    ).reshape(-1, 6)


def room_between(robot: RobotModel) -> float:
    """Metres behind the grasp centre, along the approach, in which nothing of the fingers is
    nearer to the middle than their pads, at any opening: knuckles of fingers that turn are."""
    back, room = invert(robot.tool), math.inf
    for opening in robot.gripper.openings.tolist():
        for _, cloud in _clouds(robot, back, opening):
            for piece in slices(cloud, KNUCKLE):
                if piece[:, 1].min() < opening / 2 - INWARDS and piece[:, 0].max() < 0:
                    room = min(room, -float(piece[:, 0].max()))
    return room


def flat_of(robot: RobotModel) -> Floats | None:
    """Where the faces of both fingers are flat and nearest to each other: the lowest and the
    highest x and z (2, 2) in the tool frame; None where that is next to nothing, as between
    fingers that turn."""
    gripper = robot.gripper
    opening = (gripper.min_opening + gripper.max_opening) / 2
    sides: dict[float, list[Floats]] = {}
    names = dict(gripper.fingers)
    for finger, cloud in _clouds(robot, invert(robot.tool), opening):
        sides.setdefault(names.get(finger.part, 1.0), []).append(cloud)
    low, high = np.full(2, -np.inf), np.full(2, np.inf)
    for clouds in sides.values():
        points = np.vstack(clouds)
        face = points[points[:, 1] <= points[:, 1].min() + FLAT][:, [0, 2]]
        low, high = np.maximum(low, face.min(axis=0)), np.minimum(high, face.max(axis=0))
    return np.array([low, high]) if sides and (high - low >= LEAST).all() else None


def _pieces(cloud: Floats, family: Family) -> list[Floats]:
    """Points in the tool frame; cut up for a hand that is aslant, where one box around all of them
    would be much too large."""
    return slices(cloud, SLICE) if family is Family.SLANT else [cloud]


def _finger(cloud: Floats, family: Family, tool: Pose) -> list[list[float]]:
    """Boxes around a part of a finger, points in the tool frame: one, or several where it leans so
    much that they take less room."""
    whole = _around(_both_ways(cloud, tool))
    pieces = [_around(_both_ways(piece, tool)) for piece in slices(cloud, SLICE)]
    worth = sum(_volume(box) for box in pieces) <= LEANS * _volume(whole)
    return pieces if family is Family.SLANT or worth else [whole]


def _volume(box: Sequence[float]) -> float:
    """Cubic metres of a box, a row."""
    return (box[1] - box[0]) * (box[3] - box[2]) * (box[5] - box[4])


def _both_ways(cloud: Floats, tool: Pose) -> list[Floats]:
    """Points of the tool frame in the approach frame, either way in which the hand may be
    turned over."""
    return [apply(tool, cloud * (1.0, 1.0, flip)) for flip in (1.0, -1.0)]


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
