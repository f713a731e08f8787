"""The pick-and-place domain as the search sees it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.actions.document import describe, document
from domains.tabletop.actions.executability import Executor
from domains.tabletop.sampling.samples import Sampler, Samples
from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import Action, MoveBase, State
from domains.tabletop.world import Task
from runtime.motion import timing
from runtime.motion.motion import Motion
from runtime.plan.format import write_plan
from runtime.robot.load import DEFAULT_ROBOT, load_robot
from runtime.search.guide import Subgoal
from runtime.search.profile import Profile
from runtime.search.siw_r import Outcome
from sketchlang.model import SketchModel

if TYPE_CHECKING:
    from runtime.judge.certify import Certificate

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

    def warm_up(self) -> None:
        """Compile the kernels, or load them from the cache."""
        from domains.tabletop.warm import warm_up

        warm_up(self.task.robot)

    def describe(self, subgoal: Subgoal) -> str:
        """The manipulations of a subplan in a few words."""
        words = [describe(self.task, a) for a in subgoal.actions if not isinstance(a, MoveBase)]
        return ", ".join(words) or "drive"

    def profile_dict(self) -> dict[str, dict[str, float]]:
        """The profile of X."""
        return self.profile.as_dict()

    def robot_name(self) -> str | None:
        """The robot's name."""
        return self.task.robot.name

    def execution_time(self, outcome: Outcome) -> float:
        """Seconds that the motions of an outcome take."""
        return sum(
            timing.duration(self.task.robot, motion)
            for subgoal in outcome.subgoals
            for motion in subgoal.motions
        )

    def write_plan(
        self, model: SketchModel, outcome: Outcome, planner: str, seed: int, path: Path
    ) -> None:
        """Write the plan file."""
        write_plan(document(self.task, model, outcome, planner, seed), path)

    def obstacles(self, state: State) -> list[str]:
        """What keeps each misplaced object from its goal, by the estimate of the features."""
        task = self.task
        arrangement = task.arrangement(state.placements)
        names = [thing.name for thing in task.scene.objects]
        found = []
        for index in sorted(task.misplaced(state)):
            goal = task.goal_sites(index, arrangement)
            assert goal is not None
            if state.held != index and not arrangement.reachable[index]:
                found.append(f"{names[index]} is out of reach: there is nowhere to stand for it")
            elif not goal.reachable.any():
                found.append(f"the goal of {names[index]} is out of reach: nowhere to stand for it")
            elif task.obstructions(state, index):
                way = ", ".join(names[i] for i in arrangement.in_the_way(index, goal))
                found.append(f"{names[index]} is obstructed, at its place or its goal, by {way}")
            elif task.disturbances(state, index):
                found.append(f"{names[index]} would obstruct others at its goal")
        return found

    def certify(self, model: SketchModel, outcome: Outcome, planner: str, seed: int) -> Certificate:
        """Replay the plan in exact geometry."""
        from runtime.judge.certify import certify

        plan = document(self.task, model, outcome, planner, seed)
        return certify(plan, self.task.scene, self.task.robot)


def load_problem(path: str, options: Mapping[str, object]) -> PickPlaceProblem:
    """The problem of a scene file.

    Raises:
        InputError: the scene or the robot is not as it should be.
    """
    scene = load_scene(Path(path), str(options.get("name") or Path(path).stem))
    robot = load_robot(str(options.get("robot") or DEFAULT_ROBOT))
    return PickPlaceProblem(Task(scene, robot), int(str(options.get("seed", 0))))
