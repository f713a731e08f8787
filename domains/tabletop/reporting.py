"""The pick-and-place domain as people and files see it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from domains.tabletop.actions.document import describe, document
from domains.tabletop.state import Action, MoveBase
from domains.tabletop.world import Task
from runtime.plan.model import Plan
from runtime.plan.write import write_plan
from runtime.reporting import Profile
from runtime.search.siw_r import Outcome
from sketchlang.model import SketchModel

if TYPE_CHECKING:
    from domains.tabletop.problem import PickPlaceProblem
    from runtime.judge.findings import Certificate


@dataclass(frozen=True, eq=False)
class TabletopDocument:
    """The plan of an outcome."""

    task: Task
    plan: Plan

    def save(self, path: Path) -> None:
        """Write the plan file."""
        write_plan(self.plan, path)

    def validate(self) -> Certificate:
        """Replay the plan in exact geometry."""
        from runtime.judge.certify import certify

        return certify(self.plan, self.task.scene.world, self.task.robot)

    @cached_property
    def execution_time(self) -> float:
        """Seconds that the motions of the plan take."""
        return self.plan.execution_time


class TabletopReporting:
    """Reports about one problem."""

    def __init__(self, problem: PickPlaceProblem) -> None:
        self.problem = problem

    @property
    def robot(self) -> str:
        """The robot's name."""
        return self.problem.task.robot.name

    def warm_up(self) -> None:
        """Compile the kernels, or load them from the cache."""
        from domains.tabletop.warm import warm_up

        warm_up(self.problem.task.robot)

    def describe(self, actions: Sequence[Action]) -> str:
        """The manipulations among some actions in a few words."""
        task = self.problem.task
        words = [describe(task, a) for a in actions if not isinstance(a, MoveBase)]
        return ", ".join(words) or "drive"

    def profile(self) -> Profile:
        """The profile of X."""
        return self.problem.profile.as_dict()

    def document(
        self, model: SketchModel, outcome: Outcome, planner: str, seed: int
    ) -> TabletopDocument:
        """The plan of an outcome, as far as it came."""
        task = self.problem.task
        return TabletopDocument(task, document(task, model, outcome, planner, seed))

    def why(self, outcome: Outcome) -> list[dict[str, Any]]:
        """What keeps each misplaced object from its goal, by the estimate of the features."""
        task, state = self.problem.task, outcome.state
        arrangement = task.arrangement(state.placements)
        names = [thing.name for thing in task.scene.objects]
        found: list[dict[str, Any]] = []

        def say(index: int, cause: str, text: str) -> None:
            found.append({"object": names[index], "cause": cause, "text": f"{names[index]} {text}"})

        for index in sorted(task.misplaced(state)):
            goal = task.goal_sites(index, arrangement)
            assert goal is not None
            if state.held != index and not arrangement.reachable[index]:
                say(index, "out of reach", "is out of reach: there is nowhere to stand for it")
            elif not goal.reachable.any():
                say(index, "goal out of reach", "has a goal out of reach: nowhere to stand for it")
            elif task.obstructions(state, index):
                way = ", ".join(names[i] for i in arrangement.in_the_way(index, goal))
                say(index, "obstructed", f"is obstructed, at its place or its goal, by {way}")
            elif task.disturbances(state, index):
                say(index, "disturbs", "would obstruct others at its goal")
        return found
