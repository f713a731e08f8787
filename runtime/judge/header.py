"""Whether a plan is of this world and this robot, and whole."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from runtime.angles import wrap
from runtime.plan.model import Plan
from runtime.robot.model import RobotModel
from runtime.world.world import World

START = 1e-4
"""Metres (radians) by which a plan's start may differ from the world's."""


def header_faults(plan: Plan, world: World, robot: RobotModel) -> Iterator[str]:
    """All that is wrong before anything moves."""
    if plan.scene_digest != world.digest:
        yield f"the plan was made for another version of the scene {world.name}"
    if plan.robot_digest != robot.digest:
        yield f"the plan was made for another version of the robot {robot.name}"
    if plan.objects != tuple(thing.name for thing in world.movables):
        yield "the plan's objects are not those of the scene"
    if plan.joints and plan.joints != robot.joints:
        yield "the plan's planning joints are not those of the robot"
    off = np.abs(np.array(plan.base_start) - np.array(world.robot_start))
    off[2] = abs(wrap(plan.base_start[2] - world.robot_start[2]))
    if off.max() > START:
        yield "the plan does not start where the robot stands in the scene"
    yield from _order_faults(plan)


def _order_faults(plan: Plan) -> Iterator[str]:
    expected = [subgoal.actions for subgoal in plan.subgoals]
    counted = [0] * len(expected)
    for action in plan.actions:
        counted[action.subgoal] += 1
    if counted != expected:
        less = "missing" if sum(counted) < sum(expected) else "not where they belong"
        yield (
            f"actions are {less}: by its subgoals the plan has {sum(expected)}, "
            f"{sum(counted)} are there"
        )
    if any(b.subgoal < a.subgoal for a, b in pairwise(plan.actions)):
        yield "an action of a subgoal comes after those of a later one"
    for number, (a, b) in enumerate(pairwise(plan.subgoals), 2):
        if a.after != b.before:
            yield f"the features at the start of subgoal {number} are not those before it"
