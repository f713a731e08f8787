"""A sketch as a guide: feature values of states, and which rule a subgoal satisfies."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from operator import attrgetter

from runtime.search.problem import Action, Motion, State
from sketchlang.compile import CompiledSketch
from sketchlang.model import Effect

Values = tuple[int, ...]
GOAL = "goal"
"""Stands for the name of a rule where a subgoal is a goal state that no rule leads to."""


@dataclass(frozen=True)
class Subgoal:
    """One subplan: the rule that fired, feature values before and after, what was done.

    `rejected` counts the candidates that died at each step of X on the way; `values` are those
    of the features after each action.
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
    values: tuple[Values, ...] = ()


DOUBTED = 8
"""So many values that were remembered for a state that differs, in what the domain's functions
declare to ignore, are computed anew and compared."""


class Guide:
    """Evaluates states, each set of equal feature values once.

    Values are remembered by the whole state, but for what all functions of the sketch's
    features declare to ignore.
    """

    def __init__(self, sketch: CompiledSketch) -> None:
        self.sketch = sketch
        self.model = sketch.model
        self._values: dict[Hashable, tuple[Values, State]] = {}
        self._key = _looked_at(sketch.ignores)
        self._doubts = DOUBTED if sketch.ignores else 0
        self.others = 0
        """So many states of this subproblem were looked at and not remembered: they differ from
        one that is remembered only in features that may be anything."""
        self.hopeful = False
        """Whether some state of this subproblem was a subgoal, whatever X said of it."""

    def values(self, state: State) -> Values:
        """Feature values of a state."""
        key = self._key(state)
        found = self._values.get(key)
        if found is None:
            values = self.sketch.evaluate(state)
            self._values[key] = values, state
            return values
        values, known = found
        if self._doubts and known != state:
            self._doubts -= 1
            self.sketch.confirm(state, values)
        return values

    def seen(self) -> dict[Values, State]:
        """Feature values of the states of this subproblem so far, with a state for each."""
        return dict(reversed(self._values.values()))

    @property
    def known(self) -> int:
        """How many states are remembered, those apart that features cannot tell apart."""
        return len(self._values) + self.others

    def forget(self) -> None:
        """Drop remembered values: states of a finished subproblem do not come back."""
        self._values.clear()
        self.others = 0
        self.hopeful = False

    def atoms(self, state: State) -> tuple[Hashable, ...]:
        """The novelty atoms F_H that are true in a state, told apart by their family."""
        found: list[Hashable] = []
        for family, function in enumerate(self.sketch.atoms):
            found += [(family, atom) for atom in function(state)]
        return tuple(found)

    def is_goal(self, values: Values, state: State) -> bool:
        """Whether a state with these feature values is a goal state: by the domain's own test
        where it has one, else by the sketch's goal."""
        if self.sketch.goal_test is not None:
            return self.sketch.goal_test(state)
        return self.model.is_goal(values)

    def reaches_goal(self, state: State) -> bool:
        """Whether a state is a goal state, its features computed only if that depends on them."""
        if self.sketch.goal_test is not None:
            return self.sketch.goal_test(state)
        return self.model.is_goal(self.values(state))

    def fired(self, before: Values, after: Values, state: State) -> str | None:
        """The rule that a pair of states satisfies, the second of which is `state`; `GOAL` for a
        goal state, else None."""
        name = self.rule(before, after)
        if name is not None:
            return name
        if not self.is_goal(after, state):
            return None
        self.hopeful = True
        return GOAL

    def rule(self, before: Values, after: Values) -> str | None:
        """The rule that a pair of feature values satisfies."""
        for rule in self.model.rules:
            if rule.satisfied_by(before, after):
                self.hopeful = True
                return rule.name
        return None

    def usable(self, values: Values) -> list[int]:
        """The rules whose conditions hold and whose effects can happen: a nat that is 0 does not
        fall."""
        return [
            number
            for number, rule in enumerate(self.model.rules)
            if rule.applies(values)
            and all(values[f] for f, effect in rule.effects.items() if effect is Effect.DEC)
        ]


def _looked_at(ignores: frozenset[str]) -> Callable[[State], Hashable]:
    """What of a state the features of a sketch can depend on."""
    if not ignores:
        return lambda state: state
    getters: dict[type, Callable[[State], Hashable]] = {}

    def key(state: State) -> Hashable:
        getter = getters.get(type(state))
        if getter is None:
            getter = getters[type(state)] = _getter(type(state), ignores)
        return getter(state)

    return key


def _getter(kind: type, ignores: frozenset[str]) -> Callable[[State], Hashable]:
    if not is_dataclass(kind):
        return lambda state: state
    kept = [f.name for f in fields(kind) if f.compare and f.name not in ignores]
    return attrgetter(*kept) if kept else lambda _: ()
