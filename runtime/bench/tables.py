"""Tables of benchmark results, in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from statistics import median
from typing import Any

from runtime.bench.paper import ROWS

Result = dict[str, Any]


def main_table(results: Sequence[Result]) -> list[str]:
    """The paper's columns, and its figures beside ours."""
    lines = [
        "| scene | planner | solved | certified | planning s (median; worst) | paper min "
        "| execution min | paper min | total min | expanded | paper | subplans | paper |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for (scene, planner), group in _groups(results):
        solved = [result for result in group if result["solved"]]
        valid = sum(bool(result.get("valid")) for result in solved)
        paper = ROWS.get((scene, planner))
        cells = [scene, planner, f"{len(solved)}/{len(group)}", f"{valid}/{len(solved)}"]
        if solved:
            planning = [result["planning_time_s"] for result in solved]
            execution = median(result["execution_time_s"] for result in solved) / 60
            cells += [
                f"{median(planning):.2f}; {max(planning):.2f}",
                f"{paper.planning_min:.2f}" if paper else "",
                f"{execution:.1f}",
                f"{paper.execution_min:.1f}" if paper else "",
                f"{execution + median(planning) / 60:.1f}",
                f"{median(result['expanded'] for result in solved):.0f}",
                str(paper.expanded) if paper else "",
                f"{median(result['subplans'] for result in solved):.0f}",
                str(paper.subplans) if paper else "",
            ]
        else:
            cells += [""] * 9
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def profile_table(results: Iterable[Result]) -> list[str]:
    """The paper's second table: what each step of X costs and lets through."""
    totals: dict[tuple[str, str], list[float]] = {}
    for result in results:
        for step, numbers in result["profile"].items():
            row = totals.setdefault((result["planner"], step), [0.0, 0.0, 0.0])
            row[0] += numbers["calls"]
            row[1] += numbers["successes"]
            row[2] += numbers["time_s"]
    lines = ["| planner | step | calls | success | time a call |", "|---|---|---|---|---|"]
    for (planner, step), (calls, successes, seconds) in totals.items():
        if calls:
            share, each = 100 * successes / calls, 1e6 * seconds / calls
            lines.append(
                f"| {planner} | {step} | {calls:.0f} | {share:.0f} % | {_duration(each)} |"
            )
    return lines


def share_table(results: Sequence[Result]) -> list[str]:
    """Where the planning time goes: the steps of X, and the rest (features, samples, search)."""
    lines = ["| scene | planner | MotionPlan | InverseKinematics | rest |", "|---|---|---|---|---|"]
    for (scene, planner), group in _groups(results):
        total = sum(result["planning_time_s"] for result in group)
        if not total:
            continue
        shares = [
            sum(result["profile"].get(step, {}).get("time_s", 0.0) for result in group) / total
            for step in ("motion_plan", "inverse_kinematics")
        ]
        cells = " | ".join(f"{100 * share:.0f} %" for share in [*shares, 1 - sum(shares)])
        lines.append(f"| {scene} | {planner} | {cells} |")
    return lines


def ratio_lines(results: Sequence[Result]) -> list[str]:
    """How much longer SIW_R plans than Lazy-SIIW_R, scene by scene."""
    medians = {
        name: median(result["planning_time_s"] for result in group if result["solved"])
        for name, group in _groups(results)
        if any(result["solved"] for result in group)
    }
    lines = []
    for (scene, planner), seconds in medians.items():
        lazy = medians.get((scene, "lazy-siiw-r"))
        if planner == "siw-r" and lazy:
            lines.append(f"{scene}: SIW_R takes {seconds / lazy:.1f} times as long as Lazy-SIIW_R")
    return lines


def scaling_table(results: Sequence[Result]) -> list[str]:
    """Time, nodes and memory against the number of objects."""
    lines = [
        "| objects | moved | solved | planning s | ms an object moved | expanded an object moved "
        "| peak MB |",
        "|---|---|---|---|---|---|---|",
    ]
    for (scene, _), group in _groups(results):
        solved = [result for result in group if result["solved"]]
        if not solved:
            lines.append(f"| {size_of(scene)} | | 0/{len(group)} | | | | |")
            continue
        moved = max(1.0, median(result["objects_moved"] for result in solved))
        seconds = median(result["planning_time_s"] for result in solved)
        expanded = median(result["expanded"] for result in solved)
        lines.append(
            f"| {size_of(scene)} | {moved:.0f} | {len(solved)}/{len(group)} | {seconds:.2f} "
            f"| {1000 * seconds / moved:.0f} | {expanded / moved:.1f} "
            f"| {max(result['peak_mb'] for result in solved)} |"
        )
    return lines


def size_of(scene: str) -> int:
    """The number of objects of a generated scene, from its name."""
    return int(scene.rsplit("/", 1)[-1].removesuffix(".toml").split("-")[1])


def _groups(results: Sequence[Result]) -> list[tuple[tuple[str, str], list[Result]]]:
    groups: dict[tuple[str, str], list[Result]] = {}
    for result in results:
        groups.setdefault((result["job"]["scene"], result["planner"]), []).append(result)
    return list(groups.items())


def _duration(microseconds: float) -> str:
    if microseconds < 1000:
        return f"{microseconds:.0f} us"
    return f"{microseconds / 1000:.1f} ms"
