"""Searches of a whole problem: no sketch cuts it, and the goal is the only subgoal.

They are what a sketch is compared with: the same problem, the same executability X, and samples
of the same sampling function A, drawn once for the whole problem and kept while the search lasts,
as the template grids of Ferrer-Mestres, Frances and Geffner (2017) are. A problem whose samples
depend on the subproblem offers them (`Whole`); where all actions are known, nothing is sampled.
Of a sketch they take the goal and the novelty atoms, and no rule.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol, runtime_checkable

import numpy as np

from runtime.search.bfws import BestFirstWidth, open_goals
from runtime.search.brfs import brfs
from runtime.search.limits import Limits
from runtime.search.problem import SearchProblem, State, Subproblem
from runtime.search.query import Query
from runtime.search.retreat import Planner, serialize
from runtime.search.siw_r import (
    Outcome,
    Progress,
    Search,
    Step,
    Turns,
    eager,
    schedule,
    steps_to,
)
from sketchlang.compile import CompiledSketch


@runtime_checkable
class Whole(Protocol):
    """A problem that can be sampled as a whole."""

    def whole(self, attempt: int, rng: np.random.Generator) -> Subproblem:
        """Samples for all of the problem; denser with each attempt."""
        ...


@runtime_checkable
class Counting(Protocol):
    """A problem with counters for best-first searches, for which no sketch is asked."""

    def counters(self, state: State) -> tuple[int, ...]:
        """#g, how many goals are open, and what is in the way of them, where that is known."""
        ...


@dataclass(frozen=True, eq=False)
class WholeProblem:
    """A problem as these searches see it."""

    problem: SearchProblem

    @property
    def initial(self) -> State:
        """Where the task starts."""
        return self.problem.initial

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Subproblem:
        """Samples for the whole problem, or all its actions."""
        if isinstance(self.problem, Whole):
            return self.problem.whole(attempt, rng)
        return self.problem.subproblem(state, attempt, rng)


def _solve(
    search: Search,
    turns: Turns,
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    progress: Progress | None = None,
) -> Outcome:
    """Solve a problem in one go. Time is the only limit: there is no subproblem to give up."""
    never = sys.maxsize
    patient = replace(limits, rejections=never, refusals=never, generated=never, blind=never)
    goal_only = replace(sketch, model=replace(sketch.model, rules=()))
    return serialize(search, goal_only, WholeProblem(problem), patient, rng, progress, turns)


def _denser(limits: Limits, guided: bool) -> Iterator[tuple[int, int]]:
    """Turns of a search that tries all states: denser samples, should the first not do."""
    for attempt in range(limits.attempts):
        yield attempt, limits.k_max


def _once(limits: Limits, guided: bool) -> Iterator[tuple[int, int]]:
    """The only turn where all actions are known."""
    yield 0, limits.k_max


def _turns(problem: SearchProblem) -> Turns:
    """Samples of growing density, where there are samples."""
    return _denser if isinstance(problem, Whole) else _once


def _breadth_first(query: Query) -> tuple[list[Step], str] | None:
    return steps_to(brfs(query))


def _best_first(query: Query, problem: SearchProblem) -> tuple[list[Step], str] | None:
    def by_goal(state: State) -> tuple[int, ...]:
        return (open_goals(query.guide, state),)

    counters = problem.counters if isinstance(problem, Counting) else by_goal
    return steps_to(BestFirstWidth(query, counters).run())


def brfs_whole(
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    progress: Progress | None = None,
) -> Outcome:
    """Breadth-first search for the goal."""
    return _solve(_breadth_first, _turns(problem), sketch, problem, limits, rng, progress)


def bfws_whole(
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    progress: Progress | None = None,
) -> Outcome:
    """BFWS for the goal."""
    search = partial(_best_first, problem=problem)
    return _solve(search, _turns(problem), sketch, problem, limits, rng, progress)


iw_whole: Planner = partial(_solve, eager, schedule)
"""IW for the goal: IW(1) on samples of growing density, then wider."""
