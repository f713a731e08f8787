"""The posture in which a robot carries something: home, where that is possible.

It is not where what is held would touch the robot there, or where what stands on that would
slide off. Then the arm goes to another posture for as long as it carries it: of those found at
random the one that takes up the least room.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels import ik
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

APART = 0.3
"""Metres by which the tool strays from where it is at home, where it is kept level."""

ITERATIONS = 80

LEVEL = 0.02
"""Radians by which what is kept level may lean."""


def carrying(robot: RobotModel, body: Body, up: Floats | None, seed: int) -> Floats | None:
    """A posture (n,) to carry something in, None where none is found. `body` is the robot with
    what it holds; `up` (3,) is the direction of the tool frame that is to point up, None where
    any will do."""
    alone = ArmContext(robot, body, np.empty((0, 8)))
    home = robot.home
    if (up is None or lean_of(robot.tool_pose(home), up) < LEVEL) and not alone.collides(home):
        return home
    rng = np.random.default_rng(seed)
    found: list[tuple[float, Floats]] = []
    for number in range(TRIES):
        q = _stray(robot, rng, number / TRIES)
        if up is not None and not _levelled(robot, q, up, rng):
            continue
        rings = footprint(robot, body, q).rings
        if alone.collides(q, FREE_MARGIN) or _is_low(robot, body, rings):
            continue
        widest = float(rings[:, 2].max())
        found.append((widest + 0.02 * float(np.abs(q - home).max()), q))
        if len(found) == ENOUGH:
            break
    return min(found, key=lambda each: each[0])[1] if found else None


def lean_of(tool: Pose, up: Floats) -> float:
    """Radians between the vertical and a direction of the tool frame (3,), the tool at a pose
    (3, 4)."""
    return math.acos(max(-1.0, min(1.0, float(tool[2, :3] @ up))))


def level_rotation(up: Floats, yaw: float) -> Floats:
    """A rotation (3, 3) that turns a direction (3,) up, and then about the vertical."""
    side = np.eye(3)[int(np.argmin(np.abs(up)))]
    x = side - (side @ up) * up
    x /= np.linalg.norm(x)
    flat = np.array([x, np.cross(up, x), up])
    c, s = math.cos(yaw), math.sin(yaw)
    turned: Floats = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ flat
    return turned


def _stray(robot: RobotModel, rng: np.random.Generator, share: float) -> Floats:
    spread = STRAY * (0.1 + 0.9 * share) * np.minimum(1.0, (robot.upper - robot.lower) / 2)
    q: Floats = np.clip(robot.home + rng.normal(size=len(robot.home)) * spread,
                        robot.lower, robot.upper)  # fmt: skip
    return q


def _levelled(robot: RobotModel, q: Floats, up: Floats, rng: np.random.Generator) -> bool:
    """Bring the tool level near where it is at home, by inverse kinematics from q, in place."""
    place = robot.tool_pose(robot.home)[:, 3] + rng.normal(size=3) * (APART / 2)
    rotation = level_rotation(up, rng.uniform(-math.pi, math.pi))
    target = np.column_stack([rotation, place])
    solved: bool = ik.solve(
        *robot.chain, robot.lower, robot.upper, robot.tool, target, q, ITERATIONS
    )
    return solved


def _is_low(robot: RobotModel, body: Body, rings: Floats) -> bool:
    """Whether something that the arm moves is in the floor."""
    moved = body.frame > 0
    return bool(moved.any() and rings[moved, 0].min() < FREE_MARGIN)
