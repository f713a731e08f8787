"""What further actions need of the arm: postures and straight lines, by poses in the world."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from domains.tabletop.actions.reach import ReachSolver
from domains.tabletop.state import State
from domains.tabletop.world import TabletopWorld
from runtime.kernels.convex import join, seen_from
from runtime.motion import rrt
from runtime.motion.arm_context import CONTACT_MARGIN, FLOOR, ArmContext
from runtime.robot.model import Floats
from runtime.world.body import Part
from runtime.world.poses import Pose, compose, invert, upright

NEAR = 1.3
"""Metres around the base axis within which things matter to the arm."""


@dataclass(frozen=True, eq=False)
class Arm:
    """The arm of the robot where it stands in a state. Metres, radians.

    `seeds` is how hard inverse kinematics may try; all that is random comes from `seed`.
    """

    world: TabletopWorld
    solver: ReachSolver
    state: State
    seeds: int
    seed: int

    def among(
        self, opening: float, held: Sequence[Part] = (), without: Collection[int] = ()
    ) -> ArmContext:
        """The arm with its fingers `opening` metres apart, among all that stands but for some
        objects. `held` are solids in the tool frame that move along with the hand."""
        x, y, yaw = self.state.base.pose
        obstacles = self.world.obstacles(self.state.placements, without)
        body = self.world.robot.body(opening, tuple(held))
        near = join(seen_from(obstacles, x, y, yaw, NEAR), FLOOR)
        return ArmContext(self.world.robot, body, near)

    def postures(self, context: ArmContext, tool: Pose) -> Iterator[Floats]:
        """Configurations (n,), free of contact, that bring the tool to a pose (3, 4) in the
        world."""
        return self.solver.postures(context, self._local(tool), self.seeds, self.seed)

    def line(self, tool: Pose, offset: Floats, start: Floats) -> Floats | None:
        """Configurations (p, n) from `start`, where the tool is at a pose (3, 4) in the world,
        that move it straight by `offset` (3,) without turning it; way points are evenly spaced.
        None where the arm cannot."""
        yaw = self.state.base.pose[2]
        return self.solver.line(
            self._local(tool), upright(0.0, 0.0, 0.0, -yaw)[:, :3] @ offset, start
        )

    def is_free(self, context: ArmContext, path: Floats) -> bool:
        """Whether the arm, near what it touches, is free of contact along configurations."""
        return context.path_is_free(path, CONTACT_MARGIN)

    def way(self, context: ArmContext, start: Floats, goal: Floats) -> Floats | None:
        """A free path (p, n) between two configurations; None where none was found."""
        return rrt.plan(context, start, goal, self.seed)

    def ahead(self, opening: float) -> float:
        """Metres that the hand reaches ahead of the grasp centre, along its approach."""
        return self.solver.ahead(opening)

    def _local(self, tool: Pose) -> Pose:
        x, y, yaw = self.state.base.pose
        return compose(invert(upright(x, y, 0.0, yaw)), np.asarray(tool))
