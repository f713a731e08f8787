"""A PDDL task as a problem to search."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from domains.pddl.ground.task import GroundTask, Operator
from domains.pddl.reporting import PddlReporting
from domains.pddl.search import PddlSubproblem
from domains.pddl.state import State
from domains.pddl.successors import Successors
from runtime.reporting import Reporting

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True, eq=False)
class PddlProblem:
    """Reach the goal of a PDDL task."""

    task: GroundTask

    @cached_property
    def generator(self) -> Successors:
        """The operators that apply in a state."""
        return Successors(self.task)

    @property
    def initial(self) -> State:
        """Where the task starts."""
        return State(self.task.initial, self.task)

    @property
    def reporting(self) -> Reporting:
        """The task as people and files see it."""
        return PddlReporting(self.task, self.generator)

    def subproblem(self, state: State, attempt: int, rng: np.random.Generator) -> PddlSubproblem:
        """All operators, however often it is asked."""
        return PddlSubproblem(self.task, self.generator, attempt)

    def counters(self, state: State) -> tuple[int, ...]:
        """#g, the parts of the goal that do not hold, for best-first searches."""
        return (self.task.open_goals(state.bits),)

    def successors(self, state: State) -> list[tuple[Operator, State]]:
        """The operators that apply, and where they lead."""
        return PddlSubproblem(self.task, self.generator, 0).actions(state)
