"""From the outcome of a search to a plan file."""

from __future__ import annotations

from collections.abc import Iterator

from domains.tabletop.actions.executability import Executor
from domains.tabletop.actions.schedule import Step, scheduled
from domains.tabletop.state import State
from domains.tabletop.world import TabletopWorld
from runtime.motion import timing
from runtime.plan.model import Plan, PlanAction, PlanSubgoal, TimedPiece
from runtime.plan.partial import failure_of
from runtime.search.siw_r import Outcome
from sketchlang.model import SketchModel
from sketchlang.version import __version__


def document(
    world: TabletopWorld,
    model: SketchModel,
    outcome: Outcome,
    planner: str,
    seed: int,
    executor: Executor | None = None,
) -> Plan:
    """The plan that a search found, as far as it came: its motions put together by what
    executes them, or one after the other where there is none."""
    names = [feature.name for feature in model.features]
    actions: list[PlanAction] = []
    subgoals: list[PlanSubgoal] = []
    timed = _together(executor, outcome) if executor else _in_turn(world, outcome)
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
        for action, values in zip(subgoal.actions, subgoal.values, strict=True):
            pieces = next(timed)
            text, arguments = action.text(world), action.arguments(world)
            after = dict(zip(names, values, strict=True))
            actions.append(PlanAction(action.name, text, number, pieces, arguments, after))
    return Plan(
        sketch=model.name,
        scene=world.scene.name,
        scene_digest=world.scene.digest,
        robot=world.robot.source,
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


def _together(executor: Executor, outcome: Outcome) -> Iterator[tuple[TimedPiece, ...]]:
    """The pieces of each action, overlapping as far as they can."""
    return scheduled(executor, steps_of(executor.world.initial, outcome))


def steps_of(state: State, outcome: Outcome) -> list[Step]:
    """The actions of an outcome that starts in a state, with motions and states."""
    steps = []
    for subgoal in outcome.subgoals:
        rows = zip(subgoal.actions, subgoal.motions, subgoal.states, strict=True)
        for action, motion, after in rows:
            steps.append(Step(action, motion, state, after))
            state = after
    return steps


def _in_turn(world: TabletopWorld, outcome: Outcome) -> Iterator[tuple[TimedPiece, ...]]:
    """The pieces of each action, one after the other."""
    opening = world.robot.gripper.max_opening
    for subgoal in outcome.subgoals:
        for motion in subgoal.motions:
            pieces, opening = timing.timed_motion(world.robot, motion, opening)
            yield pieces
