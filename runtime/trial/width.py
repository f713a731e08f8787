"""The width of the subproblem that starts in a state, and whether it can be solved at all."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from runtime.search.classical import ClassicalProblem
from runtime.search.guide import Guide, Values
from runtime.search.iw import iw
from runtime.search.limits import Limits
from runtime.search.problem import Action, SearchProblem, State
from runtime.search.query import Query
from runtime.trial.explore import successors


@dataclass(frozen=True)
class Width:
    """`width` is the least k for which IW(k) finds a subgoal: one action for 0; None if no k
    tried does. `rule` is the one that the subgoal satisfies, `path` leads there. `reachable`
    tells, where no subgoal was found, whether there is any; None if that was too much to find
    out."""

    width: int | None
    rule: str | None
    path: tuple[tuple[Action, State], ...]
    reachable: bool | None


def width_of(
    problem: SearchProblem,
    guide: Guide,
    state: State,
    values: Values,
    k_max: int,
    most: int,
    limits: Limits,
    rng: np.random.Generator,
) -> Width:
    """The width of the subproblem of a state, looking for k up to `k_max` and among up to `most`
    states for any subgoal.

    Raises:
        OutOfTimeError: when the limits say so.
    """
    for action, after in successors(problem, state, rng):
        limits.check()
        rule = guide.fired(values, guide.values(after), after)
        if rule is not None:
            return Width(0, rule, ((action, after),), True)
    attempts = 1 if isinstance(problem, ClassicalProblem) else limits.attempts
    for k in range(1, k_max + 1):
        for attempt in range(attempts):
            subproblem = problem.subproblem(state, attempt, rng)
            found = iw(Query(guide, subproblem, state, values, k, limits))
            if found is not None:
                node, rule = found
                path = tuple((step.action, step.state) for step in node.path())
                return Width(k, rule, path, True)
    reachable = _any_subgoal(problem, guide, state, values, most, limits, rng)
    return Width(None, None, (), reachable)


def _any_subgoal(
    problem: SearchProblem,
    guide: Guide,
    state: State,
    values: Values,
    most: int,
    limits: Limits,
    rng: np.random.Generator,
) -> bool | None:
    known = {state}
    queue = deque([state])
    while queue:
        for _, after in successors(problem, queue.popleft(), rng):
            limits.check()
            if after in known:
                continue
            if guide.fired(values, guide.values(after), after) is not None:
                return True
            known.add(after)
            queue.append(after)
        if len(known) > most:
            return None
    # What was sampled is no proof that there is nothing else.
    return False if isinstance(problem, ClassicalProblem) else None
