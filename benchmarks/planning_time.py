"""Processor time of planning, beside that of another work tree: the table of `docs/benchmarks.md`.

python -m benchmarks.planning_time [SCENE...] [--other TREE] [--seeds N] [--rounds N]

Each round plans a scene with all seeds, in a process of this tree and one of the other, in turn, so
that both see the same machine. Of each seed the quickest of the rounds counts; what is loaded and
compiled before is not counted. `then` are the milliseconds, median, in which the motions of the
plan are put together in time.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Literal

from runtime.bench.paper import SCENES

ROOT = Path(__file__).resolve().parent.parent

INNER = """
import json, sys, time
import numpy as np
from runtime.search.limits import Limits
from sketchlang.loader import load_sketch
scene, seeds = sys.argv[1], int(sys.argv[2])
checked = load_sketch("pick_and_place").checked
try:
    from runtime.solve import open_task, solve
    def planner(seed):
        task = open_task(checked, scene, seed)
        task.reporting.warm_up()
        def plan():
            task.reporting.hopeless()
            rng = np.random.default_rng(seed)
            return solve(task.sketch, task.problem, Limits(timeout=60.0), rng)
        def together(outcome):
            task.reporting.document(task.sketch.model, outcome, "lazy-siiw-r", seed)
        return plan, together
except ImportError:  # before there was one way to solve
    from runtime.scene.library import find_scene
    from runtime.search.planners import PLANNERS
    from sketchlang.compile import compile_sketch
    sketch = compile_sketch(checked)
    def planner(seed):
        path, name = find_scene(scene)
        problem = checked.domain.load(str(path), {"seed": seed, "name": name})
        problem.warm_up()
        rng = np.random.default_rng(seed)
        plan = lambda: PLANNERS["lazy-siiw-r"](sketch, problem, Limits(timeout=60.0), rng)
        return plan, lambda outcome: None
plan, together = planner(0)
together(plan())
rows = []
for seed in range(seeds):
    plan, together = planner(seed)
    begun = time.process_time()
    outcome = plan()
    found = time.process_time()
    together(outcome)
    done = time.process_time()
    subgoals = len(outcome.subgoals)
    rows.append((1000 * (found - begun), outcome.solved, subgoals, 1000 * (done - found)))
print(json.dumps(rows))
"""

Row = tuple[float, bool, int, float]
"""Milliseconds of the search, whether it was solved, the number of subplans, and milliseconds of
putting the motions together in time."""


def planned(tree: Path, scene: str, seeds: int) -> list[Row]:
    """One row a seed, by the planner of a work tree."""
    done = subprocess.run(
        [sys.executable, "-c", INNER, scene, str(seeds)],
        cwd=tree,
        env={**os.environ, "PYTHONPATH": str(tree)},
        capture_output=True,
        text=True,
        check=True,
    )
    return [(row[0], row[1], row[2], row[3]) for row in json.loads(done.stdout.splitlines()[-1])]


def quickest(rounds: Sequence[Sequence[Row]], what: Literal[0, 3] = 0) -> list[float]:
    """Milliseconds of each seed in its quickest round, of the search or of what comes then."""
    return [min(row[what] for row in rows) for rows in zip(*rounds, strict=True)]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", default=list(SCENES))
    parser.add_argument("--other", type=Path, help="another work tree")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args(arguments)
    print(
        "| scene | solved | subplans | ms, median | worst | worst / median | other | ratio | then |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        ours: list[list[Row]] = []
        others: list[list[Row]] = []
        for _ in range(options.rounds):
            if options.other is not None:
                others.append(planned(options.other.resolve(), scene, options.seeds))
            ours.append(planned(ROOT, scene, options.seeds))
        times, rows = quickest(ours), ours[0]
        middle = median(times)
        cells = [
            scene,
            f"{sum(row[1] for row in rows)}/{len(rows)}",
            f"{max(row[2] for row in rows)}",
            f"{middle:.0f}",
            f"{max(times):.0f}",
            f"{max(times) / middle:.1f}",
        ]
        other = median(quickest(others)) if others else None
        cells += ["", ""] if other is None else [f"{other:.0f}", f"{middle / other:.2f}"]
        cells.append(f"{median(quickest(ours, 3)):.0f}")
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
