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
from runtime.trial.explore import Sample, successors


@dataclass(frozen=True)
class Width:
    """`width` is the least k for which IW(k) finds a subgoal: one action for 0; None if no k
    tried does. `rule` is the one that the subgoal satisfies, `path` leads there, through the
    subproblem of `sample`. `reachable` tells, where no subgoal was found, whether there is any;
    None if that was too much to find out."""

    width: int | None
    rule: str | None
    path: tuple[tuple[Action, State], ...]
    reachable: bool | None
    sample: Sample | None = None


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
    sample = Sample.drawn(rng)
    for action, after in successors(sample.of(problem, state), state):
        limits.check()
        rule = guide.fired(values, guide.values(after), after)
        if rule is not None:
            return Width(0, rule, ((action, after),), True, sample)
    attempts = 1 if isinstance(problem, ClassicalProblem) else limits.attempts
    for k in range(1, k_max + 1):
        for attempt in range(attempts):
            sample = Sample.drawn(rng, attempt)
            found = iw(Query(guide, sample.of(problem, state), state, values, k, limits))
            if found is not None:
                node, rule = found
                path = tuple((step.action, step.state) for step in node.path())
                return Width(k, rule, path, True, sample)
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
        here = queue.popleft()
        for _, after in successors(Sample.drawn(rng).of(problem, here), here):
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
