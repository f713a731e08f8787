"""What a search needs to know of a problem.

The tuple T = (S, s0, G, Act, A, X, N) of the paper, behind a few methods: `subproblem` is the
sampling function A at the start of a subproblem, `Subproblem.actions` lists ground actions
with the states they lead to (N) if they are executable, and `Subproblem.execute` is X.
"""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from runtime.errors import InputError
from runtime.files import write_text

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
    """A problem that can be sampled, and what reports want to know of it."""

    @property
    def initial(self) -> State: ...

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> Subproblem:
        """Samples for the subproblem that starts in a state; denser with each attempt."""
        ...

    def feature_key(self, state: State) -> Hashable:
        """States with the same key have the same feature values."""
        ...

    def warm_up(self) -> None:
        """Do what must not count as planning time: compile kernels, load libraries."""
        ...

    def describe(self, subgoal: Any) -> str:
        """The actions of a subplan in a few words."""
        ...

    def profile_dict(self) -> dict[str, dict[str, float]]:
        """Calls, successes and time of each step of X; empty where there are none."""
        ...

    def robot_name(self) -> str | None:
        """The robot, or None where there is none."""
        ...

    def execution_time(self, outcome: Any) -> float:
        """Seconds that the motions of an outcome take."""
        ...

    def write_plan(self, model: Any, outcome: Any, planner: str, seed: int, path: Path) -> None:
        """Write the plan of a solved outcome."""
        ...

    def obstacles(self, state: State) -> list[str]:
        """For a state in which the search is stuck: what is in the way of what."""
        ...

    def certify(self, model: Any, outcome: Any, planner: str, seed: int) -> Any:
        """Judge a solved outcome independently: has `valid` and `findings`."""
        ...


class ClassicalSubproblem:
    """All applicable actions; each is executable."""

    def __init__(self, successors: Any) -> None:
        self._successors = successors

    def actions(self, state: State) -> Iterable[tuple[Action, State]]:
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

    def warm_up(self) -> None:
        """Nothing to do."""

    def describe(self, subgoal: Any) -> str:
        return ", ".join(str(action) for action in subgoal.actions)

    def profile_dict(self) -> dict[str, dict[str, float]]:
        return {}

    def robot_name(self) -> str | None:
        return None

    def execution_time(self, outcome: Any) -> float:
        return 0.0

    def write_plan(self, model: Any, outcome: Any, planner: str, seed: int, path: Path) -> None:
        actions = [str(action) for subgoal in outcome.subgoals for action in subgoal.actions]
        subgoals = [{"rule": s.rule, "actions": len(s.actions)} for s in outcome.subgoals]
        data = {
            "format": "sketchlang-actions",
            "version": 1,
            "sketch": model.name,
            "planner": planner,
            "seed": seed,
            "subgoals": subgoals,
            "actions": actions,
        }
        write_text(path, json.dumps(data, indent=1) + "\n")

    def obstacles(self, state: State) -> list[str]:
        return []

    def certify(self, model: Any, outcome: Any, planner: str, seed: int) -> Certified:
        state = self.initial
        for subgoal in outcome.subgoals:
            for action, after in zip(subgoal.actions, subgoal.states, strict=True):
                if (action, after) not in list(self._problem.successors(state)):
                    return Certified((f"{action} is not applicable where it is taken",))
                state = after
        return Certified(())


@dataclass(frozen=True)
class Certified:
    """What a replay of a classical plan found wrong."""

    findings: tuple[str, ...]

    @property
    def valid(self) -> bool:
        """Whether nothing was found."""
        return not self.findings


def searchable(problem: Any) -> SearchProblem:
    """What a domain's scene loader made, as a problem that can be searched.

    Raises:
        InputError: it is neither a problem of this package nor one with successors.
    """
    if hasattr(problem, "subproblem"):
        found: SearchProblem = problem
        return found
    if not (hasattr(problem, "initial") and hasattr(problem, "successors")):
        raise InputError(
            f"the domain's scene loader returned {type(problem).__name__}",
            hint="it has to return a problem with `initial` and `successors(state)`",
        )
    return ClassicalProblem(problem)
