"""What hand, wrist and forearm sweep on their way to a grasp.

The hand is rigid: its boxes are exact. Wrist and forearm depend on the posture: space belongs
to them where it is taken in nearly all postures that reach the grasp, so that an object there
is in the way whatever the arm does.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from runtime.robot.approach import Approach, Family
from runtime.robot.model import RobotModel
from runtime.robot.outline import outline
from runtime.robot.reachable import Posture, in_frame, tools
from runtime.world.poses import Pose, apply, compose, invert
from runtime.world.solids import Floats

TRAVEL = 0.10
"""Metres of the straight way in, along the direction of approach."""

CELL = 0.02
LOW = np.array([-0.9, -0.4, -0.5])
HIGH = np.array([0.3, 0.4, 0.9])

NEARLY_ALL = 0.8
"""Space is taken where so many of the postures take it."""

OFTEN = 0.4
"""A height of a column counts as taken where so many of the postures take it."""

BESIDE = {Family.SIDE: (-0.06, 0.12), Family.PINCH: (-0.06, 0.12), Family.TOP: (0.0, 0.3)}
"""Heights above the grasp centre that things beside an object reach to: those that stand there
are as tall as it for a hand from the side, and matter for one from above if they are taller."""

POSTURES = 200
"""So many of the postures that were found are looked at, evenly over heights and distances."""

SLAB = 0.08
"""Metres of one box of the arm, along the way back."""


def hand_boxes(robot: RobotModel, family: Family) -> tuple[Floats, Floats]:
    """Boxes of the hand (h, 6) and of the fingers of one side (f, 6) in the approach frame, at
    the grasp; the fingers are measured from the face of their pad (`Approach`)."""
    # Either way in which the hand can be turned: boxes hold both.
    turned = tools(family, 0.0)
    back = invert(robot.tool)
    fingers = {finger.part for finger in robot.finger_parts}
    hand = []
    for index, part in enumerate(robot.parts):
        if part.frame == len(robot.joints) and index not in fingers:
            cloud = apply(compose(back, part.shape.pose), outline(part.shape.solid))
            hand.append(_around([apply(tool, cloud) for tool in turned]))
    opening = robot.gripper.max_opening
    values = np.array([*robot.gripper.joint_values(opening).values()])
    sides = dict(robot.gripper.fingers)
    found = []
    for finger in robot.finger_parts:
        # Mirrored to one side, and both flips: z in the tool frame changes its sign.
        cloud = apply(
            compose(back, finger.pose(values)), outline(robot.parts[finger.part].shape.solid)
        )
        cloud = cloud * (1.0, sides.get(finger.part, 1.0), 1.0) - (0.0, opening / 2, 0.0)
        flipped = cloud * (1.0, 1.0, -1.0)
        found.append(_around([apply(turned[0], cloud), apply(turned[0], flipped)]))
    return np.array(hand).reshape(-1, 6), np.array(found).reshape(-1, 6)


def _around(clouds: Sequence[Floats]) -> list[float]:
    """The box around points, as a row."""
    points = np.vstack(clouds)
    pairs = zip(points.min(axis=0).tolist(), points.max(axis=0).tolist(), strict=True)
    return [value for pair in pairs for value in pair]


def _swept(boxes: Floats, family: Family) -> Floats:
    """Boxes drawn out along the way in."""
    swept = boxes.copy()
    if family is Family.TOP:
        swept[:, 5] += TRAVEL
    else:
        swept[:, 0] -= TRAVEL
    return swept


def approach_of(robot: RobotModel, family: Family, postures: Sequence[Posture]) -> Approach:
    """What a family sweeps, from some postures at its grasps."""
    hand, fingers = hand_boxes(robot, family)
    arm = _arm_boxes(robot, family, postures)
    return Approach(family, _swept(hand, family), _swept(arm, family), _swept(fingers, family))


def _arm_boxes(robot: RobotModel, family: Family, postures: Sequence[Posture]) -> Floats:
    """Boxes around the columns that wrist and forearm cross, at the height of things that stand
    beside the grasp, in nearly all postures: one for each slab of the way back. They reach from
    the lowest to the highest places that are often taken there."""
    if not postures:
        return np.empty((0, 6))
    postures = postures[:: math.ceil(len(postures) / POSTURES)]
    columns = np.zeros(np.round((HIGH - LOW) / CELL).astype(int)[:2], dtype=np.int64)
    counts = np.zeros(np.round((HIGH - LOW) / CELL).astype(int), dtype=np.int64)
    first, last = (int((z - LOW[2]) / CELL) for z in BESIDE[family])
    for posture in postures:
        frames = robot.frames(posture.q)
        taken = np.zeros(counts.shape, dtype=bool)
        for part in robot.parts:
            if 0 < part.frame < len(robot.joints):
                pose = in_frame(posture, compose(frames[part.frame], part.shape.pose))
                _fill(taken, pose, part.shape.half)
        counts += taken
        columns += taken[:, :, first:last].any(axis=2)
    often = columns >= NEARLY_ALL * len(postures)
    cells = np.argwhere(often)
    slabs = cells[:, 0] // max(1, round(SLAB / CELL))
    boxes = []
    for slab in sorted(set(slabs.tolist())):
        inside = cells[slabs == slab]
        low, high = LOW[:2] + inside.min(axis=0) * CELL, LOW[:2] + (inside.max(axis=0) + 1) * CELL
        heights = counts[inside[:, 0], inside[:, 1]].max(axis=0)
        taken_at = np.flatnonzero(heights >= OFTEN * len(postures))
        if len(taken_at):
            bottom, top = LOW[2] + taken_at[0] * CELL, LOW[2] + (taken_at[-1] + 1) * CELL
            boxes.append([low[0], high[0], low[1], high[1], bottom, top])
    return np.array(boxes).reshape(-1, 6)


def _fill(taken: np.ndarray, pose: Pose, half: Floats) -> None:
    """Mark the cells whose middle is in an oriented box."""
    reach = np.abs(pose[:, :3]) @ half
    first = np.maximum(0, np.floor((pose[:, 3] - reach - LOW) / CELL)).astype(int)
    last = np.minimum(taken.shape, np.ceil((pose[:, 3] + reach - LOW) / CELL)).astype(int)
    if (last <= first).any():
        return
    axes = [LOW[k] + (np.arange(first[k], last[k]) + 0.5) * CELL - pose[k, 3] for k in range(3)]
    x, y, z = np.meshgrid(*axes, indexing="ij", sparse=True)
    inside = np.ones(tuple(last - first), dtype=bool)
    for k in range(3):
        along = x * pose[0, k] + y * pose[1, k] + z * pose[2, k]
        inside &= np.abs(along) <= half[k]
    taken[first[0] : last[0], first[1] : last[1], first[2] : last[2]] |= inside
