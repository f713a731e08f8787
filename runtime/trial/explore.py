"""The states of a scene: all of them where there are few, else near ones and random walks."""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from runtime.search.guide import Guide, Values
from runtime.search.limits import Limits, OutOfTimeError
from runtime.search.problem import Action, Rejection, SearchProblem, State, Subproblem

WALK = 200
"""Steps of a random walk."""

NEAR = 0.5
"""The part of the states that are taken from near the start before walks go further."""

RISING = 8
"""A feature that reaches one part in so many of the steps of a climb is taken to be unbounded."""


class Sample(NamedTuple):
    """How a subproblem was sampled: with these two it can be sampled again."""

    seed: int
    attempt: int = 0

    @classmethod
    def drawn(cls, rng: np.random.Generator, attempt: int = 0) -> Sample:
        """One more."""
        return cls(int(rng.integers(1 << 32)), attempt)

    def of(self, problem: SearchProblem, state: State) -> Subproblem:
        """The subproblem."""
        return problem.subproblem(state, self.attempt, np.random.default_rng(self.seed))


@dataclass(eq=False)
class Seen:
    """A state, its feature values, and how it was reached: `sample` is that of the subproblem which
    the action is from, None where that is the one of the action before."""

    state: State
    values: Values
    parent: Seen | None = None
    action: Action = None
    sample: Sample | None = None

    def actions(self) -> list[str]:
        """The actions from the scene's initial state to this one, as texts."""
        return [str(action) for action in self.path()]

    def path(self) -> list[Action]:
        """The actions from the scene's initial state to this one."""
        return [seen.action for seen in self._steps()]

    def states(self) -> list[State]:
        """The states after each of them, which is this one after the last."""
        return [seen.state for seen in self._steps()] or [self.state]

    def samples(self) -> list[Sample | None]:
        """What each of them is sampled from."""
        return [seen.sample for seen in self._steps()]

    def _steps(self) -> list[Seen]:
        found: list[Seen] = []
        seen: Seen | None = self
        while seen is not None and seen.parent is not None:
            found.append(seen)
            seen = seen.parent
        return found[::-1]


@dataclass(frozen=True)
class Explored:
    """States of a scene in the order in which they were found; all there are, if `complete`.
    `cut`: the time was over before as many were found as were wanted."""

    states: list[Seen] = field(default_factory=list)
    complete: bool = True
    cut: bool = False


def successors(subproblem: Subproblem, state: State) -> Iterator[tuple[Action, State]]:
    """The executable actions of a state, as far as they were sampled."""
    for action, after in subproblem.actions(state):
        if not isinstance(subproblem.execute(state, action), Rejection):
            yield action, after


def explore(
    problem: SearchProblem, guide: Guide, most: int, limits: Limits, rng: np.random.Generator
) -> Explored:
    """Up to `most` states, breadth first, and behind that by random walks; as many as are found
    in the time of the limits, of which half goes to the walks where it gets short.

    Raises:
        EvaluationError: a function of the domain breaks its promise.
    """
    root = Seen(problem.initial, guide.values(problem.initial))
    known = {problem.initial: root}
    early = limits if limits.timeout is None else replace(limits, timeout=limits.timeout * NEAR)
    try:
        if _flood(problem, guide, known, most, early, rng):
            return Explored(list(known.values()))
        known = {s.state: s for s in list(known.values())[: max(1, int(most * NEAR))]}
    except OutOfTimeError:
        pass
    try:
        _walk(problem, guide, known, most, limits, rng)
    except OutOfTimeError:
        return Explored(list(known.values()), complete=False, cut=True)
    return Explored(list(known.values()), complete=False)


def _flood(
    problem: SearchProblem,
    guide: Guide,
    known: dict[State, Seen],
    most: int,
    limits: Limits,
    rng: np.random.Generator,
) -> bool:
    """Adds states breadth first, until there are more than `most`; whether these are all."""
    queue = deque(known.values())
    while queue:
        seen = queue.popleft()
        sample = Sample.drawn(rng)
        for action, after in successors(sample.of(problem, seen.state), seen.state):
            limits.check()
            if after not in known:
                known[after] = Seen(after, guide.values(after), seen, action, sample)
                queue.append(known[after])
        if len(known) > most:
            return False
    return True


def _walk(
    problem: SearchProblem,
    guide: Guide,
    known: dict[State, Seen],
    most: int,
    limits: Limits,
    rng: np.random.Generator,
) -> None:
    """Adds the states of random walks from states that are known."""
    steps = 0
    while len(known) < most and steps < most * 4:
        starts = list(known.values())
        seen = starts[int(rng.integers(len(starts)))]
        for _ in range(WALK):
            steps += 1
            limits.check()
            sample = Sample.drawn(rng)
            choices = list(successors(sample.of(problem, seen.state), seen.state))
            if not choices or len(known) >= most:
                break
            action, after = choices[int(rng.integers(len(choices)))]
            if after not in known:
                known[after] = Seen(after, guide.values(after), seen, action, sample)
            seen = known[after]


def climb(
    problem: SearchProblem,
    guide: Guide,
    feature: int,
    steps: int,
    limits: Limits,
    rng: np.random.Generator,
) -> Seen | None:
    """A state from which a feature seems to rise without end, by going uphill for some steps.

    None if it levels off: then nothing speaks against a bound.
    """
    root = Seen(problem.initial, guide.values(problem.initial))
    known = {problem.initial}
    queue: list[tuple[int, int, Seen]] = [(-root.values[feature], 0, root)]
    highest, when, taken = root, 0, 0
    while queue and taken < steps:
        _, _, seen = heapq.heappop(queue)
        taken += 1
        if seen.values[feature] > highest.values[feature]:
            highest, when = seen, taken
        sample = Sample.drawn(rng)
        for action, after in successors(sample.of(problem, seen.state), seen.state):
            limits.check()
            if after not in known:
                known.add(after)
                child = Seen(after, guide.values(after), seen, action, sample)
                heapq.heappush(queue, (-child.values[feature], -len(known), child))
    risen = highest.values[feature] - root.values[feature]
    still = when > 0.9 * taken
    return highest if queue and still and risen * RISING >= taken >= steps else None
