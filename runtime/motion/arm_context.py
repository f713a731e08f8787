"""Collision questions about one arm standing at one base pose."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from runtime.kernels import arm
from runtime.robot.model import HELD_EXTENT, Body, Floats, RobotModel

FREE_MARGIN = 0.004
"""Metres that free motions keep from everything, in the kernel's eyes."""

CONTACT_MARGIN = 0.001
"""Metres kept near contact: objects rest 2 mm above the tables in the published scenes."""


@dataclass(frozen=True, eq=False)
class ArmContext:
    """A robot with a body (fingers open or holding) among boxes in its base frame (w, 8)."""

    robot: RobotModel
    body: Body
    world: Floats
    _frames: Floats = field(init=False)
    _placed: Floats = field(init=False)
    sweep: Floats = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_frames", np.empty((len(self.robot.joints) + 1, 3, 4)))
        object.__setattr__(self, "_placed", np.empty((len(self.body.frame), 3, 4)))
        object.__setattr__(self, "sweep", self._enlarged_sweep())

    def _enlarged_sweep(self) -> Floats:
        """The robot's sweep, enlarged where the last box, a held one, sticks out further."""
        robot, body = self.robot, self.body
        extent = float(np.linalg.norm(body.pose[-1, :, 3]) + body.radius[-1])
        beyond = extent - float(np.linalg.norm(robot.tool[:, 3])) - HELD_EXTENT
        if beyond <= 0.0:
            return robot.sweep
        sweep = robot.sweep.copy()
        sweep[-1, ~robot.chain.prismatic] += beyond
        return sweep

    def collides(self, q: Floats, margin: float = FREE_MARGIN) -> bool:
        """Whether the arm at q (n,) touches the world or itself."""
        hit: bool = arm.collides(
            *self.robot.chain, *self.body, self.world, margin, q, self._frames, self._placed
        )
        return hit

    def path_is_free(self, path: Floats, margin: float = FREE_MARGIN) -> bool:
        """Whether the polyline of configurations (p, n) is free, in between as well."""
        hit = arm.path_collides(*self.robot.chain, *self.body, self.world, margin, self.sweep, path)
        return bool(hit < 0)
