"""The pick-and-place domain as the search sees it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runtime.motion.motion import Motion
from runtime.pick_place.executability import Executor
from runtime.pick_place.profile import Profile
from runtime.pick_place.sampling import Sampler, Samples
from runtime.pick_place.state import Action, MoveBase, State
from runtime.pick_place.task import Task
from runtime.robot.load import load_robot
from runtime.scene.load import load_scene

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

    def execute(self, state: State, action: Action) -> Motion | None:
        """X: the motion of an action, or None."""
        if isinstance(action, MoveBase):
            return self.executor.motion_plan(state, action, None)
        reach = self.executor.inverse_kinematics(state, action, self.seeds)
        return None if reach is None else self.executor.motion_plan(state, action, reach)


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

    def feature_key(self, state: State) -> Hashable:
        """Features depend on the objects and the grasp, not on where the robot stands."""
        return state.placements, state.grasp


def load_problem(path: str, options: Mapping[str, object]) -> PickPlaceProblem:
    """The problem of a scene file.

    Raises:
        InputError: the scene or the robot is not as it should be.
    """
    scene = load_scene(Path(path), str(options.get("name") or Path(path).stem))
    robot = load_robot(str(options.get("robot") or "tiago"))
    return PickPlaceProblem(Task(scene, robot), int(str(options.get("seed", 0))))
