"""Collision questions about one arm standing at one base pose."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from runtime.kernels import advance, arm
from runtime.kernels.convex import Obstacles, boxes_only
from runtime.robot.model import HELD_EXTENT, Body, Floats, RobotModel

FREE_MARGIN = 0.004
"""Metres that free motions keep from everything, in the kernel's eyes."""

CONTACT_MARGIN = 0.001
"""Metres kept near contact: objects rest 2 mm above the tables in the published scenes."""


FLOOR = boxes_only(np.array([[0.0, 0.0, -0.5, 1e3, 1e3, 0.5, 1.0, 0.0]]))
"""The floor, in the frame of any base that stands on it."""


@dataclass(frozen=True, eq=False)
class ArmContext:
    """A robot with a body (fingers open or holding) among obstacles in its base frame; upright
    boxes (w, 8) will do for them."""

    robot: RobotModel
    body: Body
    around: Obstacles | Floats
    obstacles: Obstacles = field(init=False)
    _frames: Floats = field(init=False)
    _placed: Floats = field(init=False)
    sweep: Floats = field(init=False)
    lowest: NDArray[np.int64] = field(init=False)
    """The first frame whose parts an obstacle concerns (w,): all but those of the base."""

    def __post_init__(self) -> None:
        around = self.around
        obstacles = around if isinstance(around, Obstacles) else boxes_only(around)
        object.__setattr__(self, "obstacles", obstacles)
        object.__setattr__(self, "_frames", np.empty((len(self.robot.joints) + 1, 3, 4)))
        object.__setattr__(self, "_placed", np.empty((len(self.body.frame), 3, 4)))
        object.__setattr__(self, "sweep", self._enlarged_sweep())
        object.__setattr__(self, "lowest", np.ones(len(obstacles.rows), dtype=np.int64))

    def _enlarged_sweep(self) -> Floats:
        """The robot's sweep, enlarged where a held part sticks out further than most."""
        robot, body = self.robot, self.body
        if len(body.frame) == len(robot.parts):
            return robot.sweep  # it is that of the robot's own parts
        moving = body.frame == len(robot.joints)
        reach = np.linalg.norm(body.pose[moving, :, 3], axis=1) + body.radius[moving]
        extent = float(reach.max(initial=0.0))
        beyond = extent - float(np.linalg.norm(robot.tool[:, 3])) - HELD_EXTENT
        if beyond <= 0.0:
            return robot.sweep
        sweep = robot.sweep.copy()
        sweep[-1, ~robot.chain.prismatic] += beyond
        return sweep

    def collides(self, q: Floats, margin: float = FREE_MARGIN) -> bool:
        """Whether the arm at q (n,) touches an obstacle or itself."""
        hit: bool = arm.collides(
            self.robot.chain, self.body, self.obstacles, margin, q, self._frames, self._placed
        )
        return hit

    def first_barred(self, path: Floats, margin: float = FREE_MARGIN) -> int | None:
        """The number of a line of a polyline of configurations (p, n) that comes within the margin
        of something; None where there is none: then all of it keeps half the margin. Parts of
        the base are not tested against obstacles. A single point has no lines."""
        if len(path) < 2:
            return None
        # Columns of a whole motion lie apart: a kernel would be compiled for that layout, too.
        rows, line = advance.dense(np.ascontiguousarray(path))
        hit = advance.first_hit(
            self.robot.chain, self.body, self.obstacles, self.lowest, margin, self.sweep, rows
        )
        return None if hit < 0 else int(line[hit])

    def path_is_free(self, path: Floats, margin: float = FREE_MARGIN) -> bool:
        """Whether the polyline of configurations (p, n) is free, in between as well."""
        return self.first_barred(path, margin) is None
