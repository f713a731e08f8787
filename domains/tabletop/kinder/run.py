"""Problems of KinDER, planned here and judged there."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from domains.tabletop.kinder.observed import Observation
from domains.tabletop.kinder.playback import Player
from domains.tabletop.kinder.problem import Problem
from domains.tabletop.kinder.process import KinderProcess
from domains.tabletop.kinder.robot import NAME, make_robot
from domains.tabletop.kinder.scenes import problem_of
from domains.tabletop.kinder.start import free_start
from domains.tabletop.scene.load import load_scene
from runtime.robot.load import load_robot
from runtime.solve import Task, open_task
from sketchlang.errors import InputError
from sketchlang.loader import load_sketch
from sketchlang.reading import recording


@dataclass(frozen=True)
class Record:
    """One problem. Times are CPU seconds: `load_s` from an observation to a task, `planning_s` of
    planning. `backed_m` is how far the robot backed off first, from a start that our planner
    takes for a collision; `refused` counts steps that KinDER refused, and that were divided."""

    env: str
    seed: int
    success: bool
    planned: bool
    planning_s: float
    load_s: float
    steps: int
    refused: int
    actions: int
    backed_m: float
    reason: str | None

    def as_json(self) -> dict[str, Any]:
        """The same as plain data."""
        return asdict(self)


def run_problem(kinder: KinderProcess, robot: Path, env: str, seed: int, timeout: float) -> Record:
    """Observe, plan, play back, and say how it went.

    Raises:
        InputError: KinDER has no such environment, or the robot is none.
    """
    from runtime.search.limits import Limits

    seen = kinder.reset(env, seed)
    began = time.process_time()
    problem = problem_of(env, seen)
    with tempfile.TemporaryDirectory() as folder:
        try:
            task, backed = _opened(problem, seen, Path(folder), robot, seed)
        except InputError as error:  # one start that no scene can say is one failure
            said = str(error).splitlines()[0].replace(folder, "").lstrip("/")
            return Record(env, seed, False, False, 0.0, 0.0, 0, 0, 0, 0.0, f"no scene: {said}")
        task.reporting.warm_up()
        loaded = time.process_time()
        result = task.solve(Limits(timeout=timeout))
    planned = time.process_time()
    plan = result.plan.plan  # type: ignore[attr-defined]
    record: dict[str, Any] = {
        "env": env,
        "seed": seed,
        "planned": result.solved,
        "planning_s": round(planned - loaded, 3),
        "load_s": round(loaded - began, 3),
        "actions": len(plan.actions),
        "backed_m": round(backed, 3),
    }
    if not result.solved:
        return Record(
            **record, success=False, steps=0, refused=0, reason=f"no plan: {result.outcome.reason}"
        )
    assert seen.limit is not None, "the first observation of an episode says it"
    world = task.problem.world  # type: ignore[attr-defined]
    player = Player(kinder, world.robot, seen, seen.limit, problem)
    played = player.play(world.scene.world, plan)
    return Record(
        **record,
        success=played.terminated,
        steps=played.steps,
        refused=played.refused,
        reason=None if played.terminated else played.reason,
    )


def _opened(
    problem: Problem, seen: Observation, folder: Path, robot: Path, seed: int
) -> tuple[Task, float]:
    """The task of a problem, and how far the robot drives first to where it starts."""
    x, y, heading = seen.base.tolist()
    with recording():  # scenes are ours: each may be written over the one before
        scene = problem.write(folder, (x, y, math.degrees(heading)))
        there = free_start(load_scene(scene), load_robot(robot))
    with recording():
        scene = problem.write(folder, (*there[:2], math.degrees(there[2])))
        task = open_task(load_sketch(problem.sketch).checked, str(scene), seed, str(robot))
    return task, math.hypot(there[0] - x, there[1] - y)


def run_all(
    python: Path,
    envs: Sequence[str],
    seeds: Sequence[int],
    timeout: float,
    told: Callable[[Record], None],
    known: Sequence[Record] = (),
) -> list[Record]:
    """All problems, one environment after the other; `told` of each that is played, which those
    are not that are `known`. The robot file is made, once, beside the interpreter of KinDER's
    environment, which is not started where there is nothing to play.

    Raises:
        InputError: KinDER cannot be started, or has no such environment.
    """
    records = {(record.env, record.seed): record for record in known}
    wanted = [(env, seed) for env in envs for seed in seeds]
    missing = [problem for problem in wanted if problem not in records]
    if missing:
        with KinderProcess(python) as kinder:
            robot = python.absolute().parent.parent / "robot" / f"{NAME}.toml"
            if not robot.exists():
                make_robot(kinder.assets(), robot.parent)
            for env, seed in missing:
                record = records[env, seed] = run_problem(kinder, robot, env, seed, timeout)
                told(record)
    return [records[problem] for problem in wanted]
