"""Replay a plan in exact geometry and report what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from runtime.judge.findings import Certificate, Finding
from runtime.judge.goals import unmet
from runtime.judge.header import header_faults
from runtime.judge.replay import JOIN, Replay
from runtime.plan.model import Plan
from runtime.robot.model import RobotModel
from runtime.world.goals import AnyOf, IsHeld
from runtime.world.world import World

Watch = Callable[[int, Replay], None]
"""Called with the number of an action that was done, and what it has done."""


def certify(plan: Plan, world: World, robot: RobotModel, watch: Watch | None = None) -> Certificate:
    """Replay a plan from the start of a world to its goals; `watch` is called after each action
    that is as it should be."""
    findings = [Finding(None, message) for message in header_faults(plan, world, robot)]
    if findings:
        return Certificate(tuple(findings), 0, len(plan.actions))
    replay = Replay(world, robot, np.array(plan.base_start))
    for number, action in enumerate(plan.actions):
        replay.action(number, action)
        if replay.findings:
            break  # the replay would go on from a state that the plan does not mean
        if watch is not None:
            watch(number, replay)
    if not replay.findings and replay.rest():
        replay.findings += [Finding(None, message) for message in _end_faults(replay)]
    return Certificate(tuple(replay.findings), replay.samples, len(plan.actions))


def _end_faults(replay: Replay) -> list[str]:
    world = replay.world
    names = [world.movables[index].name for index in replay.group]
    found = []
    held = replay.held
    if held is not None and not _may_be_held(world, world.movables[held].name):
        found.append(f"{world.movables[held].name} is still held at the end")
    lacks = unmet(world, replay.poses, names)
    found += [f"goal not reached: {lack}" for lack in lacks]
    if held is None and np.abs(replay.q - replay.robot.home).max() > JOIN:
        found.append("the arm is not in its home posture at the end")
    return found


def _may_be_held(world: World, name: str) -> bool:
    """Whether some goal speaks of a body in the gripper."""
    pending = list(world.goals)
    while pending:
        goal = pending.pop()
        if isinstance(goal, AnyOf):
            pending += goal.goals
        if isinstance(goal, IsHeld) and goal.body == name:
            return True
    return False
