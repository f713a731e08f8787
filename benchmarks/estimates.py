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
from domains.tabletop.features.functions import arrangement
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.problem import TabletopProblem, load_problem
from domains.tabletop.state import Grasp, Placement, State
from runtime.search.problem import Rejection
from sketchlang.domain import LoadOptions
from sketchlang.library import find_scene

SCENES = ("sorting/3t-25", "sorting/1t-20", "sorting/4t-28", "non_monotonic/2t-11", "words/tamp")
BASES = 8
SEEDS = 12


def compare(problem: TabletopProblem, rng: np.random.Generator) -> Counter[tuple[bool, bool]]:
    """Counts of (estimated free, found by inverse kinematics), over all families of grasps."""
    world = problem.world
    state = world.initial
    here = arrangement(world, state.placements)
    counts: Counter[tuple[bool, bool]] = Counter()
    for index, placement in enumerate(state.placements):
        at = world.rests(state.placements, index)
        assert placement is not None
        assert at is not None
        for family in world.families:
            free = here.free_headings(index, family)
            reachable = int(here.picks[family].reachable[index])
            angles = np.arange(HEADINGS) * STEP - at[3]
            hold = world.items[index].holds(world.hand, family, angles)
            for k in range(HEADINGS):
                if hold is None or not (reachable >> k) & 1:
                    continue
                grasp = world.items[index].grasp(hold, k, float(angles[k]))
                found = _is_taken(problem, state, index, placement, grasp, rng)
                counts[bool((free >> k) & 1), found] += 1
    return counts


def _is_taken(
    problem: TabletopProblem,
    state: State,
    index: int,
    placement: Placement,
    grasp: Grasp,
    rng: np.random.Generator,
) -> bool:
    """Whether inverse kinematics finds a grasp from one of some base poses."""
    for _ in range(BASES):
        base = problem.sampler.bases.pose_for(state, index, placement, grasp, rng)
        if base is not None:
            motion = Pick(index, grasp).motion(problem.executor, state.driven(base), SEEDS)
            if not isinstance(motion, Rejection) or motion.step == "motion_plan":
                return True
    return False


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
