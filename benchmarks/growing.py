"""What a subgoal costs among many objects: scenes at the density of `sorting/4t-28`.

python -m benchmarks.growing [NUMBER...]

One run of Lazy-SIIW_R for each number of objects, seed 0, in a process of its own: processor time
of the search, and the most memory that the process had.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import process_time

import numpy as np

from domains.tabletop.scene.generate import sorting_scene
from runtime.search.limits import Limits
from runtime.solve import open_task, solve
from sketchlang.loader import load_sketch

NUMBERS = (28, 200, 1000)
PATIENCE = 600.0
"""Seconds after which a search is given up."""


def measured(number: int) -> str:
    """A row of the table."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        path.write_text(sorting_scene(number, number))
        task = open_task(load_sketch("pick_and_place").checked, str(path), 0)
    task.reporting.warm_up()
    begun = process_time()
    rng = np.random.default_rng(0)
    outcome = solve(task.sketch, task.problem, Limits(timeout=PATIENCE), rng)
    seconds, subgoals = process_time() - begun, len(outcome.subgoals)
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    each = 1000 * seconds / max(1, subgoals)
    solved = "yes" if outcome.solved else "no"
    return f"| {number} | {solved} | {subgoals} | {seconds:.2f} | {each:.0f} | {megabytes:.0f} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    if given[:1] == ["--child"]:
        print(measured(int(given[1])))
        return
    print("| objects | solved | subplans | s | ms a subplan | peak MB |")
    print("|---|---|---|---|---|---|")
    for number in [int(each) for each in given] or NUMBERS:
        command = [sys.executable, "-m", "benchmarks.growing", "--child", str(number)]
        print(subprocess.run(command, capture_output=True, text=True, check=True).stdout, end="")


if __name__ == "__main__":
    main()
