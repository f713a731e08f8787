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
from runtime.robot.open_hand import hand_boxes
from runtime.robot.reachable import Posture, in_frame
from runtime.world.poses import Pose, compose
from runtime.world.solids import Floats

TRAVEL = 0.10
"""Metres of the straight way in, along the direction of approach."""

CELL = 0.02
LOW = np.array([-0.9, -0.4, -0.5])
HIGH = np.array([0.3, 0.4, 0.9])

ASLANT = 4
"""Stretches of a way in that is aslant, each with a box of its own."""

NEARLY_ALL = 0.8
"""Space is taken where so many of the postures take it."""

OFTEN = 0.4
"""A height of a column counts as taken where so many of the postures take it."""

BESIDE = {
    Family.SIDE: (-0.06, 0.12),
    Family.PINCH: (-0.06, 0.12),
    Family.SLANT: (0.0, 0.2),
    Family.TOP: (0.0, 0.3),
}
"""Heights above the grasp centre that things beside an object reach to: those that stand there
are as tall as it for a hand from the side, and matter for one from above if they are taller."""

POSTURES = 200
"""So many of the postures that were found are looked at, evenly over heights and distances."""

SLAB = 0.08
"""Metres of one box of the arm, along the way back."""


def drawn_out(boxes: Floats, family: Family) -> Floats:
    """Boxes (k, 6) drawn out along the way in."""
    ahead, up = family.ahead
    steps = ASLANT if ahead and up else 1
    swept = []
    for step in range(steps):  # boxes around stretches of the way: many, where that is aslant
        near, far = TRAVEL * step / steps, TRAVEL * (step + 1) / steps
        stretch = boxes.copy()
        stretch[:, 0] -= ahead * far
        stretch[:, 1] -= ahead * near
        stretch[:, 4] -= up * near
        stretch[:, 5] -= up * far
        swept.append(stretch)
    return np.vstack(swept)


def approach_of(robot: RobotModel, family: Family, postures: Sequence[Posture]) -> Approach:
    """What a family sweeps, from some postures at its grasps."""
    hand, fingers = hand_boxes(robot, family)
    arm = _arm_boxes(robot, family, postures)
    swept = (drawn_out(boxes, family) for boxes in (hand, arm, fingers))
    return Approach(family, *swept)


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
