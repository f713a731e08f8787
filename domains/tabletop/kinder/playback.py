"""A plan carried out in KinDER by bounded steps alone, each looked at when it is done.

The plan is what is played back, whatever happens. Every step starts where the robot is seen to
be, so that nothing adds up, and one that was refused is divided.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from domains.tabletop.kinder.observed import Observation
from domains.tabletop.kinder.problem import Problem
from domains.tabletop.kinder.process import KinderProcess
from domains.tabletop.kinder.slim import away_from
from domains.tabletop.kinder.way import Stretch, furthest, gone_aside, stopped_above, stretches
from domains.tabletop.scene.furniture import AIR
from runtime.motion.motion import GripperMove
from runtime.plan.model import Plan
from runtime.robot.model import RobotModel
from runtime.world.poses import Floats
from runtime.world.quaternions import matrix
from runtime.world.world import World

GAP = 0.0025
"""Metres above what it is put on at which something is let go: what touches is refused, and what
is 5 mm away is not let go."""

THERE = 1e-4
"""Metres or radians from where a step should have ended."""

TAKE, LEAVE = -1.0, 1.0
"""The gripper's number in an action that closes or opens it."""

MOST_STEPS = 20_000


class RefusedError(Exception):
    """KinDER does not do a step of the plan; says which."""


@dataclass(frozen=True, eq=False)
class Playback:
    """How a plan went: whether the goal was reached, after how many steps, how many of them were
    refused and done otherwise, and why it went no further."""

    terminated: bool
    steps: int
    refused: int
    reason: str | None = None


@dataclass(eq=False)
class Player:
    """Plays plans of a problem back. `off` is how much higher each body is than the plan has it,
    and `poses` its rotation (3, 3) there; `aside` is how far aside (x, y) what was taken last is to
    be lifted."""

    kinder: KinderProcess
    robot: RobotModel
    seen: Observation
    limit: float
    problem: Problem
    off: dict[str, float] = field(default_factory=dict)
    poses: dict[str, Floats] = field(default_factory=dict)
    aside: tuple[float, float] = (0.0, 0.0)
    steps: int = 0
    refused: int = 0

    def play(self, world: World, plan: Plan) -> Playback:
        """Carry out a plan from the start of an episode."""
        for thing in world.movables:
            bottom = self.seen.things[thing.name].bottom + self.problem.lift
            self.off[thing.name] = bottom - float(thing.pose[2, 3])
        self.poses = {thing.name: thing.pose[:, :3] for thing in world.movables}
        first = np.concatenate([self.seen.base, self.seen.joints])
        reason = None
        try:
            start = first + self._difference(np.concatenate([plan.base_start, self.robot.home]))
            for number, stretch in enumerate(stretches(plan, start)):
                if number == 0:
                    self._follow(np.array([first, start]), "to where the plan starts")
                self._stretch(stretch)
                if self.seen.terminated:
                    break
            else:
                reason = "the plan was carried out, and the goal was not reached"
        except RefusedError as error:
            reason = str(error)
        return Playback(self.seen.terminated, self.steps, self.refused, reason)

    def _stretch(self, stretch: Stretch) -> None:
        way, grip = stretch.way, stretch.end
        if any(self.aside):
            heights = np.array([self.robot.tool_pose(q)[2, 3] for q in way[:, 3:]])
            way, self.aside = gone_aside(way, heights, self.aside), (0.0, 0.0)
        if grip is not None and grip.release is not None:
            heights = np.array([self.robot.tool_pose(q)[2, 3] for q in way[:, 3:]])
            way = stopped_above(way, heights, self._above(grip))
        self._follow(way, stretch.action)
        if grip is None or self.seen.terminated:
            return
        self._step(np.concatenate([self.seen.base, self.seen.joints]), self._number(grip))
        if grip.attach is not None and not self.seen.things[grip.attach.body].held:
            raise RefusedError(f"{stretch.action}: it is not grasped")
        if grip.attach is not None:
            things = self.seen.things
            self.aside = away_from(things[grip.attach.body], things.values())
        if grip.release is not None and self.seen.grasping:
            raise RefusedError(f"{stretch.action}: it is not let go")

    @staticmethod
    def _number(grip: GripperMove) -> float:
        return TAKE if grip.attach is not None else LEAVE

    def _above(self, grip: GripperMove) -> float:
        """Metres above the end of the plan's way at which a body is to be let go."""
        assert grip.release is not None
        body, after = grip.release.body, matrix(grip.release.pose)[:3, :3]
        # What it was too high by is aside where it has been turned since.
        off = self.off[body] * float((after @ self.poses[body].T)[2, 2])
        on = grip.release.on or ""
        above = max(0.0, GAP - self.problem.air.get(on, AIR) - off)
        self.off[body], self.poses[body] = off + above, after
        return above

    def _follow(self, way: Floats, action: str) -> None:
        """Go along a way (k, 10); the goal may be reached before its end."""
        index, limit = 0, self.limit
        while index < len(way) - 1 and not self.seen.terminated:
            ahead = max(furthest(way, index, limit), index + 1)
            if self._reached(way[ahead]):
                index, limit = ahead, self.limit
                continue
            self.refused += 1
            limit /= 2
            if ahead == index + 1:
                raise RefusedError(f"{action}: a step is refused")

    def _reached(self, target: Floats) -> bool:
        """Whether the robot is at a configuration after a step, or after several where it is
        further away than one."""
        for _ in range(1000):
            here = np.concatenate([self.seen.base, self.seen.joints])
            self._step(target, 0.0)
            if self.seen.terminated or np.abs(self._difference(target)).max() < THERE:
                return True
            now = np.concatenate([self.seen.base, self.seen.joints])
            if np.abs(now - here).max() < THERE:
                return False
        return False

    def _difference(self, target: Floats) -> Floats:
        """What is missing (10,) to a configuration; angles by the shorter way."""
        away: Floats = target - np.concatenate([self.seen.base, self.seen.joints])
        away[2:] = (away[2:] + math.pi) % (2 * math.pi) - math.pi
        return away

    def _step(self, target: Floats, gripper: float) -> None:
        if self.steps >= MOST_STEPS:
            raise RefusedError(f"{MOST_STEPS} steps were not enough")
        away = np.clip(self._difference(target), -self.limit, self.limit)
        self.seen = self.kinder.step([*away.tolist(), gripper])
        self.steps += 1
