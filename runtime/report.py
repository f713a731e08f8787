"""What `run` says about an outcome, for programs and for people."""

from __future__ import annotations

from collections import Counter
from typing import Any

from runtime.search.guide import Subgoal
from runtime.search.siw_r import Retreat
from runtime.solve import Result, Task
from sketchlang.analysis.words import counted
from sketchlang.version import __version__


def make_report(result: Result) -> dict[str, Any]:
    """The object that `run --json` prints."""
    task, outcome = result.task, result.outcome
    profile = task.reporting.profile()
    report: dict[str, Any] = {
        "sketch": task.sketch.model.name,
        "scene": task.scene,
        "planner": result.planner,
        "robot": task.reporting.robot,
        "seed": task.seed,
        "solved": outcome.solved,
        "planning_time_s": round(outcome.seconds, 4),
        "execution_time_s": round(result.plan.execution_time, 2),
        "expanded": outcome.effort.expanded,
        "generated": outcome.effort.generated,
        "subplans": len(outcome.subgoals),
        "retreats": len(outcome.retreats),
        "actions": sum(len(subgoal.actions) for subgoal in outcome.subgoals),
        "motion_plans": profile.get("motion_plan", {}).get("successes", 0),
        "rules_fired": dict(Counter(subgoal.rule for subgoal in outcome.subgoals)),
        "profile": profile,
        "version": __version__,
    }
    bound = result.plan.execution_lower_bound if outcome.solved else None
    if bound is not None:
        report["execution_lower_bound_s"] = round(bound, 2)
    if result.improved is not None:
        report["improvement"] = {
            "tried": result.improved.tried,
            "time_s": round(result.improved.seconds_taken, 4),
        }
    if not outcome.solved:
        report["reason"] = outcome.reason
        report["why"] = outcome.why
        if outcome.stuck is not None:
            names = [feature.name for feature in task.sketch.model.features]
            report["stuck"] = dict(zip(names, outcome.stuck, strict=True))
            large = task.checked.domain.large if task.checked.domain is not None else None
            if large is not None and max(outcome.stuck, default=0) >= large[0]:
                report["large"] = {"value": large[0], "stands_for": large[1]}
    return report


def step_in_words(task: Task, step: Subgoal | Retreat) -> str:
    """What a run did last: a subgoal that it found, or how far it went back."""
    if isinstance(step, Subgoal):
        return f"{step.rule:<14} {task.reporting.describe(step.actions)}"
    far = f"back {counted(step.stuck - step.back, 'subgoal')}" if step.back else "back to the start"
    return f"stuck after {counted(step.stuck, 'subgoal')}: {far}, with new samples"


def summary(report: dict[str, Any]) -> list[str]:
    """The same in a few lines."""
    lines = []
    subplans, seconds = report["subplans"], report["planning_time_s"]
    if report["solved"]:
        lines.append(
            f"solved in {seconds:.2f} s: {counted(subplans, 'subplan')}, "
            f"{counted(report['actions'], 'action')}"
            + (f", {report['execution_time_s']:.0f} s to execute" if report["robot"] else "")
            + (
                f" (at least {report['execution_lower_bound_s']:.0f} s)"
                if "execution_lower_bound_s" in report
                else ""
            )
        )
    else:
        lines.append(f"not solved after {seconds:.2f} s: {report['reason']}")
        if "stuck" in report:
            values = ", ".join(f"{name} = {value}" for name, value in report["stuck"].items())
            when = f"after {counted(subplans, 'subgoal')}" if subplans else "at the start"
            lines.append(f"{when} the features are {values}")
        if "large" in report:
            large = report["large"]
            lines.append(f"  {large['value']} in a value stands for {large['stands_for']}")
        # What the reason says already is not said again.
        lines += [
            f"  {finding['text']}"
            for finding in report["why"]
            if finding["text"] not in str(report["reason"])
        ]
    fired = ", ".join(f"{rule} {count}x" for rule, count in report["rules_fired"].items())
    if fired:
        lines.append(f"rules: {fired}")
    back = report["retreats"]
    lines.append(
        f"search: {report['expanded']} expanded, {report['generated']} generated"
        + (f", went back {counted(back, 'time')}" if back else "")
    )
    for name, step in report["profile"].items():
        rejected = step["calls"] - step["successes"]
        lines.append(
            f"  {name:<19} {step['calls']:>6} asked, {rejected:>6} rejected,"
            f" {1000 * step['time_s']:>8.1f} ms"
        )
    return lines
