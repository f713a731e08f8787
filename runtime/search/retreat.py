"""Runs of SIW_R, and what they do where they get stuck: they go back some subgoals.

Sampled subgoals can be unlucky: an object was put where it walls in another one, or is held by a
grasp that does not serve at its goal. No samples of the next subproblem mend that, so the run goes
back and draws anew: one subgoal at first, then 2, 4, ..., each time it is stuck again without
having come further than ever before, and from the start when that, or the last retreat, is reached.

What has to fail fails soon all the same: nothing is gone back to where samples are not what was at
fault (all actions were known, or the first subproblem of all has no solution), and the subproblems
that are searched again get a part of the patience of others.
"""

from __future__ import annotations

from functools import partial
from typing import Protocol

import numpy as np

from runtime.search.limits import Limits
from runtime.search.problem import SearchProblem
from runtime.search.siw_r import (
    End,
    Outcome,
    Progress,
    Retreat,
    Search,
    Turns,
    eager,
    lazy,
    schedule,
    subgoals,
)
from sketchlang.compile import CompiledSketch


def serialize(
    search: Search,
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    progress: Progress | None = None,
    turns: Turns = schedule,
) -> Outcome:
    """Solve a problem subgoal by subgoal. All randomness comes from `rng`.

    An outcome that is not solved is that of the first time the run got stuck: no later subproblem
    was searched with more patience.
    """

    def run(outcome: Outcome, hasty: int) -> None:
        found = subgoals(search, sketch, problem, limits, rng, outcome, turns, hasty)
        for subgoal in found:
            if progress is not None:
                progress(subgoal, limits.elapsed())

    first = outcome = Outcome(state=problem.initial)
    run(first, 0)
    furthest, step = len(first.subgoals), 1
    while _was_unlucky(outcome) and len(first.retreats) < limits.retreats:
        stuck, is_last = len(outcome.subgoals), len(first.retreats) + 1 == limits.retreats
        retreat = Retreat(stuck, 0 if is_last else max(0, stuck - step))
        first.retreats.append(retreat)
        if progress is not None:
            progress(retreat, limits.elapsed())
        outcome = _back(outcome, problem, retreat.back)
        run(outcome, furthest + 1)
        if len(outcome.subgoals) > furthest:
            furthest, step = len(outcome.subgoals), 1
        elif retreat.back == 0:
            break
        else:
            step *= 2
    first.seconds = outcome.seconds = limits.elapsed()
    return outcome if outcome.solved else first


def _was_unlucky(outcome: Outcome) -> bool:
    """Whether a run is stuck where other samples may not have led it."""
    if outcome.solved or outcome.end not in (End.NO_SUBGOAL, End.NO_RULE) or outcome.last is None:
        return False
    _, tried = outcome.last
    return bool(outcome.subgoals) and any(getattr(one, "sampled", False) for one in tried)


def _back(outcome: Outcome, problem: SearchProblem, to: int) -> Outcome:
    """A run as it was after so many subgoals."""
    kept = outcome.subgoals[:to]
    return Outcome(
        subgoals=kept,
        effort=outcome.effort,
        state=kept[-1].states[-1] if kept else problem.initial,
        retreats=outcome.retreats,
    )


class Planner(Protocol):
    """A way to solve problems, subgoal by subgoal."""

    def __call__(
        self,
        sketch: CompiledSketch,
        problem: SearchProblem,
        limits: Limits,
        rng: np.random.Generator,
        progress: Progress | None = None,
    ) -> Outcome: ...


siw_r: Planner = partial(serialize, eager)
lazy_siiw_r: Planner = partial(serialize, lazy)
