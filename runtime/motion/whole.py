"""Collision questions about a robot whose base and arm move at once.

The base is three more joints below the chain: x, y and heading. So the kernels that test an arm
test the whole robot, in the frame of the world.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from runtime.kernels import advance
from runtime.kernels.convex import Obstacles, join
from runtime.motion.arm_context import FLOOR, FREE_MARGIN
from runtime.robot.model import HELD_EXTENT, Body, Chain, Floats, Ints, RobotModel

BASE = 3
"""Joints of the base."""

TURN = np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]])
"""Joints act along their z: so that of the first is x, that of the second y, and the third is
upright again."""


@lru_cache(maxsize=8)
def whole_chain(robot: RobotModel) -> Chain:
    """The chain of base and arm."""
    return Chain(
        np.concatenate([np.tile(TURN, (BASE, 1, 1)), robot.chain.origins]),
        np.concatenate([[True, True, False], robot.chain.prismatic]),
    )


@lru_cache(maxsize=8)
def whole_sweep(robot: RobotModel) -> Floats:
    """How far a part of each frame moves for one unit of each joint, as `RobotModel.sweep`; not
    to be written to."""
    n = len(robot.joints)
    lengths = np.linalg.norm(robot.chain.origins[:, :, 3], axis=1)
    travel = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
    lengths = lengths + np.where(robot.chain.prismatic, travel, 0.0)
    sweep = np.zeros((n + 1 + BASE, n + BASE))
    sweep[BASE:, BASE:] = robot.sweep
    sweep[1:, 0] = sweep[2:, 1] = 1.0
    for frame in range(n + 1):
        reaches = [robot.reach_of(i, p) for i, p in enumerate(robot.parts) if p.frame == frame]
        extent = max(reaches, default=0.0)
        if frame == n:
            extent = max(extent, float(np.linalg.norm(robot.tool[:, 3])) + HELD_EXTENT)
        sweep[BASE + frame, 2] = extent + float(lengths[:frame].sum())
    return sweep


@dataclass(frozen=True, eq=False)
class Whole:
    """A robot with a body (fingers open, or holding something) among obstacles in the world.
    Rows are base pose and configuration, (k, 3 + n)."""

    robot: RobotModel
    body: Body
    obstacles: Obstacles

    @cached_property
    def _chain(self) -> Chain:
        return whole_chain(self.robot)

    @cached_property
    def _body(self) -> Body:
        return self.body._replace(frame=self.body.frame + BASE)

    @cached_property
    def _around(self) -> Obstacles:
        return join(self.obstacles, FLOOR)

    @cached_property
    def _lowest(self) -> Ints:
        """The frames from which on obstacles matter: the floor is not in the way of the base, and
        nothing in that of a fixed one, which stands flush on its desk and never moves."""
        everywhere = BASE + 1 if self.robot.base.type == "fixed" else 0
        lowest = np.full(len(self._around.rows), everywhere, dtype=np.int64)
        lowest[-1] = BASE + 1
        return lowest

    @cached_property
    def _sweep(self) -> Floats:
        robot, body = self.robot, self.body
        sweep = whole_sweep(robot).copy()
        moving = body.frame == len(robot.joints)
        reach = np.linalg.norm(body.pose[moving, :, 3], axis=1) + body.radius[moving]
        beyond = float(reach.max(initial=0.0)) - float(np.linalg.norm(robot.tool[:, 3]))
        turning = ~self._chain.prismatic
        sweep[-1, turning] += max(0.0, beyond - HELD_EXTENT)
        return sweep

    def first_hit(self, rows: Floats, margin: float = FREE_MARGIN) -> int | None:
        """The number of a row near which a motion comes within the margin of something; None where
        it is free, in between rows as well."""
        rows = np.ascontiguousarray(rows)
        hit = advance.first_hit(
            self._chain, self._body, self._around, self._lowest, margin, self._sweep, rows
        )
        return None if hit < 0 else int(hit)

    def is_free(self, rows: Floats, margin: float = FREE_MARGIN) -> bool:
        """Whether a motion is free, in between rows as well."""
        return self.first_hit(rows, margin) is None
