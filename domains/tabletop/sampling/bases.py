"""Base poses from which grasps can be taken."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from domains.tabletop.sampling.draw import BASES, Draw
from domains.tabletop.state import BasePose, Grasp, Placement
from domains.tabletop.world import Task
from runtime.kernels import plane

ROUNDS = 3
"""So many base poses for the same grasp, where there are few grasps."""

Wanted = Sequence[tuple[Placement | None, Grasp]]
"""Grasps of one object, and where it stands or is to stand."""


class BaseSampler:
    """Samples base poses for one task."""

    def __init__(self, task: Task) -> None:
        self.task = task

    def poses(self, draw: Draw, wanted: Sequence[Wanted]) -> list[BasePose]:
        """Base poses from which the wanted grasps can be taken: one grasp of every object
        first, then the next of every object, and again, up to a number for each surface."""
        limit = BASES * draw.scale
        count: dict[int, int] = {}
        bases: list[BasePose] = []
        for turn in range(ROUNDS * max((len(targets) for targets in wanted), default=0)):
            for targets in wanted:
                if turn >= ROUNDS * len(targets):
                    continue
                placement, grasp = targets[turn % len(targets)]
                if placement is None or count.get(placement.surface, 0) >= limit:
                    continue
                base = self.pose_for(placement, grasp, draw.rng)
                if base is not None:
                    bases.append(base)
                    count[placement.surface] = count.get(placement.surface, 0) + 1
        return bases

    def pose_for(
        self, placement: Placement, grasp: Grasp, rng: np.random.Generator
    ) -> BasePose | None:
        """A random base pose from which the wrist of a grasp is in the arm's workspace."""
        workspace = self.task.robot.annulus
        x, y, yaw = placement.pose
        heading = yaw + grasp.heading
        wx = x - workspace.wrist_offset * math.cos(heading)
        wy = y - workspace.wrist_offset * math.sin(heading)
        tries = 48
        # Straight behind the gripper is easiest for the arm; stray further try by try.
        bearing = heading + rng.normal(size=tries) * np.linspace(0.2, 1.2, tries)
        reach = rng.uniform(workspace.inner, workspace.outer, tries)
        turn = rng.uniform(-0.4, 0.4, tries)
        cx, cy = workspace.centre
        room = self.task.room
        for b, r, t in zip(bearing, reach, turn, strict=True):
            hx, hy = wx - r * math.cos(b), wy - r * math.sin(b)
            facing = math.atan2(y - hy, x - hx) + t
            c, s = math.cos(facing), math.sin(facing)
            bx, by = hx - c * cx + s * cy, hy - s * cx - c * cy
            if plane.in_room(*room, bx, by):
                return BasePose.of(bx, by, facing)
        return None
