"""How well the features' estimate of free approach headings agrees with inverse kinematics.

    python -m benchmarks.estimates [SCENE...]

For every object of a scene and every heading from which the robot could come, the estimate
(`domains/tabletop/features/swept.py`) says whether something bars the way. Here inverse
kinematics among obstacles says whether a grasp, with its approach and retreat, is found from one of
some random base poses. Prints how often the two differ, and in which direction: an optimistic
estimate sends the search after picks that fail, a pessimistic one moves objects needlessly.
"""

from __future__ import annotations

import sys
from collections import Counter

import numpy as np

from domains.tabletop.actions.actions import Pick
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.problem import TabletopProblem, load_problem
from domains.tabletop.state import UNIT, Grasp, State
from sketchlang.domain import LoadOptions
from sketchlang.library import find_scene

SCENES = ("sorting/3t-25", "sorting/1t-20", "sorting/4t-28", "non_monotonic/2t-11", "words/tamp")
BASES = 8
SEEDS = 12


def compare(problem: TabletopProblem, rng: np.random.Generator) -> Counter[tuple[bool, bool]]:
    """Counts of (estimated free, found by inverse kinematics)."""
    task = problem.world
    state = task.initial
    arrangement = task.arrangement(state.placements)
    counts: Counter[tuple[bool, bool]] = Counter()
    for index, placement in enumerate(state.placements):
        assert placement is not None
        free = arrangement.free_headings(index)
        for k in range(HEADINGS):
            if not (task.reachable_at(placement) >> k) & 1:
                continue
            heading = k * STEP - placement.yaw * UNIT
            grasp = Grasp.of(heading, task.shapes[index].grasp_height)
            found = False
            for _ in range(BASES):
                base = problem.sampler.bases.pose_for(placement, grasp, rng)
                if base is not None:
                    here = State(base, state.placements, task=task)
                    action = Pick(index, grasp)
                    found = problem.executor.inverse_kinematics(here, action, SEEDS) is not None
                if found:
                    break
            counts[bool((free >> k) & 1), found] += 1
    return counts


def main() -> None:
    """Print a table."""
    print("| scene | headings | agree | optimistic | pessimistic |")
    print("|---|---|---|---|---|")
    for name in sys.argv[1:] or SCENES:
        problem = load_problem(str(find_scene(name)[0]), LoadOptions(name))
        counts = compare(problem, np.random.default_rng(0))
        total = sum(counts.values())
        agree = counts[True, True] + counts[False, False]
        print(
            f"| {name} | {total} | {100 * agree / total:.0f} % "
            f"| {counts[True, False]} | {counts[False, True]} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
