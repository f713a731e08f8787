"""What the robot sees: where it is, where objects are, what it holds, what is in the way."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from domains.tabletop.loop.disturb import Disturber
from domains.tabletop.state import BasePose, Grasp, Placement, State
from domains.tabletop.world import Placements, TabletopWorld
from runtime.physics.execute import NEAR, UPRIGHT
from runtime.physics.simulation import Physics
from runtime.world.poses import Floats, Pose, compose, invert, upright
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


def state_of(world: TabletopWorld, seen: Seen, grasp: Grasp | None) -> State:
    """What was seen as a state of the planner.

    Raises:
        LostError: an object neither rests on a support nor is held.
    """
    n = len(seen.objects)
    placements: list[Placement | None] = [None] * n
    # What is below comes first: supports of what is above may belong to it.
    for index in sorted(range(n), key=lambda i: float(seen.objects[i][2])):
        if index == seen.held:
            continue
        body = matrix(seen.objects[index])[:3]
        item = max(world.faces[index], key=lambda item: compose(body, invert(item.standing))[2, 2])
        standing = compose(body, invert(item.standing))
        support = _support_below(world, tuple(placements), standing)
        if support is None or math.acos(min(1.0, abs(standing[2, 2]))) > UPRIGHT:
            raise LostError(
                f"{item.name} has fallen: the robot can only take what stands on a face"
            )
        placements[index] = world.relative(tuple(placements), support, standing, item.face)
    x, y, yaw = seen.base
    held = seen.held
    return State(
        BasePose.of(x, y, yaw),
        tuple(placements),
        held,
        grasp if held is not None else None,
        world=world,
    )


def _support_below(world: TabletopWorld, placements: Placements, standing: Pose) -> int | None:
    """The support on which something with a standing frame in the world (3, 4) rests: around a peg
    or a hole where its middle is over that."""
    order = sorted(range(len(world.grounds)), key=lambda i: world.grounds[i].peg is None)
    for number in order:
        ground = world.grounds[number]
        frame = (0.0, 0.0, 0.0, 0.0)
        if ground.owner is not None:
            below = world.bearer(placements, ground.owner)
            if below is None:
                continue
            frame = below
        local = compose(invert(upright(*frame)), standing)
        level = abs(local[2, 3] - ground.height) < NEAR
        x, y = local[:2, 3].tolist()
        if level and (ground.contains(x, y, -NEAR) if ground.peg is None else ground.is_over(x, y)):
            return number
    return None
