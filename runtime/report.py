"""What `run` says about an outcome, for programs and for people."""

from __future__ import annotations

from collections import Counter
from typing import Any

from runtime.search.problem import SearchProblem
from runtime.search.siw_r import Outcome
from sketchlang import __version__
from sketchlang.model import SketchModel


def make_report(
    model: SketchModel,
    problem: SearchProblem,
    scene: str,
    planner: str,
    seed: int,
    outcome: Outcome,
    seconds: float,
) -> dict[str, Any]:
    """The object that `run --json` prints."""
    profile = problem.profile_dict()
    report: dict[str, Any] = {
        "sketch": model.name,
        "scene": scene,
        "planner": planner,
        "robot": problem.robot_name(),
        "seed": seed,
        "solved": outcome.solved,
        "planning_time_s": round(seconds, 4),
        "execution_time_s": round(problem.execution_time(outcome), 2),
        "expanded": outcome.effort.expanded,
        "generated": outcome.effort.generated,
        "subplans": len(outcome.subgoals),
        "actions": sum(len(subgoal.actions) for subgoal in outcome.subgoals),
        "motion_plans": profile.get("motion_plan", {}).get("successes", 0),
        "rules_fired": dict(Counter(subgoal.rule for subgoal in outcome.subgoals)),
        "profile": profile,
        "version": __version__,
    }
    if not outcome.solved:
        report["reason"] = outcome.reason
        report["rejected"] = outcome.rejected
        report["obstacles"] = problem.obstacles(outcome.state)
        if outcome.stuck is not None:
            names = [feature.name for feature in model.features]
            report["stuck_at"] = dict(zip(names, outcome.stuck, strict=True))
    return report


def summary(model: SketchModel, report: dict[str, Any], outcome: Outcome) -> list[str]:
    """The same in a few lines."""
    lines = []
    subplans, seconds = report["subplans"], report["planning_time_s"]
    if report["solved"]:
        lines.append(
            f"solved in {seconds:.2f} s: {subplans} subplans, {report['actions']} actions"
            + (f", {report['execution_time_s']:.0f} s to execute" if report["robot"] else "")
        )
    else:
        lines.append(f"not solved after {seconds:.2f} s: {report['reason']}")
        if outcome.stuck is not None:
            values = ", ".join(
                f"{feature.name} = {value}"
                for feature, value in zip(model.features, outcome.stuck, strict=True)
            )
            lines.append(f"reached {subplans} subgoals; there the features are {values}")
        lines += [f"  {obstacle}" for obstacle in report["obstacles"]]
        died = ", ".join(f"{count} at {name}" for name, count in report["rejected"].items())
        if died:
            lines.append(f"candidates rejected in the last subproblem: {died}")
    fired = ", ".join(f"{rule} {count}x" for rule, count in report["rules_fired"].items())
    if fired:
        lines.append(f"rules: {fired}")
    lines.append(f"search: {report['expanded']} expanded, {report['generated']} generated")
    for name, step in report["profile"].items():
        rejected = step["calls"] - step["successes"]
        lines.append(
            f"  {name:<19} {step['calls']:>6} asked, {rejected:>6} rejected,"
            f" {1000 * step['time_s']:>8.1f} ms"
        )
    return lines
