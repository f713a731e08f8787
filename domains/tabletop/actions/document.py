"""From the outcome of a search to a plan file."""

from __future__ import annotations

from domains.tabletop.world import TabletopWorld
from runtime.motion import timing
from runtime.plan.model import Plan, PlanAction, PlanSubgoal
from runtime.plan.partial import failure_of
from runtime.search.siw_r import Outcome
from sketchlang.model import SketchModel
from sketchlang.version import __version__


def document(
    world: TabletopWorld, model: SketchModel, outcome: Outcome, planner: str, seed: int
) -> Plan:
    """The plan that a search found, as far as it came."""
    names = [feature.name for feature in model.features]
    actions: list[PlanAction] = []
    subgoals: list[PlanSubgoal] = []
    opening = world.robot.gripper.max_opening
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
        done = zip(subgoal.actions, subgoal.motions, subgoal.values, strict=True)
        for action, motion, values in done:
            pieces, opening = timing.timed_motion(world.robot, motion, opening)
            text, arguments = action.text(world), action.arguments(world)
            after = dict(zip(names, values, strict=True))
            actions.append(PlanAction(action.name, text, number, pieces, arguments, after))
    return Plan(
        sketch=model.name,
        scene=world.scene.name,
        scene_digest=world.scene.digest,
        robot=world.robot.name,
        robot_digest=world.robot.digest,
        planner=planner,
        seed=seed,
        objects=tuple(item.name for item in world.items),
        base_start=world.initial.base.pose,
        subgoals=tuple(subgoals),
        actions=tuple(actions),
        joints=world.robot.joints,
        tool_version=__version__,
        failure=None if outcome.solved else failure_of(outcome, names),
    )
