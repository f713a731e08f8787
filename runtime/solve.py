"""The one path from a sketch and a problem to an outcome.

The command line, the benchmarks and Python users come this way; the closed loop asks for one
subgoal at a time (`runtime.search.query`).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from runtime.collector import spared
from runtime.improve import Improvable, Improvement, Told
from runtime.reasons.circle import loop_of
from runtime.reasons.explain import SAID, explain
from runtime.reporting import ClassicalReporting, Document, Reporting
from runtime.search.classical import ClassicalProblem
from runtime.search.limits import Limits
from runtime.search.planners import DEFAULT, PLANNERS
from runtime.search.problem import SearchProblem, StartedAt
from runtime.search.siw_r import End, Outcome, Progress
from sketchlang.checking.checker import CheckedSketch
from sketchlang.compile import CompiledSketch, compile_sketch, obstacles
from sketchlang.domain import LoadOptions, SceneError, position_of
from sketchlang.errors import InputError
from sketchlang.library import find_scene
from sketchlang.model import SketchModel


def solve(
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    planner: str = DEFAULT,
    progress: Progress | None = None,
) -> Outcome:
    """Search for a plan, subgoal by subgoal. All randomness comes from `rng`.

    Raises:
        InputError: there is no such planner.
        EvaluationError: a function of the domain, or an invariant, breaks its promise.
    """
    if planner not in PLANNERS:
        known = ", ".join(PLANNERS)
        raise InputError(f"there is no planner {planner!r}", hint=f"planners: {known}")
    with spared():
        return PLANNERS[planner](sketch, problem, limits, rng, progress)


HASTY = Limits(k_max=1, rejections=200, generated=8_000, blind=4_000, retreats=0)
"""Limits for the small problems by which reasons are tested."""


CURES = 1.0
"""Seconds in which changes of a sketch are tried after a run that failed."""


@dataclass(frozen=True, eq=False)
class Task:
    """A sketch and a scene, ready to be solved."""

    sketch: CompiledSketch
    problem: SearchProblem
    reporting: Reporting
    scene: str
    seed: int
    checked: CheckedSketch

    def warnings(self) -> list[dict[str, Any]]:
        """What is to be said before a run: that the sketch is not proved to terminate."""
        loop = loop_of(self.sketch.model)
        return [] if loop is None else [loop.warning]

    def solve(
        self,
        limits: Limits | None = None,
        planner: str = DEFAULT,
        progress: Progress | None = None,
        improve: Improvement | None = None,
        told: Told | None = None,
    ) -> Result:
        """Solve the task: kernels are warm when the clock of the limits starts. The plan is
        improved afterwards, as far as that is wanted; `told` of each better one.

        Raises:
            InputError: the plans of the domain cannot be improved.
        """
        improve = improve if improve is not None and improve.wanted else None
        if improve is not None and not isinstance(self.problem, Improvable):
            raise InputError("the plans of this domain have no execution time to improve")
        self.reporting.warm_up()
        limits = limits or Limits()
        limits.restart()
        hopeless = self.reporting.hopeless(self._solves)
        if hopeless:
            outcome = Outcome(state=self.problem.initial, seconds=limits.elapsed())
            outcome.end = End.HOPELESS
            outcome.reason = "; ".join(finding["text"] for finding in hopeless[:SAID])
            outcome.why, outcome.stuck = hopeless, self.sketch.evaluate(self.problem.initial)
        else:
            rng = np.random.default_rng(self.seed)
            outcome = solve(self.sketch, self.problem, limits, rng, planner, progress)
            if not outcome.solved:
                self.explain(outcome, limits)
        document = self.reporting.document(self.sketch.model, outcome, planner, self.seed)
        outcome.seconds = limits.elapsed()  # motions are put together in time: that is planning
        if improve is not None and outcome.solved:
            assert isinstance(self.problem, Improvable), "tested above"
            outcome = self.problem.improve(
                self.sketch, outcome, improve, told or (lambda tried, seconds: None)
            )
            document = self.reporting.document(self.sketch.model, outcome, planner, self.seed)
        return Result(self, planner, outcome, document, improve)

    def _solves(self, problem: SearchProblem) -> bool:
        """Whether the sketch solves a problem of a few subgoals, with little patience."""
        rng = np.random.default_rng(self.seed)
        limits = replace(HASTY, start=time.perf_counter())
        return solve(self.sketch, problem, limits, rng).solved

    def explain(self, outcome: Outcome, limits: Limits) -> None:
        """Say why an outcome is not solved."""
        domain = self.checked.domain
        explain(
            outcome,
            self.sketch.model,
            self.reporting.describe,
            self.reporting.why(outcome, self._solves),
            limits.k_max,
            self.checked.atoms,
            {} if domain is None else domain.atoms,
            self._helps(outcome),
        )

    def _helps(self, outcome: Outcome) -> Callable[[SketchModel], bool]:
        """Whether a changed sketch solves what is left, as far as that shows in a short time."""
        deadline = time.process_time() + CURES

        def helps(model: SketchModel) -> bool:
            left = deadline - time.process_time()
            if left <= 0:
                return False
            rng = np.random.default_rng(self.seed)
            limits = replace(HASTY, start=time.perf_counter(), timeout=left)
            sketch = replace(self.sketch, model=model)
            return solve(sketch, StartedAt(self.problem, outcome.state), limits, rng).solved

        return helps


@dataclass(frozen=True, eq=False)
class Result:
    """What came of a task: the outcome of the search, its plan as far as it came, and how long it
    was improved, if it was."""

    task: Task
    planner: str
    outcome: Outcome
    plan: Document
    improved: Improvement | None = None

    @property
    def solved(self) -> bool:
        """Whether the goal was reached."""
        return self.outcome.solved


def open_task(
    checked: CheckedSketch,
    scene: str,
    seed: int = 0,
    robot: str | None = None,
    in_turn: bool = False,
) -> Task:
    """Compile a sketch and load a scene by name or path. Motions that could overlap follow each
    other where they are to be `in_turn`.

    Raises:
        InputError: the sketch cannot be run, or scene or robot are not as they should be.
        SceneError: a domain's own word about its scene.
    """
    for obstacle in obstacles(checked):
        raise InputError(obstacle.message, hint=obstacle.hint)
    domain = checked.domain
    assert domain is not None, "one of the obstacles"
    if domain.load is None:
        raise InputError(f"the domain {domain.name} has no scenes")
    if robot is not None and not domain.has_robots:
        raise InputError(f"--robot: the domain {domain.name} has no robots")
    if in_turn and not domain.has_robots:
        raise InputError(f"--in-turn: the domain {domain.name} has no robots")
    path, name = find_scene(scene)
    options = LoadOptions(name, seed, robot, dict(domain.actions), in_turn)
    problem, reporting = opened(domain.name, _loaded(domain, path, options))
    return Task(compile_sketch(checked), problem, reporting, name, seed, checked)


def _loaded(domain: Any, path: Path, options: LoadOptions) -> Any:
    """The problem of a scene; what goes wrong in a domain's own code is said, not raised."""
    try:
        return domain.load(str(path), options)
    except (InputError, SceneError):
        raise
    except Exception as error:
        raise InputError(
            f"the scene loader of domain {domain.name} ({position_of(domain.load)}) fails: "
            f"{type(error).__name__}: {error}",
            place=str(path),
        ) from error


def opened(domain: str, problem: Any) -> tuple[SearchProblem, Reporting]:
    """What a domain's scene loader made, as the search and reports see it.

    Raises:
        InputError: it is neither a problem that can be sampled nor one with successors.
    """
    if hasattr(problem, "subproblem"):
        return problem, problem.reporting
    if not (hasattr(problem, "initial") and hasattr(problem, "successors")):
        raise InputError(
            f"the scene loader of domain {domain} returned {type(problem).__name__}",
            hint="it has to return a problem with `initial` and `successors(state)`",
        )
    classical = ClassicalProblem(problem)
    return classical, ClassicalReporting(classical)
