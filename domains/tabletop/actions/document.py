"""From the outcome of a search to a plan file."""

from __future__ import annotations

from typing import Any

from domains.tabletop.state import Action, MoveBase, Pick, Place
from domains.tabletop.world import Task
from runtime.motion import timing
from runtime.plan.model import Plan, PlanAction, PlanSubgoal
from runtime.search.siw_r import Outcome
from sketchlang import __version__
from sketchlang.model import SketchModel

NAMES = {MoveBase: "move_base", Pick: "pick", Place: "place"}


def document(task: Task, model: SketchModel, outcome: Outcome, planner: str, seed: int) -> Plan:
    """The plan that a search found, as far as it came."""
    names = [feature.name for feature in model.features]
    objects = tuple(thing.name for thing in task.scene.objects)
    actions: list[PlanAction] = []
    subgoals: list[PlanSubgoal] = []
    opening = task.robot.gripper.max_opening
    for number, subgoal in enumerate(outcome.subgoals):
        subgoals.append(
            PlanSubgoal(
                rule=subgoal.rule,
                before=dict(zip(names, subgoal.before, strict=True)),
                after=dict(zip(names, subgoal.after, strict=True)),
                actions=len(subgoal.actions),
                expanded=subgoal.expanded,
                generated=subgoal.generated,
                attempt=subgoal.attempt,
                width=subgoal.width,
                rejected=subgoal.rejected,
            )
        )
        for action, motion in zip(subgoal.actions, subgoal.motions, strict=True):
            pieces, opening = timing.timed_motion(task.robot, motion, opening)
            name, text = NAMES[type(action)], describe(task, action)
            actions.append(PlanAction(name, text, number, pieces, arguments(task, action)))
    return Plan(
        sketch=model.name,
        scene=task.scene.name,
        scene_digest=task.scene.digest,
        robot=task.robot.name,
        robot_digest=task.robot.digest,
        planner=planner,
        seed=seed,
        objects=objects,
        base_start=task.initial.base.pose,
        subgoals=tuple(subgoals),
        actions=tuple(actions),
        joints=task.robot.joints,
        tool_version=__version__,
    )


def arguments(task: Task, action: Action) -> dict[str, Any]:
    """The arguments of an action as plain data, exact: poses in the planner's whole steps."""
    match action:
        case MoveBase(target):
            return {"base": list(target)}
        case Pick(index, grasp):
            return {"object": task.scene.objects[index].name, "grasp": list(grasp)}
        case Place(index, placement):
            surface = task.scene.surfaces[placement.surface].name
            return {
                "object": task.scene.objects[index].name,
                "surface": surface,
                "placement": [placement.x, placement.y, placement.yaw],
            }


def describe(task: Task, action: Action) -> str:
    """An action in a few words, for progress and reports."""
    match action:
        case MoveBase(target):
            x, y, _ = target.pose
            return f"drive to ({x:.2f}, {y:.2f})"
        case Pick(index, _):
            return f"pick {task.scene.objects[index].name}"
        case Place(index, placement):
            x, y, _ = placement.pose
            surface = task.scene.surfaces[placement.surface].name
            return f"place {task.scene.objects[index].name} on {surface} at ({x:.2f}, {y:.2f})"
