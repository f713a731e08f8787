"""The posture in which a robot carries something: home, where that is possible.

It is not where what is held would touch the robot there, or where what stands on that would
slide off. Then the arm goes to another posture for as long as it carries it: of those found at
random the one that takes up the least room.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from runtime.motion.arm_context import FREE_MARGIN, ArmContext
from runtime.motion.base import footprint
from runtime.robot.model import Body, RobotModel
from runtime.world.poses import Floats, Pose

TRIES = 600
"""Postures that are looked at."""

ENOUGH = 16
"""Free ones of which the best is taken."""

STRAY = 1.2
"""Radians by which joints stray from home, the last of the tries (standard deviation)."""


def carrying(
    robot: RobotModel, body: Body, seed: int, among: Sequence[Floats] | None = None
) -> Floats | None:
    """A posture (n,) to carry something in, None where none is found. `body` is the robot with
    what it holds; `among` are postures to choose from, the best first, where not any will do."""
    alone = ArmContext(robot, body, np.empty((0, 8)))
    if among is not None:
        return next((q for q in among if _is_free(robot, alone, q)), None)
    if not alone.collides(robot.home):
        return robot.home
    rng = np.random.default_rng(seed)
    found: list[tuple[float, Floats]] = []
    for number in range(TRIES):
        q = stray(robot, rng, number / TRIES)
        if _is_free(robot, alone, q):
            found.append((room_taken(robot, body, q), q))
            if len(found) == ENOUGH:
                break
    return min(found, key=lambda each: each[0])[1] if found else None


def room_taken(robot: RobotModel, body: Body, q: Floats) -> float:
    """How far from its axis a robot reaches in a posture, metres, and a little for how far that
    is from home."""
    widest = float(footprint(robot, body, q).rings[:, 2].max())
    return widest + 0.02 * float(np.abs(q - robot.home).max())


def _is_free(robot: RobotModel, alone: ArmContext, q: Floats) -> bool:
    """Whether the robot touches neither itself nor the floor."""
    if alone.collides(q, FREE_MARGIN):
        return False
    moved = alone.body.frame > 0
    lows = footprint(robot, alone.body, q).rings[moved, 0]
    return bool(lows.min(initial=np.inf) > FREE_MARGIN)


def lean_of(tool: Pose, up: Floats) -> float:
    """Radians between the vertical and a direction of the tool frame (3,), the tool at a pose
    (3, 4)."""
    return math.acos(max(-1.0, min(1.0, float(tool[2, :3] @ up))))


def stray(robot: RobotModel, rng: np.random.Generator, share: float) -> Floats:
    """A configuration (n,) near home; the greater the share (0 to 1), the further away."""
    spread = STRAY * (0.1 + 0.9 * share) * np.minimum(1.0, (robot.upper - robot.lower) / 2)
    q = robot.home + rng.normal(size=len(robot.home)) * spread
    return np.clip(q, robot.lower, robot.upper)
