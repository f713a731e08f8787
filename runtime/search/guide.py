"""A sketch as a guide: feature values of states, and which rule a subgoal satisfies."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass

from runtime.search.problem import Action, Motion, SearchProblem, State
from sketchlang.compile import CompiledSketch

Values = tuple[int, ...]
GOAL = "goal"
"""Stands for the name of a rule where a subgoal is a goal state that no rule leads to."""


@dataclass(frozen=True)
class Subgoal:
    """One subplan: the rule that fired, feature values before and after, what was done.

    `rejected` counts the candidates that died at each step of X on the way.
    """

    rule: str
    before: Values
    after: Values
    actions: tuple[Action, ...]
    motions: tuple[Motion, ...]
    states: tuple[State, ...]
    attempt: int
    width: int
    expanded: int
    generated: int
    rejected: Mapping[str, int]


class Guide:
    """Evaluates states, each set of equal feature values once."""

    def __init__(self, sketch: CompiledSketch, problem: SearchProblem) -> None:
        self.sketch = sketch
        self.model = sketch.model
        self._key: Callable[[State], Hashable] = problem.feature_key
        self._values: dict[Hashable, Values] = {}

    def values(self, state: State) -> Values:
        """Feature values of a state."""
        key = self._key(state)
        found = self._values.get(key)
        if found is None:
            found = self._values[key] = self.sketch.evaluate(state)
        return found

    def forget(self) -> None:
        """Drop remembered values: states of a finished subproblem do not come back."""
        self._values.clear()

    def atoms(self, state: State) -> tuple[Hashable, ...]:
        """The novelty atoms F_H that are true in a state, told apart by their family."""
        found: list[Hashable] = []
        for family, function in enumerate(self.sketch.atoms):
            found += [(family, atom) for atom in function(state)]
        return tuple(found)

    def is_goal(self, values: Values) -> bool:
        """Whether feature values satisfy the sketch's goal."""
        return self.model.is_goal(values)

    def fired(self, before: Values, after: Values) -> str | None:
        """The rule that a pair of states satisfies, `GOAL` for a goal state, else None."""
        for rule in self.model.rules:
            if rule.satisfied_by(before, after):
                return rule.name
        return GOAL if self.model.is_goal(after) else None

    def applicable(self, values: Values) -> list[str]:
        """Names of the rules whose conditions hold."""
        return [rule.name for rule in self.model.rules if rule.applies(values)]
