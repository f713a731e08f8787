"""A classical problem (an initial state and successors) as the search sees it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from runtime.search.problem import Action, Motion, State, Subproblem
from sketchlang.errors import InputError


class ClassicalSubproblem:
    """All applicable actions; each is executable."""

    def __init__(self, successors: Any) -> None:
        self._successors = successors

    def actions(self, state: State) -> Iterable[tuple[Action, State]]:
        """The domain's successors of a state."""
        try:
            found = list(self._successors(state))
            for pair in found:
                _, _ = pair
        except Exception as error:
            raise InputError(
                f"the domain's `successors` fails: {type(error).__name__}: {error}",
                place=f"state {state!r}"[:200],
                hint="it has to yield pairs of an action and the state after it",
            ) from error
        return found

    def execute(self, state: State, action: Action) -> Motion:
        """Nothing moves."""
        return ()


class ClassicalProblem:
    """A domain's `Problem` (initial state and successors)."""

    def __init__(self, problem: Any) -> None:
        self.problem = problem

    @property
    def initial(self) -> State:
        """Where the task starts."""
        return self.problem.initial

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Subproblem:
        """All actions, however often it is asked."""
        return ClassicalSubproblem(self.problem.successors)
