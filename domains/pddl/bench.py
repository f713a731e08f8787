"""The benchmark suite `ipc`: sketches on folders of PDDL tasks."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from domains.pddl.interface import domain_beside
from runtime.bench.job import key
from runtime.bench.statistics import quantile
from runtime.bench.suite import TIMEOUT, Block, Suite
from runtime.bench.suite_file import natural
from runtime.bench.table import Table, count, seconds
from sketchlang.errors import InputError
from sketchlang.loader import PDDL, builtin_sketches
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


def suite_of(
    folder: Path, sketch: str | None, planner: str = "siw-r", timeout: float = TIMEOUT
) -> Suite:
    """Every task below a folder once, with the sketch of its domain.

    Raises:
        InputError: there are no tasks, or there is no sketch for one.
    """
    if not folder.is_dir():
        raise InputError("is no folder", place=str(folder))
    tasks = sorted(_tasks_below(folder), key=lambda path: natural(path.as_posix()))
    if not tasks:
        raise InputError("has no tasks (files ending in .pddl)", place=str(folder))
    if sketch is not None and os.path.isfile(sketch):
        sketch = os.path.relpath(sketch, folder)
    by_sketch: dict[str, list[str]] = {}
    for task in tasks:
        name = task.relative_to(folder).as_posix()
        by_sketch.setdefault(sketch or sketch_for(task), []).append(name)
    blocks = (
        Block((name,), tuple(paths), (planner,), (0,), timeout=timeout)
        for name, paths in by_sketch.items()
    )
    return Suite("ipc", tuple(blocks), str(folder), "ipc")


def _tasks_below(folder: Path) -> Iterator[Path]:
    """The tasks of a folder and those below it, which may be links: each is gone into once."""
    been: set[str] = set()
    for below, folders, names in os.walk(folder, followlinks=True):
        been.add(os.path.realpath(below))
        folders[:] = [
            name for name in folders if os.path.realpath(os.path.join(below, name)) not in been
        ]
        for name in names:
            if name.endswith(PDDL) and "domain" not in name:
                yield Path(below, name)


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


def tables(results: Sequence[Result]) -> list[Table]:
    """One line a sketch and planner, with what was published beside it."""
    of: dict[tuple[str, str], list[Result]] = {}
    for result in results:
        job = key(result)
        of.setdefault((Path(job.sketch).stem, job.planner), []).append(result)
    found = [
        Table(
            "PDDL tasks",
            ("sketch", "planner", "solved", "valid", "s", "worst", "actions", "worst MB"),
            tuple((*pair, *_solved(group)) for pair, group in of.items()),
            2,
            ("Medians and the worst, over the solved tasks.",),
        ),
        Table(
            "Search",
            ("sketch", "planner", "nodes", "a second", "subgoals of width 0; 1; 2"),
            tuple((*pair, *_searched(group)) for pair, group in of.items()),
        ),
        Table(
            "Published: tasks, and how many of them were solved",
            ("sketch", "tasks", "SIW", "SIW_R", "LAMA", "BFWS"),
            tuple(
                (sketch, *map(str, PUBLISHED[sketch]))
                for sketch in dict.fromkeys(sketch for sketch, _ in of)
                if sketch in PUBLISHED
            ),
            1,
            ("In 30 minutes and 8 GB (Drexler, Seipp and Geffner, KR 2021).",),
        ),
    ]
    return [table for table in found if table.rows]


def _solved(group: list[Result]) -> tuple[str, ...]:
    solved = [result for result in group if result["solved"]]
    valid = sum(bool(result.get("valid")) for result in solved)
    counts = (f"{len(solved)}/{len(group)}", f"{valid}/{len(solved)}")
    if not solved:
        return (*counts, "", "", "", "")
    took = [result["planning_time_s"] for result in solved]
    return (
        *counts,
        seconds(quantile(took, 0.5)),
        seconds(max(took)),
        count(quantile([result["actions"] for result in solved], 0.5)),
        count(max(result["peak_mb"] for result in group)),
    )


def _searched(group: list[Result]) -> tuple[str, ...]:
    solved = [result for result in group if result["solved"]]
    rates = [r["expanded"] / r["planning_time_s"] for r in solved if r["planning_time_s"]]
    widths = [sum(r.get("widths", {}).get(str(k), 0) for r in solved) for k in range(3)]
    if not solved:
        return "", "", ""
    nodes = quantile([result["expanded"] for result in solved], 0.5)
    rate = quantile(rates, 0.5) if rates else None
    return count(nodes), count(rate), "; ".join(map(str, widths))
