"""What the robot sees: where it is, where objects are, what it holds, what is in the way."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from domains.tabletop.loop.disturb import Disturber
from domains.tabletop.state import BasePose, Grasp, Placement, State
from domains.tabletop.world import Task
from runtime.physics.execute import standing_on
from runtime.physics.simulation import Physics
from runtime.robot.model import Floats
from runtime.world.quaternions import matrix

LOOKS = 9
"""Measurements that are averaged while the robot stands still."""


class LostError(Exception):
    """Something is where the robot cannot deal with it; the text says what."""


@dataclass(frozen=True, eq=False)
class Seen:
    """Base pose (3,), poses (7,) of the objects' bottoms, the held object."""

    base: Floats
    objects: tuple[Floats, ...]
    held: int | None


class Senses:
    """Sensors of one execution; their noise is the disturber's."""

    def __init__(self, physics: Physics, disturber: Disturber) -> None:
        self.physics, self.disturber = physics, disturber

    def look(self, looks: int = 1) -> Seen:
        """One look, or the mean of several."""
        physics = self.physics
        spread = self.disturber.noise / math.sqrt(looks)
        poses = []
        for index in range(len(physics.objects)):
            pose = physics.object_pose(index)
            if spread and index != physics.held:
                pose = _blurred(pose, spread, self.disturber.rng)
            poses.append(pose)
        base = physics.robot_state()[0][:3]
        return Seen(base, tuple(poses), physics.held)


def _blurred(pose: Floats, spread: float, rng: np.random.Generator) -> Floats:
    x, y = pose[:2] + rng.normal(0.0, spread, 2)
    half = rng.normal(0.0, 10 * spread) / 2
    turn = np.array([0.0, 0.0, math.sin(half), math.cos(half)])
    ax, ay, az, aw = turn
    bx, by, bz, bw = pose[3:]
    product = [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
    return np.array([x, y, pose[2], *product])


def heading(pose: Floats) -> float:
    """The heading of a pose (7,)."""
    turn = matrix(pose)
    return math.atan2(turn[1, 0], turn[0, 0])


def state_of(task: Task, seen: Seen, grasp: Grasp | None) -> State:
    """What was seen as a state of the planner.

    Raises:
        LostError: an object neither stands on a table nor is held.
    """
    placements: list[Placement | None] = []
    for index, pose in enumerate(seen.objects):
        if index == seen.held:
            placements.append(None)
            continue
        surface = standing_on(task.scene, pose)
        if surface is None:
            name = task.scene.objects[index].name
            raise LostError(f"{name} has fallen: the robot can only take what stands on a table")
        placements.append(Placement.of(pose[0], pose[1], heading(pose), surface))
    held = seen.held
    x, y, yaw = seen.base
    return State(
        BasePose.of(x, y, yaw), tuple(placements), held, grasp if held is not None else None, task
    )
