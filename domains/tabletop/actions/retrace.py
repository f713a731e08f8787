"""The states that a plan's actions lead to, from what the plan says of them.

Arguments hold poses in the planner's whole steps, so the states are exactly those that the
search had, and features are computed of nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from domains.tabletop.actions.actions import Action, MoveBase, Pick, Place
from domains.tabletop.state import BasePose, Grasp, Placement, State
from domains.tabletop.world import TabletopWorld
from runtime.judge.run_of_sketch import Moment
from runtime.plan.model import Plan, PlanAction
from runtime.world.poses import Floats, compose
from sketchlang.compile import CompiledSketch
from sketchlang.errors import InputError

Reader = Callable[[TabletopWorld, Mapping[str, Any]], Action]
"""Makes a ground action of the arguments that a plan file holds of it."""


def retrace(
    plan: Plan,
    world: TabletopWorld,
    sketch: CompiledSketch,
    readers: Mapping[str, Reader] | None = None,
) -> list[Moment]:
    """Feature values and poses at the start of a plan and after each of its subgoals; `readers`
    are those of actions that another domain adds, by name.

    Raises:
        InputError: an action's arguments are none, or do not fit the state that it starts from.
    """
    known = {"move_base": _move_base, "pick": _pick, "place": _place, **(readers or {})}
    state = world.initial
    moments = [_moment(world, state, sketch)]
    number = 0
    for subgoal in range(len(plan.subgoals)):
        while number < len(plan.actions) and plan.actions[number].subgoal == subgoal:
            state = _after(world, state, plan.actions[number], f"actions[{number}]", known, plan)
            number += 1
        moments.append(_moment(world, state, sketch))
    return moments


def _after(
    world: TabletopWorld,
    state: State,
    action: PlanAction,
    where: str,
    readers: Mapping[str, Reader],
    plan: Plan,
) -> State:
    if action.name not in readers:
        raise InputError(
            f"the domain has no action {action.name!r}",
            place=f"{plan.path}: {where}.name",
            hint="name the domain that it is of: --domain FILE.py",
        )
    try:
        ground = readers[action.name](world, action.arguments)
        return ground.after(state)
    except (KeyError, IndexError, TypeError, ValueError, AssertionError):
        raise InputError(
            f"these are no arguments of {action.name} that could be carried out here",
            place=f"{plan.path}: {where}.arguments",
        ) from None


def _moment(world: TabletopWorld, state: State, sketch: CompiledSketch) -> Moment:
    names = [feature.name for feature in sketch.model.features]
    poses: dict[str, Floats | None] = {}
    for index, item in enumerate(world.items):
        standing, placement = world.pose(state.placements, index), state.placements[index]
        poses[item.name] = None
        if standing is not None and placement is not None:
            body = compose(standing, world.item(index, placement.face).standing)
            poses[item.name] = np.vstack([body, [0.0, 0.0, 0.0, 1.0]])
    return Moment(dict(zip(names, sketch.evaluate(state), strict=True)), poses)


def _move_base(world: TabletopWorld, arguments: Mapping[str, Any]) -> Action:
    return MoveBase(BasePose(*_whole(arguments["base"], 3)))


def _pick(world: TabletopWorld, arguments: Mapping[str, Any]) -> Action:
    angle, height, flipped, *rest = arguments["grasp"]
    if not isinstance(flipped, bool):
        raise ValueError("flipped is a truth value")
    # Plans of earlier versions do not say the face: it is that of the start.
    numbers = [angle, height, *rest, 0][:6]
    angle, height, family, along, aside, face = _whole(numbers, 6)
    index = _index(world, arguments)
    _ = world.item(index, face)  # there is such a face
    return Pick(index, Grasp(angle, height, flipped, family, along, aside, face))


def _place(world: TabletopWorld, arguments: Mapping[str, Any]) -> Action:
    support = [ground.name for ground in world.grounds].index(arguments["support"])
    x, y, yaw, face = _whole([*arguments["placement"], arguments.get("face", 0)], 4)
    index = _index(world, arguments)
    _ = world.item(index, face)  # there is such a face
    return Place(index, Placement(x, y, yaw, support, face))


def _index(world: TabletopWorld, arguments: Mapping[str, Any]) -> int:
    return [item.name for item in world.items].index(arguments["object"])


def _whole(values: Any, count: int) -> list[int]:
    if len(values) != count or any(type(value) is not int for value in values):
        raise ValueError("expected whole numbers")
    return list(values)
