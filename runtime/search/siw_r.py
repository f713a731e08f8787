"""SIW_R: one IW search a subgoal, guided by a sketch (Bonet & Geffner 2021; paper, SIW_R).

From a state s, IW looks for a closest state s' such that the pair (s, s') satisfies a rule,
or for a goal state; then s := s', until the goal. A subproblem that fails is sampled anew,
more densely; there is no backtracking across subproblems.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from runtime.search.guide import Guide, Subgoal, Values
from runtime.search.iw import Effort, iw
from runtime.search.limits import Limits, OutOfTimeError
from runtime.search.problem import SearchProblem, State
from sketchlang.compile import CompiledSketch


@dataclass
class Outcome:
    """What a search reached. `reason` says why it ended where it did not solve the problem;
    `stuck` are the feature values there."""

    solved: bool = False
    subgoals: list[Subgoal] = field(default_factory=list)
    effort: Effort = field(default_factory=Effort)
    state: State = None
    reason: str | None = None
    stuck: Values | None = None


Progress = Callable[[Subgoal, float], None]


def siw_r(
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    progress: Progress | None = None,
) -> Outcome:
    """Search a problem with a sketch. All randomness comes from `rng`."""
    guide = Guide(sketch, problem)
    outcome = Outcome(state=problem.initial)
    try:
        while True:
            values = guide.values(outcome.state)
            if guide.is_goal(values):
                outcome.solved = True
                return outcome
            subgoal = _subgoal(guide, problem, outcome, values, limits, rng)
            if subgoal is None:
                outcome.stuck = values
                outcome.reason = _why(guide, values)
                return outcome
            outcome.subgoals.append(subgoal)
            outcome.state = subgoal.states[-1]
            guide.forget()
            if progress is not None:
                progress(subgoal, limits.elapsed())
    except OutOfTimeError:
        outcome.stuck = guide.values(outcome.state)
        outcome.reason = f"the time limit of {limits.timeout:g} s is over"
        return outcome


def schedule(limits: Limits) -> Iterator[tuple[int, int]]:
    """(attempt, k) in the order in which a subproblem is tried: IW(1) on samples of growing
    density first, then the wider searches."""
    for k in range(1, limits.k_max + 1):
        for attempt in range(limits.attempts if k == 1 else 1):
            yield attempt, k


def _subgoal(
    guide: Guide,
    problem: SearchProblem,
    outcome: Outcome,
    values: Values,
    limits: Limits,
    rng: np.random.Generator,
) -> Subgoal | None:
    for attempt, k in schedule(limits):
        limits.check()
        subproblem = problem.subproblem(outcome.state, attempt, rng)
        effort = Effort()
        try:
            found = iw(guide, subproblem, outcome.state, values, k, limits, effort)
        finally:
            outcome.effort.expanded += effort.expanded
            outcome.effort.generated += effort.generated
        if found is not None:
            node, rule = found
            path = node.path()
            return Subgoal(
                rule=rule,
                before=values,
                after=guide.values(node.state),
                actions=tuple(n.action for n in path),
                motions=tuple(n.motion for n in path),
                states=tuple(n.state for n in path),
                attempt=attempt,
                width=k,
                expanded=effort.expanded,
                generated=effort.generated,
            )
    return None


def _why(guide: Guide, values: Values) -> str:
    rules = guide.applicable(values)
    if not rules:
        return "no rule of the sketch applies here, and no goal state was found"
    return f"no subgoal of {' or '.join(rules)} was found"
