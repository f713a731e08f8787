"""The public interface for Python: load, check, prove and run sketches.

    import sketchlang

    result = sketchlang.plan("pick_and_place", "sorting/4t-07", seed=0)
    if result.solved:
        result.plan.save("plan.json")
        assert result.plan.validate().valid

It stands above the language, the runtime and the domains, as the command line does; importing
`sketchlang` imports none of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sketchlang.errors import InputError

if TYPE_CHECKING:
    from runtime.show.notebook import Embedded
    from runtime.solve import Result as TaskResult
    from sketchlang.analysis.termination import Verdict
    from sketchlang.diagnostics import Diagnostic
    from sketchlang.loader import Loaded


def load(sketch: str | Path, domain: str | Path | None = None) -> Loaded:
    """A sketch, parsed and checked: a path, or the name of a built-in one. `domain` is a Python
    file with a domain of one's own.

    Raises:
        InputError: the text cannot be had, or the domain's file is broken.
    """
    from sketchlang.loader import load_sketch

    return load_sketch(str(sketch), None if domain is None else str(domain))


def check(sketch: str | Path | Loaded, domain: str | Path | None = None) -> Sequence[Diagnostic]:
    """What is to be said of a sketch: errors and warnings, by their place."""
    return _loaded(sketch, domain).diagnostics


def terminate(sketch: str | Path | Loaded, domain: str | Path | None = None) -> Verdict:
    """Whether a sketch terminates, with the proof or the counterexample.

    Raises:
        InputError: the sketch has errors.
    """
    from sketchlang.analysis.termination import decide_termination

    return decide_termination(_valid(sketch, domain).checked.model)


def plan(
    sketch: str | Path | Loaded,
    scene: str | Path,
    *,
    robot: str | Path | None = None,
    seed: int = 0,
    planner: str | None = None,
    timeout: float = 300.0,
    k_max: int = 2,
    domain: str | Path | None = None,
    in_turn: bool = False,
    improve: float = 0.0,
    improve_steps: int | None = None,
) -> Result:
    """Plan a scene (a path, or the name of a built-in one) with a sketch. The same seed gives
    the same plan; `timeout` are seconds of planning, `k_max` the largest width of IW(k). Base and
    arm move at once where they can, or each `in_turn`. For `improve` seconds, or `improve_steps`
    changes, a plan is looked for that takes less time to carry out.

    Raises:
        InputError: sketch, scene or robot are not as they should be, or plans of the domain
            cannot be improved.
        sketchlang.compile.EvaluationError: a function of the domain breaks its promise.
    """
    from runtime.improve import Improvement
    from runtime.search.limits import Limits
    from runtime.search.planners import DEFAULT
    from runtime.solve import open_task

    loaded = _valid(sketch, domain)
    task = open_task(
        loaded.checked, str(scene), seed, None if robot is None else str(robot), in_turn
    )
    limits = Limits(timeout=timeout, k_max=k_max)
    better = Improvement(improve, improve_steps)
    return Result(task.solve(limits, planner or DEFAULT, improve=better), loaded)


@dataclass(frozen=True, eq=False)
class Result:
    """What planning gave: `plan` as far as it came, and why it did not come further."""

    task: TaskResult
    sketch: Loaded

    @property
    def solved(self) -> bool:
        """Whether the goal is reached."""
        return self.task.solved

    @property
    def reason(self) -> str | None:
        """Why there is no plan, in one sentence; None where there is one."""
        return self.task.outcome.reason

    @property
    def report(self) -> dict[str, Any]:
        """The object that `sketchlang run --json` prints."""
        from runtime.report import make_report

        return make_report(self.task)

    @property
    def plan(self) -> Plan:
        """The plan."""
        return Plan(self)


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan: it can be written, judged and shown."""

    result: Result

    @property
    def execution_time(self) -> float:
        """Seconds that its motions take."""
        return self.result.task.plan.execution_time

    def save(self, path: str | Path) -> None:
        """Write the plan file.

        Raises:
            InputError: the file cannot be written.
        """
        self.result.task.plan.save(Path(path))

    def validate(self) -> Any:
        """Judge the plan with exact geometry, independently of the planner: `valid`, and
        `findings` with the action and what is wrong there."""
        return self.result.task.plan.validate()

    def replay(self, path: str | Path) -> None:
        """Write the page to watch the plan in a browser.

        Raises:
            InputError: the domain has no motions to show, or the file cannot be written.
        """
        from sketchlang.files import write_text

        write_text(Path(path), self._page())

    def show(self, height: int = 560, start: float = 0.0) -> Embedded:
        """The same page for a notebook: the value of a cell, `height` pixels high, which opens at
        a time in seconds.

        Raises:
            InputError: the domain has no motions to show.
        """
        from runtime.show.notebook import Embedded

        return Embedded(self._page(start), height)

    def _page(self, start: float = 0.0) -> str:
        from runtime.reporting import Watchable

        plan = self.result.task.plan
        if not isinstance(plan, Watchable):
            raise InputError("the plan has no motions to show")
        return plan.page(self.result.sketch, start)


def _loaded(sketch: str | Path | Loaded, domain: str | Path | None) -> Loaded:
    return load(sketch, domain) if isinstance(sketch, str | Path) else sketch


def _valid(sketch: str | Path | Loaded, domain: str | Path | None) -> Loaded:
    loaded = _loaded(sketch, domain)
    if not loaded.ok:
        first = next(found for found in loaded.diagnostics if found.severity.value == "error")
        line, column = first.primary.source.position(first.primary.span.start)
        place = f"{first.primary.source.name}:{line}:{column}"
        raise InputError(first.message, place=place, hint=first.hint)
    return loaded
