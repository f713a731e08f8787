"""The benchmark suite `ipc`: sketches on folders of PDDL tasks."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from domains.pddl.interface import domain_beside
from runtime.bench.store import Job
from sketchlang.errors import InputError
from sketchlang.loader import builtin_sketches, load_sketch, pddl_domain
from sketchlang.suggest import did_you_mean

Result = dict[str, Any]

PUBLISHED = {
    "barman": (40, 0, 40, 40, 40),
    "childsnack": (20, 0, 20, 6, 9),
    "driverlog": (20, 9, 20, 20, 20),
    "floortile": (40, 0, 40, 9, 6),
    "grid": (5, 1, 5, 5, 5),
    "schedule": (150, 81, 150, 150, 150),
    "tpp": (30, 11, 30, 30, 30),
}
"""Tasks, and how many of them SIW, SIW_R, LAMA and BFWS solve in 30 minutes and 8 GB (Drexler,
Seipp and Geffner, KR 2021)."""


def jobs_of(folder: Path, sketch: str | None, planner: str, timeout: float) -> list[Job]:
    """A job for every task below a folder, with the sketch of its domain.

    Raises:
        InputError: there are no tasks, or there is no sketch for one.
    """
    if not folder.is_dir():
        raise InputError("is no folder", place=str(folder))
    tasks = sorted(_tasks_below(folder), key=_natural)
    if not tasks:
        raise InputError("has no tasks (files ending in .pddl)", place=str(folder))
    return [Job(sketch or sketch_for(task), str(task), planner, 0, timeout) for task in tasks]


def _tasks_below(folder: Path) -> Iterator[Path]:
    """The tasks of a folder and those below it, which may be links: each is gone into once."""
    been: set[str] = set()
    for below, folders, names in os.walk(folder, followlinks=True):
        been.add(os.path.realpath(below))
        folders[:] = [
            name for name in folders if os.path.realpath(os.path.join(below, name)) not in been
        ]
        for name in names:
            if name.endswith(".pddl") and "domain" not in name:
                yield Path(below, name)


def _natural(path: Path) -> list[object]:
    """`p2` before `p10`."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", str(path))]


def sketch_for(task: Path) -> str:
    """The built-in sketch whose name the folder of a task begins with, or its domain bears.

    Raises:
        InputError: there is none.
    """
    known = builtin_sketches()
    names = [task.parent.name.lower()]
    words = re.search(r"\(\s*domain\s+([^\s()]+)", domain_beside(task).read_text(errors="replace"))
    if words:
        names.append(re.sub(r"[^a-z0-9]", "", words[1].lower()))
    for name in names:
        fitting = [sketch for sketch in known if name.startswith(sketch)]
        if fitting:
            return max(fitting, key=len)
    raise InputError(
        f"there is no built-in sketch for {names[0]}",
        place=str(task),
        hint=did_you_mean(names[0], known) or "name one with --sketch",
    )


def run_job(job: Job) -> Result:
    """Plan once, replay the plan, and say what came out. Runs in a process of its own."""
    from runtime.report import make_report
    from runtime.search.limits import Limits
    from runtime.solve import open_task
    from sketchlang.analysis.limits import peak_memory_mb

    domain = pddl_domain(str(domain_beside(job.scene)))
    task = open_task(load_sketch(job.sketch, None, domain).checked, job.scene, job.seed)
    result = task.solve(Limits(timeout=job.timeout), job.planner)
    report = make_report(result)
    if result.solved:
        verdict = result.plan.validate()
        report["valid"] = verdict.valid
        report["findings"] = [finding.message for finding in verdict.findings]
    widths = Counter(0 if len(s.actions) == 1 else s.width for s in result.outcome.subgoals)
    report["widths"] = {str(width): count for width, count in sorted(widths.items())}
    report["objects_moved"] = 0  # stores of all suites have it; here nothing is moved
    report["peak_mb"] = round(peak_memory_mb())
    return report


def table(results: Sequence[Result]) -> list[str]:
    """One line a sketch, with what was published beside it."""
    groups: dict[str, list[Result]] = {}
    for result in results:
        groups.setdefault(str(result["job"]["sketch"]), []).append(result)
    lines = [
        "| sketch | solved | valid | planning s (median; worst) | actions | expanded a second "
        "| subgoals of width 0; 1; 2 | worst MB | published: tasks | SIW | SIW_R | LAMA | BFWS |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for sketch, group in groups.items():
        solved = [result for result in group if result["solved"]]
        valid = sum(bool(result.get("valid")) for result in solved)
        cells = [sketch, f"{len(solved)}/{len(group)}", f"{valid}/{len(solved)}"]
        if solved:
            seconds = [result["planning_time_s"] for result in solved]
            rates = [r["expanded"] / r["planning_time_s"] for r in solved if r["planning_time_s"]]
            widths = [sum(r["widths"].get(str(k), 0) for r in solved) for k in range(3)]
            cells += [
                f"{median(seconds):.2f}; {max(seconds):.2f}",
                f"{median(result['actions'] for result in solved):.0f}",
                f"{median(rates):.0f}" if rates else "",
                "; ".join(map(str, widths)),
                str(max(result["peak_mb"] for result in group)),
            ]
        else:
            cells += [""] * 5
        cells += [str(number) for number in PUBLISHED.get(sketch, ("",) * 5)]
        lines.append("| " + " | ".join(cells) + " |")
    return lines
