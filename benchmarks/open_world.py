"""Things of any shape, towers, trays, grids and what cannot be: solved, certified, carried out.

    python -m benchmarks.open_world --out results.jsonl
    python -m benchmarks.open_world --out results.jsonl --table

Each line of the file is one run: a scene of `benchmarks/open_scenes.py`, a robot and a seed. Runs
that the file has are not made again, so that a series can be cut short (`--seconds`) and resumed.
Seconds are of the processor, from the scene in memory to the plan with its motions put together;
plans are judged as `validate` does and carried out in PyBullet as `execute` does. What cannot be
has to be named before the search, with the object.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from benchmarks.carried_out import SKETCH, carried_out, trace_of
from benchmarks.open_scenes import BUILT, GRIDS, IMPOSSIBLE, MOVED, SCENES
from runtime.search.limits import Limits
from runtime.search.siw_r import End
from runtime.solve import Result, open_task
from sketchlang.errors import InputError
from sketchlang.loader import load_sketch

ROBOTS = ("tiago", "franka_mobile")
PATIENCE = 60.0
"""Seconds by the clock after which a search is given up."""


def run(name: str, robot: str, seed: int, folder: Path, physics: bool) -> dict[str, Any]:
    """One run, as an object for a line of the file."""
    path = folder / f"{name}-{seed}.toml"
    path.write_text(SCENES[name](seed))
    task = open_task(load_sketch(SKETCH).checked, str(path), seed, robot)
    task.reporting.warm_up()
    begun = process_time()
    result = task.solve(Limits(timeout=PATIENCE))
    said: dict[str, Any] = {"scene": name, "robot": robot, "seed": seed, "solved": result.solved}
    said["cpu_s"] = round(process_time() - begun, 3)
    said["peak_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    if not result.solved:
        outcome = result.outcome
        return said | {"end": outcome.end.value, "reason": outcome.reason, "why": outcome.why}
    verdict = result.plan.validate()
    said["certified"] = verdict.valid
    said["execution_s"] = round(result.plan.execution_time, 1)
    if not verdict.valid:
        said["findings"] = [str(found.message) for found in verdict.findings][:3]
    try:
        return said | (_executed(result) if physics else {})
    except InputError as error:
        return said | {"executed": False, "error_mm": 0.0, "unmet": [str(error)]}


def _executed(result: Result) -> dict[str, Any]:
    report, error = carried_out(trace_of(result.task.problem.world, result.plan.plan))
    said = {"executed": report.success, "error_mm": round(1000 * error, 2)}
    if not report.success or report.slips:
        said["slips"] = [f"{slip.time:.1f} s {slip.object} {slip.what}" for slip in report.slips]
        said["unmet"] = list(report.unmet)
    return said


def table(lines: Sequence[dict[str, Any]]) -> str:
    """The results as a table in Markdown, one row a scene and robot."""
    rows = [
        "| scene | robot | solved | certified | executed | error, mm | CPU s, median | worst |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name in SCENES:
        for robot in dict.fromkeys(line["robot"] for line in lines):
            mine = [each for each in lines if (each["scene"], each["robot"]) == (name, robot)]
            if mine:
                rows.append(_row(name, robot, mine))
    return "\n".join(rows)


def _row(name: str, robot: str, lines: Sequence[dict[str, Any]]) -> str:
    seconds = [line["cpu_s"] for line in lines]
    tried = [line for line in lines if "executed" in line]
    if name in IMPOSSIBLE:
        named = sum(not line["solved"] and line["end"] == End.HOPELESS.value for line in lines)
        done = [f"named: {named} of {len(lines)}", "", "", ""]
    else:
        done = [
            f"{sum(line['solved'] for line in lines)} of {len(lines)}",
            f"{sum(line.get('certified', False) for line in lines)}",
            f"{sum(line['executed'] for line in tried)} of {len(tried)}" if tried else "",
            f"{max(line['error_mm'] for line in tried):.1f}" if tried else "",
        ]
    times = [f"{statistics.median(seconds):.2f}", f"{max(seconds):.2f}"]
    return "| " + " | ".join([name, robot, *done, *times]) + " |"


def main() -> None:
    """Go on with a series, or print its table."""
    groups = {"moved": MOVED, "built": BUILT, "grids": GRIDS, "impossible": IMPOSSIBLE}
    parser = argparse.ArgumentParser(description="Runs in the open world.")
    parser.add_argument("--out", type=Path, required=True, help="JSON lines; gone on with")
    parser.add_argument("--table", action="store_true", help="print the table and end")
    parser.add_argument("--only", nargs="*", default=list(groups), help="groups, or scenes")
    parser.add_argument("--robot", nargs="*", default=list(ROBOTS))
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--plans", action="store_true", help="do not carry plans out in PyBullet")
    parser.add_argument("--seconds", type=float, default=1e9, help="begin no run after that")
    arguments = parser.parse_args()
    text = arguments.out.read_text() if arguments.out.exists() else ""
    lines = [json.loads(line) for line in text.splitlines()]
    if arguments.table:
        print(table(lines))
        return
    names = [name for each in arguments.only for name in groups.get(each, [each])]
    there = {(line["scene"], line["robot"], line["seed"]) for line in lines}
    started = perf_counter()
    with tempfile.TemporaryDirectory() as folder, arguments.out.open("a") as file:
        for seed in range(arguments.seeds):
            for name in names:
                for robot in arguments.robot:
                    if (name, robot, seed) in there:
                        continue
                    if perf_counter() - started > arguments.seconds:
                        return
                    physics = name not in GRIDS and not arguments.plans
                    said = run(name, robot, seed, Path(folder), physics)
                    file.write(json.dumps(said) + "\n")
                    file.flush()


if __name__ == "__main__":
    main()
