"""What a search needs to know of a problem.

The tuple T = (S, s0, G, Act, A, X, N) of the paper, behind a few methods: `subproblem` is the
sampling function A at the start of a subproblem, `Subproblem.actions` lists ground actions
with the states they lead to (N) if they are executable, and `Subproblem.execute` is X.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import Any, Protocol

import numpy as np

State = Any
Action = Any
Motion = Any


class Subproblem(Protocol):
    """The ground actions sampled for one subproblem."""

    def actions(self, state: State) -> Iterable[tuple[Action, State]]:
        """Sampled actions of a state and where they lead, executable or not."""
        ...

    def execute(self, state: State, action: Action) -> Motion | None:
        """The motion that carries out an action, or None if it is not executable."""
        ...


class SearchProblem(Protocol):
    """A problem that can be sampled."""

    @property
    def initial(self) -> State: ...

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Subproblem:
        """Samples for the subproblem that starts in a state; denser with each attempt."""
        ...

    def feature_key(self, state: State) -> Hashable:
        """States with the same key have the same feature values."""
        ...


class ClassicalSubproblem:
    """All applicable actions; each is executable."""

    def __init__(self, successors: Any) -> None:
        self._successors = successors

    def actions(self, state: State) -> Iterable[tuple[Action, State]]:
        found: Iterable[tuple[Action, State]] = self._successors(state)
        return found

    def execute(self, state: State, action: Action) -> Motion | None:
        return ()


class ClassicalProblem:
    """A domain's `Problem` (initial state and successors) as the search sees it."""

    def __init__(self, problem: Any) -> None:
        self._problem = problem

    @property
    def initial(self) -> State:
        return self._problem.initial

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Subproblem:
        return ClassicalSubproblem(self._problem.successors)

    def feature_key(self, state: State) -> Hashable:
        key: Hashable = state
        return key
