"""A task walked subgoal by subgoal, each searched for when it is asked for.

The subgoals are those of `Task.solve` with the same seed, until the run gets stuck: where that goes
back and draws anew, a walk ends. What was found is remembered, so one can go back in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from runtime.collector import spared
from runtime.reasons.explain import SAID
from runtime.search.guide import Subgoal, Values
from runtime.search.limits import Limits
from runtime.search.planners import DEFAULT, SEARCHES
from runtime.search.siw_r import End, Outcome, subgoals
from runtime.solve import Task
from sketchlang.errors import InputError

Finding = dict[str, Any]


class Walk:
    """The way of a planner through a task, as far as it was asked for.

    `limits.timeout` is for each subgoal: a walk may be interrupted by people who think.
    """

    def __init__(self, task: Task, limits: Limits | None = None, planner: str = DEFAULT) -> None:
        if planner not in SEARCHES:
            known = ", ".join(SEARCHES)
            raise InputError(f"there is no planner {planner!r}", hint=f"planners: {known}")
        self.task = task
        self.limits = limits or Limits()
        self.outcome = Outcome(state=task.problem.initial)
        self.ended = False
        self._found: Iterator[Subgoal] = subgoals(
            SEARCHES[planner],
            task.sketch,
            task.problem,
            self.limits,
            np.random.default_rng(task.seed),
            self.outcome,
        )
        self._begun = False

    @property
    def known(self) -> int:
        """How many subgoals have been found."""
        return len(self.outcome.subgoals)

    def reach(self, number: int) -> int:
        """Search until so many subgoals are known, or the walk has ended; how many there are then,
        at most `number`.

        Raises:
            EvaluationError: a function of the domain, or an invariant, breaks its promise.
        """
        while self.known < number and not self.ended:
            self._go_on()
        return min(number, self.known)

    def _go_on(self) -> None:
        if not self._begun:
            self._begun = True
            self.task.reporting.warm_up()
            hopeless = self.task.reporting.hopeless()
            if hopeless:
                self.outcome.end = End.HOPELESS
                self.outcome.reason = "; ".join(finding["text"] for finding in hopeless[:SAID])
                self.outcome.why = hopeless
                self.ended = True
                return
        self.limits.restart()
        with spared():
            found = next(self._found, None)
        if found is None:
            self.ended = True
            if not self.outcome.solved:
                self.task.explain(self.outcome, self.limits)

    def subgoal(self, number: int) -> Subgoal:
        """The subgoal of a number, from 1; it has to be known."""
        return self.outcome.subgoals[number - 1]

    def state(self, number: int) -> Any:
        """The state after so many subgoals; they have to be known."""
        return self.subgoal(number).states[-1] if number else self.task.problem.initial

    def values(self, number: int) -> Values:
        """The feature values after so many subgoals."""
        return self.subgoal(number).after if number else self.task.sketch.evaluate(self.state(0))
