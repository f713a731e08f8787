"""The pick-and-place domain as the search sees it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from domains.tabletop.actions.actions import ActionSchema
from domains.tabletop.actions.added import Added
from domains.tabletop.actions.executability import Executor, seeds_at
from domains.tabletop.features.functions import misplaced, obstructions
from domains.tabletop.improve.search import improve
from domains.tabletop.reporting import TabletopReporting
from domains.tabletop.sampling.samples import Sampler
from domains.tabletop.sampling.whole import sample_whole
from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import State
from domains.tabletop.subproblem import TabletopSubproblem
from domains.tabletop.world import TabletopWorld
from runtime.improve import Improvement, Told
from runtime.robot.load import DEFAULT_ROBOT, load_robot
from runtime.search.profile import Profile
from runtime.search.siw_r import Outcome
from sketchlang.compile import CompiledSketch
from sketchlang.domain import LoadOptions


class TabletopProblem:
    """A task that can be searched; `schemas` are actions besides driving, picking, placing. It
    starts in the state `start`, or as the scene describes. In plans, base and arm move at once
    where they can, or each `in_turn`. `file` is that of the scene, if it was read from one."""

    def __init__(
        self,
        world: TabletopWorld,
        seed: int,
        schemas: Sequence[ActionSchema] = (),
        in_turn: bool = False,
        start: State | None = None,
        file: Path | None = None,
    ) -> None:
        self.world = world
        self.file = file
        self.in_turn = in_turn
        self.start = start
        self.profile = Profile()
        self.executor = Executor(world, seed, self.profile)
        self.sampler = Sampler(world, self.executor, schemas)
        self.reporting = TabletopReporting(self)

    @property
    def initial(self) -> State:
        """Where the task starts."""
        return self.world.initial if self.start is None else self.start

    def of(self, world: TabletopWorld, start: State) -> TabletopProblem:
        """The same task in another world and from another state."""
        return TabletopProblem(world, self.executor.seed, self.sampler.schemas, start=start)

    def subproblem(
        self, state: State, attempt: int, rng: np.random.Generator
    ) -> TabletopSubproblem:
        """Sample a subproblem."""
        samples = self.sampler.sample(state, attempt, rng)
        return TabletopSubproblem(samples, self.executor, seeds_at(attempt))

    def whole(self, attempt: int, rng: np.random.Generator) -> TabletopSubproblem:
        """Samples for all of the task, for searches that do not cut it into subproblems."""
        samples = sample_whole(self.sampler, self.initial, attempt, rng)
        return TabletopSubproblem(samples, self.executor, seeds_at(attempt))

    def counters(self, state: State) -> tuple[int, ...]:
        """#g, the objects that are misplaced or in the hand, and #r, what is in the way of
        misplaced objects, all together: for best-first searches."""
        wrong = misplaced(state)
        open_goals = len(wrong) + (state.held is not None and state.held not in wrong)
        return open_goals, sum(obstructions(state, index) for index in wrong)

    def improve(
        self, sketch: CompiledSketch, outcome: Outcome, improvement: Improvement, told: Told
    ) -> Outcome:
        """A solved outcome that takes less time to carry out, or the same one."""
        start = self.world.initial
        return improve(self.executor, self.sampler, start, sketch, outcome, improvement, told)


def load_problem(path: str, options: LoadOptions) -> TabletopProblem:
    """The problem of a scene file.

    Raises:
        InputError: the scene or the robot is not as it should be.
    """
    scene = load_scene(Path(path), options.name or Path(path).stem)
    robot = load_robot(options.robot or DEFAULT_ROBOT)
    schemas = [Added.of(schema) for schema in options.actions.values()]
    world = TabletopWorld.of(scene, robot)
    return TabletopProblem(world, options.seed, schemas, options.in_turn, file=Path(path))
