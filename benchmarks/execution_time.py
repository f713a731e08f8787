"""How long plans take to carry out, by part: the tables of `docs/execution-time.md`.

python -m benchmarks.execution_time --scenes sorting/4t-28 --seeds 0-9 [--improve 5] [--check]

A row a scene: medians over the seeds. "Moves" columns are the seconds in which a part moves;
parts may move at once, so they may add up to more than the whole. `--check` certifies every plan,
as a run of its sketch as well, and carries it out in PyBullet. `--keep FILE` writes a line of
JSON a run, `--against FILE` compares with such lines.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.carried_out import SKETCH, carried_out, trace_of
from runtime.bench.paper import SCENES
from runtime.reporting import Document
from runtime.search.limits import Limits
from runtime.solve import Task, open_task
from runtime.trace.model import Trace
from sketchlang.loader import load_sketch

STILL = 1e-3
"""Metres or radians a second below which something counts as resting."""

TICK = 0.02
"""Seconds between the samples of a trace."""

PARTS = ("drives", "turns", "lift", "arm free", "arm loaded", "fingers", "base alone", "arm alone")


def parts_of(trace: Trace) -> dict[str, float]:
    """Seconds in which each part moves."""
    times = np.arange(0.0, trace.duration, TICK)
    base, joints = np.abs(trace.base.at(times)[1]), np.abs(trace.joints.at(times)[1])
    slides = np.array([trace.robot.joint(name).type == "prismatic" for name in trace.robot.joints])
    drives, turns = np.hypot(base[:, 0], base[:, 1]) > STILL, base[:, 2] > STILL
    lift = (joints[:, slides] > STILL).any(axis=1)
    arm = (joints > STILL).any(axis=1)
    fingers = np.abs(trace.opening.at(times)[1][:, 0]) > STILL / 10
    loaded = np.array([any(trace.held_at(i, t) for i in range(len(trace.objects))) for t in times])
    moving = drives | turns
    found = (
        drives,
        turns & ~drives,
        lift,
        arm & ~loaded,
        arm & loaded,
        fingers,
        moving & ~arm,
        arm & ~moving,
    )
    return {name: float(part.sum()) * TICK for name, part in zip(PARTS, found, strict=True)}


def runs(scene: str, seeds: Sequence[int], options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One record a seed."""
    sketch = load_sketch(SKETCH)
    for seed in seeds:
        task = open_task(sketch.checked, scene, seed, options.robot)
        extra = {}
        if options.improve or options.improve_steps is not None:
            extra = {"improve": improvement(options)}
        result = task.solve(Limits(timeout=300.0), **extra)
        if not result.solved:
            yield {"scene": scene, "seed": seed, "solved": False}
            continue
        world, plan = task.problem.world, result.plan.plan  # type: ignore[attr-defined]
        trace = trace_of(world, plan)
        record = {
            "scene": scene,
            "seed": seed,
            "solved": True,
            "time": plan.execution_time,
            "planning": result.outcome.seconds,
            "actions": len(plan.actions),
            "grasps": sum(grip.attach for grip in trace.grips),
            "bound": getattr(result.plan, "execution_lower_bound", None),
            **parts_of(trace),
        }
        if options.check:
            record |= checked(task, result.plan, trace)
        yield record


def improvement(options: argparse.Namespace) -> Any:
    """How long plans are improved."""
    from runtime.improve import Improvement

    return Improvement(options.improve, options.improve_steps)


def checked(task: Task, document: Document, trace: Trace) -> dict[str, Any]:
    """Whether a plan is certified, a run of its sketch, and ends in PyBullet where it should."""
    from domains.tabletop.actions.retrace import retrace
    from runtime.judge.certify import certify
    from runtime.judge.run_of_sketch import Snapshots, moment_faults, run_faults

    world, plan = task.problem.world, document.plan  # type: ignore[attr-defined]
    seen = Snapshots(plan)
    certificate = certify(plan, world.scene.world, world.robot, seen)
    moments = retrace(plan, world, task.sketch)
    faults = [finding.message for finding in certificate.findings]
    faults += [*run_faults(plan, task.sketch.model, moments), *moment_faults(moments, seen.moments)]
    report, error = carried_out(trace)
    return {
        "faults": faults,
        "executed": report.success,
        "error": error,
        "touches": len(report.touches),
    }


def table(records: Sequence[dict[str, Any]], against: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Lines of the table."""
    columns = ["scene", "solved", "planning", "actions", "seconds", *PARTS, "bound", "ratio"]
    columns += ["before", "less"] if against else []
    columns += ["certified", "executed"] if any("faults" in r for r in records) else []
    yield "| " + " | ".join(columns) + " |"
    yield "|---" * len(columns) + "|"
    for scene in dict.fromkeys(record["scene"] for record in records):
        own = [r for r in records if r["scene"] == scene]
        good = [r for r in own if r["solved"]]
        if not good:
            yield f"| {scene} | 0/{len(own)} |"
            continue
        row = [scene, f"{len(good)}/{len(own)}", f"{_middle(good, 'planning'):.2f} s"]
        row += [f"{_middle(good, 'actions'):.0f}", f"{_middle(good, 'time'):.0f}"]
        row += [f"{_middle(good, part):.0f}" for part in PARTS]
        bounds = [r for r in good if r["bound"]]
        row += [f"{_middle(bounds, 'bound'):.0f}"] if bounds else [""]
        row += [f"{median(r['time'] / r['bound'] for r in bounds):.2f}"] if bounds else [""]
        if against:
            old = {r["seed"]: r for r in against if r["scene"] == scene and r["solved"]}
            both = [(old[r["seed"]]["time"], r["time"]) for r in good if r["seed"] in old]
            less = 1 - sum(new for _, new in both) / sum(was for was, _ in both) if both else 0.0
            row += [f"{median([was for was, _ in both]):.0f}", f"{100 * less:.0f} %"]
        if any("faults" in r for r in good):
            row += [f"{sum(not r['faults'] for r in good)}", f"{sum(r['executed'] for r in good)}"]
        yield "| " + " | ".join(row) + " |"


def _middle(records: Sequence[dict[str, Any]], key: str) -> float:
    return float(median(record[key] for record in records))


def _numbers(text: str) -> list[int]:
    first, _, last = text.partition("-")
    return list(range(int(first), int(last or first) + 1))


def main() -> None:
    """Run, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--scenes", nargs="+", default=SCENES)
    parser.add_argument("--seeds", type=_numbers, default=range(10))
    parser.add_argument("--robot")
    parser.add_argument("--improve", type=float, default=0.0)
    parser.add_argument("--improve-steps", type=int)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--against", type=Path)
    options = parser.parse_args()
    records: list[dict[str, Any]] = []
    for scene in options.scenes:
        for record in runs(scene, options.seeds, options):
            records.append(record)
            said = {k: round(v, 2) if isinstance(v, float) else v for k, v in record.items()}
            print(json.dumps(said), file=sys.stderr, flush=True)
    if options.keep is not None:
        options.keep.write_text("".join(json.dumps(record) + "\n" for record in records))
    against: list[dict[str, Any]] = []
    if options.against is not None:
        against = [json.loads(line) for line in options.against.read_text().splitlines()]
    print("\n".join(table(records, against)))


if __name__ == "__main__":
    main()
