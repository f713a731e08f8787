"""SIW_R: one IW search a subgoal, guided by a sketch (Bonet & Geffner 2021; paper, SIW_R).

From a state s, IW looks for a closest state s' such that the pair (s, s') satisfies a rule,
or for a goal state; then s := s', until the goal. A subproblem that fails is sampled anew,
more densely; there is no backtracking across subproblems.

Lazy-SIIW_R is the same loop around an IW that validates actions lazily.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from runtime.search.guide import Guide, Subgoal, Values
from runtime.search.iw import iw
from runtime.search.lazy_iw import LazyIW
from runtime.search.limits import Limits, OutOfTimeError
from runtime.search.problem import Action, Motion, SearchProblem, State
from runtime.search.query import Effort, Query
from sketchlang.compile import CompiledSketch


@dataclass
class Outcome:
    """What a search reached. Where it did not solve the problem, `reason` says why it ended,
    `stuck` are the feature values there, and `rejected` counts the candidates of the last
    subproblem that died at each step of X."""

    solved: bool = False
    subgoals: list[Subgoal] = field(default_factory=list)
    effort: Effort = field(default_factory=Effort)
    state: State = None
    reason: str | None = None
    stuck: Values | None = None
    rejected: dict[str, int] = field(default_factory=dict)


Profile = dict[str, dict[str, float]]

Progress = Callable[[Subgoal, float], None]


Step = tuple[Action, Motion, State]
"""An action, its motion and the state after it."""

Search = Callable[[Query], "tuple[list[Step], str] | None"]
"""Looks for a subgoal of a state: the steps to it and the rule that it satisfies."""


def eager(query: Query) -> tuple[list[Step], str] | None:
    """The search of SIW_R: every edge is validated before the search goes on."""
    found = iw(query)
    if found is None:
        return None
    node, rule = found
    return [(n.action, n.motion, n.state) for n in node.path()], rule


def lazy(query: Query) -> tuple[list[Step], str] | None:
    """The search of Lazy-SIIW_R: only the actions of potential subplans are validated."""
    found = LazyIW(query).run()
    if found is None:
        return None
    path, rule = found
    return [(edge.action, edge.motion, edge.child.state) for edge in path], rule


def serialize(
    search: Search,
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    progress: Progress | None = None,
) -> Outcome:
    """Solve a problem subgoal by subgoal. All randomness comes from `rng`."""
    guide = Guide(sketch, problem)
    outcome = Outcome(state=problem.initial)
    profile = problem.profile_dict()
    try:
        while True:
            profile = problem.profile_dict()
            values = guide.values(outcome.state)
            if guide.is_goal(values):
                outcome.solved = True
                return outcome
            subgoal = find_subgoal(
                search, guide, problem, outcome.state, limits, rng, outcome.effort
            )
            if subgoal is None:
                outcome.stuck = values
                outcome.reason = _why(guide, values)
                outcome.rejected = _rejected(profile, problem.profile_dict())
                return outcome
            outcome.subgoals.append(subgoal)
            outcome.state = subgoal.states[-1]
            guide.forget()
            if progress is not None:
                progress(subgoal, limits.elapsed())
    except OutOfTimeError:
        outcome.stuck = guide.values(outcome.state)
        outcome.rejected = _rejected(profile, problem.profile_dict())
        outcome.reason = f"the time limit of {limits.timeout:g} s is over"
        return outcome


def schedule(limits: Limits) -> Iterator[tuple[int, int]]:
    """(attempt, k) in the order in which a subproblem is tried: IW(1) on samples of growing
    density first, then the wider searches, which grow faster, on samples of middling density."""
    for attempt in range(limits.attempts):
        yield attempt, 1
    for k in range(2, limits.k_max + 1):
        yield limits.attempts // 2, k


def find_subgoal(
    search: Search,
    guide: Guide,
    problem: SearchProblem,
    state: State,
    limits: Limits,
    rng: np.random.Generator,
    effort: Effort,
) -> Subgoal | None:
    """One round: a subplan from a state to a subgoal, or None. Nodes are added to `effort`.

    Raises:
        OutOfTimeError: when the limits say so.
    """
    values = guide.values(state)
    before = problem.profile_dict()
    for attempt, k in schedule(limits):
        limits.check()
        subproblem = problem.subproblem(state, attempt, rng)
        query = Query(guide, subproblem, state, values, k, limits)
        try:
            found = search(query)
        finally:
            effort.expanded += query.effort.expanded
            effort.generated += query.effort.generated
        if found is not None:
            steps, rule = found
            return Subgoal(
                rule=rule,
                before=values,
                after=guide.values(steps[-1][2]),
                actions=tuple(action for action, _, _ in steps),
                motions=tuple(motion for _, motion, _ in steps),
                states=tuple(state for _, _, state in steps),
                attempt=attempt,
                width=k,
                expanded=query.effort.expanded,
                generated=query.effort.generated,
                rejected=_rejected(before, problem.profile_dict()),
            )
    return None


def _rejected(before: Profile, after: Profile) -> dict[str, int]:
    """Candidates rejected at each step of X between two profiles."""
    rejected = {}
    for name, step in after.items():
        asked = step["calls"] - before[name]["calls"]
        rejected[name] = int(asked - (step["successes"] - before[name]["successes"]))
    return rejected


def _why(guide: Guide, values: Values) -> str:
    rules = guide.applicable(values)
    if not rules:
        return "no rule of the sketch applies here, and no goal state was found"
    return f"no subgoal of {' or '.join(rules)} was found"


siw_r = partial(serialize, eager)
lazy_siiw_r = partial(serialize, lazy)
