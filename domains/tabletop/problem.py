"""The pick-and-place domain as the search sees it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.actions.executability import Executor
from domains.tabletop.reporting import TabletopReporting
from domains.tabletop.sampling.samples import Sampler, Samples
from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import Action, MoveBase, State
from domains.tabletop.world import Task
from runtime.motion.motion import Motion
from runtime.robot.load import DEFAULT_ROBOT, load_robot
from runtime.search.problem import Rejection
from runtime.search.profile import Profile
from sketchlang.domain import LoadOptions

if TYPE_CHECKING:
    pass

SEEDS = 12
"""Starting points for inverse kinematics, doubled with each attempt up to ..."""

MAX_SEEDS = 48


@dataclass(frozen=True, eq=False)
class PickPlaceSubproblem:
    """The samples of a subproblem, and X on them."""

    samples: Samples
    executor: Executor
    seeds: int

    def actions(self, state: State) -> list[tuple[Action, State]]:
        """Sampled ground actions and the states they lead to."""
        return list(self.samples.actions(state))

    def execute(self, state: State, action: Action) -> Motion | Rejection:
        """X: the motion of an action, or the step that refused it."""
        reach = None
        if not isinstance(action, MoveBase):
            reach = self.executor.inverse_kinematics(state, action, self.seeds)
            if reach is None:
                return Rejection("inverse_kinematics")
        motion = self.executor.motion_plan(state, action, reach)
        return Rejection("motion_plan") if motion is None else motion


class PickPlaceProblem:
    """A task that can be searched."""

    def __init__(self, task: Task, seed: int) -> None:
        self.task = task
        self.profile = Profile()
        self.executor = Executor(task, seed, self.profile)
        self.sampler = Sampler(task, self.executor)

    @property
    def initial(self) -> State:
        """The state that the scene describes."""
        return self.task.initial

    def subproblem(
        self, state: State, attempt: int, rng: np.random.Generator
    ) -> PickPlaceSubproblem:
        """Sample a subproblem."""
        samples = self.sampler.sample(state, attempt, rng)
        return PickPlaceSubproblem(samples, self.executor, min(MAX_SEEDS, SEEDS * 2**attempt))

    @property
    def reporting(self) -> TabletopReporting:
        """Reports about this problem."""
        return TabletopReporting(self)


def load_problem(path: str, options: LoadOptions) -> PickPlaceProblem:
    """The problem of a scene file.

    Raises:
        InputError: the scene or the robot is not as it should be.
    """
    scene = load_scene(Path(path), options.name or Path(path).stem)
    robot = load_robot(options.robot or DEFAULT_ROBOT)
    return PickPlaceProblem(Task(scene, robot), options.seed)
