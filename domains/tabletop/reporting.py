"""The pick-and-place domain as people and files see it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from domains.tabletop.actions.actions import Action, MoveBase
from domains.tabletop.actions.document import document
from domains.tabletop.bound import execution_bound
from domains.tabletop.why.after import after
from domains.tabletop.why.before import before
from domains.tabletop.world import TabletopWorld
from runtime.plan.model import Plan
from runtime.plan.write import write_plan
from runtime.reporting import Profile, Solves, UnsayableError
from runtime.search.siw_r import Outcome
from sketchlang.domain import Picture
from sketchlang.loader import Loaded
from sketchlang.model import SketchModel

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem
    from domains.tabletop.state import State
    from runtime.judge.findings import Certificate


@dataclass(frozen=True, eq=False)
class TabletopDocument:
    """The plan of an outcome."""

    world: TabletopWorld
    plan: Plan
    bounded: bool = True

    def save(self, path: Path) -> None:
        """Write the plan file."""
        write_plan(self.plan, path)

    def page(self, sketch: Loaded, start: float = 0.0) -> str:
        """The page to watch the plan in a browser, which opens at a time."""
        from runtime.show.page import page
        from runtime.trace.make import trace_of_plan
        from runtime.trace.sketch import trace_sketch

        world = self.world
        trace = trace_of_plan(self.plan, world.scene.world, world.robot, trace_sketch(sketch))
        return page(trace, start=start)

    def validate(self) -> Certificate:
        """Replay the plan in exact geometry."""
        from runtime.judge.certify import certify

        return certify(self.plan, self.world.scene.world, self.world.robot)

    @cached_property
    def execution_time(self) -> float:
        """Seconds that the motions of the plan take."""
        return self.plan.execution_time

    @cached_property
    def execution_lower_bound(self) -> float | None:
        """Seconds that any plan of the task takes at least; None where a domain adds actions,
        which may do it quicker."""
        return execution_bound(self.world, self.world.initial) if self.bounded else None


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
        executor = None if self.problem.in_turn else self.problem.executor
        plan = document(world, model, outcome, planner, seed, executor)
        return TabletopDocument(world, plan, bounded=not self.problem.sampler.schemas)

    def picture(self, state: State) -> Picture:
        """A state seen from above."""
        from domains.tabletop.picture import view_of_state
        from runtime.show.top_picture import TopPicture

        return TopPicture(view_of_state(state))

    def scene_files(self, state: State) -> Mapping[str, str]:
        """The scene's file with this state at the start."""
        from domains.tabletop.started import started_from

        if self.problem.file is None:
            raise UnsayableError("the problem was not read from a file")
        return {".toml": started_from(self.problem.world, state, self.problem.file)}

    def hopeless(self, solves: Solves | None = None) -> list[dict[str, Any]]:
        """What makes the task impossible, whatever a search would do; nothing is certain where
        a domain has been extended by actions."""
        return [] if self.problem.sampler.schemas else before(self.problem, solves)

    def why(self, outcome: Outcome, solves: Solves) -> list[dict[str, Any]]:
        """What keeps each misplaced object from its goal."""
        return after(self.problem, outcome, solves)
