"""What a search needs to know of a problem: four methods.

The tuple T = (S, s0, G, Act, A, X, N) of the paper: `initial` is s0, `subproblem` the sampling
function A at the start of a subproblem, `Subproblem.actions` lists ground actions with the
states they lead to (N) if they are executable, and `Subproblem.execute` is X.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

State = Any
Action = Any
Motion = Any


@dataclass(frozen=True)
class Rejection:
    """X's answer to an action that is not executable: the step of X that refused it, and what it
    was about."""

    step: str
    about: str | None = None


class Subproblem(Protocol):
    """The ground actions sampled for one subproblem."""

    def actions(self, state: State) -> Iterable[tuple[Action, State]]:
        """Sampled actions of a state and where they lead, executable or not."""
        ...

    def execute(self, state: State, action: Action) -> Motion | Rejection:
        """The motion that carries out an action, or why it is not executable."""
        ...


class SearchProblem(Protocol):
    """A problem that can be sampled."""

    @property
    def initial(self) -> State: ...

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Subproblem:
        """Samples for the subproblem that starts in a state; denser with each attempt."""
        ...


@dataclass(frozen=True)
class StartedAt:
    """A problem from another state on."""

    problem: SearchProblem
    initial: State

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Subproblem:
        """Samples of the problem itself."""
        return self.problem.subproblem(state, attempt, rng)
