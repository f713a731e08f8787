"""Replays a plan by PDDL's own semantics, on the text of domain and task as it was read.

Nothing here is shared with grounding or search: states are sets of atoms, conditions are evaluated
as they are written, quantifiers go through objects.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

from domains.pddl.plan import Step
from domains.pddl.syntax.model import (
    Action,
    And,
    Atom,
    Equal,
    Formula,
    Not,
    Or,
    Parameter,
    PddlTask,
    Quantified,
)

Fact = tuple[str, ...]
State = frozenset[Fact]
Binding = Mapping[str, str]


@dataclass(frozen=True)
class Finding:
    """What is wrong with a plan: at which action (from 0), or None for all of it."""

    action: int | None
    message: str


@dataclass(frozen=True)
class Verdict:
    """What a replay found, and what the plan costs."""

    findings: tuple[Finding, ...]
    cost: int

    @property
    def valid(self) -> bool:
        """Whether nothing was found."""
        return not self.findings


def replay(task: PddlTask, steps: list[Step]) -> Verdict:
    """Take the steps one after the other, and look whether the goal holds in the end."""
    state: State = task.init
    cost = 0
    actions = {action.name: action for action in task.domain.actions}
    objects = {thing.name for thing in task.objects}
    for number, step in enumerate(steps):
        action = actions.get(step.name)
        reason = None
        if action is None:
            reason = f"there is no action `{step.name}`"
        elif len(step.arguments) != len(action.parameters):
            wanted, given = len(action.parameters), len(step.arguments)
            reason = f"`{step.name}` takes {wanted} arguments, {given} given"
        elif not objects.issuperset(step.arguments):
            reason = f"there is no object `{min(set(step.arguments) - objects)}`"
        if reason is not None or action is None:
            return Verdict((Finding(number, reason or ""),), cost)
        names = [parameter.name for parameter in action.parameters]
        binding = dict(zip(names, step.arguments, strict=True))
        reason = _wrong_type(task, action, binding) or _broken(
            task, state, action.precondition, binding
        )
        if reason is not None:
            return Verdict((Finding(number, reason),), cost)
        cost += _cost(task, action, binding)
        state = after(task, state, action, binding)
    unmet = _broken(task, state, task.goal, {})
    if unmet is not None:
        return Verdict((Finding(None, f"the goal is not reached: {unmet}"),), cost)
    return Verdict((), cost)


def after(task: PddlTask, state: State, action: Action, binding: Binding) -> State:
    """The state after an action that applies."""
    added: set[Fact] = set()
    deleted: set[Fact] = set()
    for effect in action.effects:
        for more in bindings(task, effect.parameters):
            values = {**binding, **more}
            if holds(task, state, effect.condition, values):
                (added if effect.positive else deleted).add(fact(effect.atom, values))
    return state - deleted | added


def holds(task: PddlTask, state: State, formula: Formula, binding: Binding) -> bool:
    """Whether a condition holds in a state."""
    match formula:
        case Atom():
            return fact(formula, binding) in state
        case Equal(left, right):
            return binding.get(left, left) == binding.get(right, right)
        case Not(part):
            return not holds(task, state, part, binding)
        case And(parts):
            return all(holds(task, state, part, binding) for part in parts)
        case Or(parts):
            return any(holds(task, state, part, binding) for part in parts)
        case Quantified(every, parameters, part):
            truths = (
                holds(task, state, part, {**binding, **more}) for more in bindings(task, parameters)
            )
            return all(truths) if every else any(truths)


def bindings(task: PddlTask, parameters: tuple[Parameter, ...]) -> Iterator[dict[str, str]]:
    """All values of some parameters."""
    names = [parameter.name for parameter in parameters]
    for values in product(*(tuple(task.members(p.types)) for p in parameters)):
        yield dict(zip(names, values, strict=True))


def fact(atom: Atom, binding: Binding) -> Fact:
    """An atom with its variables replaced."""
    return (atom.name, *(binding.get(term, term) for term in atom.terms))


def _broken(task: PddlTask, state: State, formula: Formula, binding: Binding) -> str | None:
    """The first part of a condition that does not hold, in words; None where all does."""
    parts = formula.parts if isinstance(formula, And) else (formula,)
    for part in parts:
        if isinstance(part, And):
            inner = _broken(task, state, part, binding)
            if inner is not None:
                return inner
        elif not holds(task, state, part, binding):
            return _in_words(part, binding)
    return None


def _in_words(formula: Formula, binding: Binding) -> str:
    match formula:
        case Atom():
            return f"({' '.join(fact(formula, binding))}) is false"
        case Not(Atom() as atom):
            return f"({' '.join(fact(atom, binding))}) is true"
        case Equal(left, right):
            return f"`{binding.get(left, left)}` is not `{binding.get(right, right)}`"
        case Not(Equal(left, _)):
            return f"`{binding.get(left, left)}` is the same"
    return "a part of the condition does not hold"


def _wrong_type(task: PddlTask, action: Action, binding: Binding) -> str | None:
    for parameter in action.parameters:
        value = binding[parameter.name]
        if value not in set(task.members(parameter.types)):
            return f"`{value}` is no {' or '.join(parameter.types)}"
    return None


def _cost(task: PddlTask, action: Action, binding: Binding) -> int:
    """What an action costs: 1 where the domain has no costs."""
    if not any(other.costs for other in task.domain.actions):
        return 1
    return sum(
        cost if isinstance(cost, int) else task.values.get(fact(cost, binding), 0)
        for cost in action.costs
    )
