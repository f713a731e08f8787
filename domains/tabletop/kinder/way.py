"""A plan as one way through configurations, cut where the hand takes or lets go.

A configuration is ten numbers: base x, y and heading, then the joints. Steps go from one point of
the way to another one, as far as a step may go and as the way is straight.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from runtime.motion.motion import ArmMove, BaseMove, GripperMove, Together
from runtime.plan.model import Plan
from runtime.world.poses import Floats

DENSE = 0.02
"""Metres or radians between the points of a way, at most, in any coordinate."""

RISE = 0.03
"""Metres of a way up from something that are gone aside of what touches it."""

STRAIGHT = 0.01
"""Metres or radians by which the way may bend aside of a step, in any coordinate."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """A way (k, 10) without a change in the hand, and what the hand does at its end: takes or lets
    go of a body, by a gripper move; None at the end of the plan. `action` says in a line which
    action it is of."""

    way: Floats
    end: GripperMove | None
    action: str


def stretches(plan: Plan, start: Floats) -> list[Stretch]:
    """The ways of a plan from a configuration (10,)."""
    found: list[Stretch] = []
    rows = [start]
    text = ""
    for action in plan.actions:
        text = action.text
        for timed in action.pieces:
            match timed.piece:
                case BaseMove(poses=poses):
                    rows += [np.concatenate([p, rows[-1][3:]]) for p in _on_from(rows[-1], poses)]
                case ArmMove(path=path):
                    rows += [np.concatenate([rows[-1][:3], q]) for q in path]
                case Together(poses=poses, path=path):
                    rows += list(np.hstack([_on_from(rows[-1], poses), path]))
                case GripperMove(attach=None, release=None):
                    pass  # the fingers are open already
                case GripperMove() as grip:
                    found.append(Stretch(dense(rows), grip, text))
                    rows = [rows[-1]]
    found.append(Stretch(dense(rows), None, text))
    return found


def _on_from(row: Floats, poses: Floats) -> Floats:
    """Base poses (k, 3) with headings that go on from that of a row: in a plan every piece may
    count its turns anew."""
    turns = np.round((row[2] - poses[0, 2]) / (2 * math.pi))
    found = poses.copy()
    found[:, 2] += 2 * math.pi * turns
    return found


def dense(rows: Iterable[Floats]) -> Floats:
    """The same way (k, 10) with points between those that are far from each other; points that
    repeat the one before are left out."""
    given = list(rows)
    found = [given[0]]
    for row in given[1:]:
        before = found[-1]
        largest = float(np.abs(row - before).max())
        if largest < 1e-7:
            continue
        parts = math.ceil(largest / DENSE)
        found += [before + (row - before) * (k / parts) for k in range(1, parts + 1)]
    return np.array(found)


def furthest(way: Floats, index: int, limit: float) -> int:
    """How far along a way a step can go from one of its points: the index of the last point that
    no coordinate is further away from than the limit, the way in between being straight."""
    last = index
    for ahead in range(index + 1, len(way)):
        step = way[ahead] - way[index]
        if float(np.abs(step).max()) > limit:
            break
        between = way[index + 1 : ahead]
        length = float(step @ step)
        if len(between) and length > 0:
            along = (between - way[index]) @ step / length
            aside = between - way[index] - along[:, None] * step
            if float(np.abs(aside).max()) > STRAIGHT:
                continue
        last = ahead
    return last


def stopped_above(way: Floats, heights: Floats, above: float) -> Floats:
    """A way that ends going down, cut where the hand is still so far above the end. `heights` (k,)
    are those of the hand."""
    low = heights[-1]
    k = len(way) - 1
    while k > 0 and heights[k - 1] - low < above and heights[k - 1] > low - 1e-9:
        k -= 1
    if k == 0 or heights[k - 1] <= low:
        return way
    share = (heights[k - 1] - low - above) / (heights[k - 1] - heights[k])
    return np.vstack([way[:k], way[k - 1] + min(1.0, max(0.0, share)) * (way[k] - way[k - 1])])


def gone_aside(way: Floats, heights: Floats, aside: tuple[float, float]) -> Floats:
    """A way (k, 10) that begins going up, its low part so far aside (x, y), to which it goes first.
    `heights` (k,) are those of the hand."""
    low = int((heights > heights[0] + RISE).argmax()) or len(way)
    moved = way[:low].copy()
    moved[:, :2] += aside
    return np.vstack([way[:1], moved, way[low:]])
