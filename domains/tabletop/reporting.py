"""The pick-and-place domain as people and files see it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from domains.tabletop.actions.actions import Action, MoveBase
from domains.tabletop.actions.document import document
from domains.tabletop.features.functions import (
    arrangement,
    disturbances,
    misplaced,
    obstructions,
)
from domains.tabletop.items import why_not
from domains.tabletop.world import TabletopWorld
from runtime.plan.model import Plan
from runtime.plan.write import write_plan
from runtime.reporting import Profile
from runtime.search.siw_r import Outcome
from sketchlang.model import SketchModel

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem
    from runtime.judge.findings import Certificate


@dataclass(frozen=True, eq=False)
class TabletopDocument:
    """The plan of an outcome."""

    world: TabletopWorld
    plan: Plan

    def save(self, path: Path) -> None:
        """Write the plan file."""
        write_plan(self.plan, path)

    def validate(self) -> Certificate:
        """Replay the plan in exact geometry."""
        from runtime.judge.certify import certify

        return certify(self.plan, self.world.scene.world, self.world.robot)

    @cached_property
    def execution_time(self) -> float:
        """Seconds that the motions of the plan take."""
        return self.plan.execution_time


class TabletopReporting:
    """Reports about one problem."""

    def __init__(self, problem: TabletopProblem) -> None:
        self.problem = problem

    @property
    def robot(self) -> str:
        """The robot's name."""
        return self.problem.world.robot.name

    def warm_up(self) -> None:
        """Compile the kernels, or load them from the cache."""
        from domains.tabletop.warm import warm_up

        warm_up(self.problem.world.robot)

    def describe(self, actions: Sequence[Action]) -> str:
        """The manipulations among some actions in a few words."""
        world = self.problem.world
        words = [a.text(world) for a in actions if not isinstance(a, MoveBase)]
        return ", ".join(words) or "drive"

    def profile(self) -> Profile:
        """The profile of X."""
        return self.problem.profile.as_dict()

    def document(
        self, model: SketchModel, outcome: Outcome, planner: str, seed: int
    ) -> TabletopDocument:
        """The plan of an outcome, as far as it came."""
        world = self.problem.world
        return TabletopDocument(world, document(world, model, outcome, planner, seed))

    def why(self, outcome: Outcome) -> list[dict[str, Any]]:
        """What keeps each misplaced object from its goal, by the estimate of the features."""
        world, state = self.problem.world, outcome.state
        here = arrangement(world, state.placements)
        names = [item.name for item in world.items]
        found: list[dict[str, Any]] = []

        def say(index: int, cause: str, text: str) -> None:
            found.append({"object": names[index], "cause": cause, "text": f"{names[index]} {text}"})

        for index in sorted(misplaced(state)):
            goal = world.goal_sites(index, here)
            assert goal is not None
            cannot = why_not(world.items[index], world.hand)
            if cannot is not None:
                say(index, "cannot be grasped", cannot)
            elif state.held != index and not here.is_reachable(index):
                say(index, "out of reach", "is out of reach: there is nowhere to stand for it")
            elif not any(here.places_of(index, goal, f).reachable.any() for f in world.families):
                say(index, "goal out of reach", "has a goal out of reach: nowhere to stand for it")
            elif obstructions(state, index):
                way = ", ".join(names[i] for i in here.in_the_way(index, goal))
                say(index, "obstructed", f"is obstructed, at its place or its goal, by {way}")
            elif disturbances(state, index):
                say(index, "disturbs", "would obstruct others at its goal")
        return found
