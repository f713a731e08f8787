"""Grounding: which instances of actions and effects can ever apply, if nothing is deleted.

Clingo's grounder answers a logic program that derives facts from facts: an action applies if
its positive preconditions have been derived, and derives what it adds.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING

from domains.pddl.ground.conjunctions import Conjunction, TooLargeError, conjunctions
from domains.pddl.syntax.lists import PddlError
from domains.pddl.syntax.model import TRUE, Action, Atom, Effect, Formula, Parameter, PddlTask
from sketchlang.errors import InputError

if TYPE_CHECKING:
    import clingo

MAX_DERIVED = 2_000_000
"""So many facts may be derived: atoms, actions and effects."""

Values = tuple[int, ...]
"""Objects, by their number in the task."""


@dataclass(frozen=True)
class Case:
    """An action under one conjunction of its precondition, or an effect of it under one of its
    condition. `variables` are those of the action and then those of the effect; `values` has an
    entry for each instance."""

    name: str
    conjunction: Conjunction
    variables: tuple[Parameter, ...]
    values: list[Values] = field(default_factory=list)


@dataclass(frozen=True)
class Reached:
    """What can apply. `effects[i]` belong to `actions[i]`: those without a condition have no
    case. `atoms` are the facts that can become or are true, of predicates that change."""

    actions: list[tuple[Action, Case]]
    effects: list[list[tuple[Effect, Case | None]]]
    atoms: dict[str, list[Values]]


def reach(task: PddlTask) -> Reached:
    """All that can apply from the start.

    Raises:
        PddlError: a condition is too large, with its place.
        InputError: the task is too large.
    """
    program = _Program(task)
    for action in task.domain.actions:
        program.action(action)
    return program.run()


class _Program:
    def __init__(self, task: PddlTask) -> None:
        self.task = task
        self.changing = task.domain.changing()
        self.number = {thing.name: i for i, thing in enumerate(task.objects)}
        self.predicates = {name: i for i, name in enumerate(task.domain.predicates)}
        self.types: dict[tuple[str, ...], int] = {}
        self.lines: list[str] = []
        self.actions: list[tuple[Action, Case]] = []
        self.effects: list[list[tuple[Effect, Case | None]]] = []
        self.cases: list[Case] = []
        self.names = count()

    def action(self, action: Action) -> None:
        """Add an action."""
        for conjunction in self._split(action, action.precondition):
            case = self._case(action.parameters, conjunction, [])
            effects: list[tuple[Effect, Case | None]] = []
            head = self._atom(case.name, [p.name for p in case.variables])
            for effect in action.effects:
                if not effect.parameters and effect.condition == TRUE:
                    effects.append((effect, None))
                    self._adds(effect, head)
                    continue
                for condition in self._split(action, effect.condition):
                    inner = self._case((*case.variables, *effect.parameters), condition, [head])
                    effects.append((effect, inner))
                    self._adds(effect, self._atom(inner.name, [p.name for p in inner.variables]))
            self.actions.append((action, case))
            self.effects.append(effects)

    def _split(self, action: Action, condition: Formula) -> list[Conjunction]:
        try:
            return conjunctions(condition, self.task, self.names)
        except TooLargeError as error:
            raise PddlError(
                f"a condition of action `{action.name}` is too large: {error}",
                self.task.domain.source,
                action.span,
            ) from None

    def _case(
        self, parameters: tuple[Parameter, ...], conjunction: Conjunction, body: list[str]
    ) -> Case:
        variables = (*parameters, *conjunction.parameters)
        case = Case(f"c{next(self.names)}", conjunction, variables)
        body = body + [f"{self._type(p.types)}({self._term(p.name)})" for p in variables]
        body += [self._fact(atom) for atom in conjunction.true]
        # What never changes can be asked for in the negative as well.
        body += [
            f"not {self._fact(atom)}"
            for atom in conjunction.false
            if atom.name not in self.changing
        ]
        for left, right, same in conjunction.equal:
            sign = "=" if same else "!="
            body.append(f"{self._term(left)} {sign} {self._term(right)}")
        head = self._atom(case.name, [p.name for p in variables])
        self.lines.append(f"{head} :- {', '.join(body)}." if body else f"{head}.")
        self.cases.append(case)
        return case

    def _adds(self, effect: Effect, body: str) -> None:
        if effect.positive:
            self.lines.append(f"{self._fact(effect.atom)} :- {body}.")

    def _term(self, name: str) -> str:
        if name.startswith("?"):
            # Letters that a variable of clingo cannot have become their code.
            return "V" + "".join(c if c.isascii() and c.isalnum() else f"_{ord(c)}_" for c in name)
        return str(self.number[name])

    def _atom(self, name: str, terms: list[str]) -> str:
        return f"{name}({','.join(map(self._term, terms))})" if terms else name

    def _fact(self, atom: Atom) -> str:
        return self._atom(f"p{self.predicates[atom.name]}", list(atom.terms))

    def _type(self, types: tuple[str, ...]) -> str:
        return f"t{self.types.setdefault(types, len(self.types))}"

    def _facts(self) -> Iterator[str]:
        for types, number in self.types.items():
            for name in self.task.members(types):
                yield f"t{number}({self.number[name]})."
        for name, *terms in sorted(self.task.init):
            yield self._atom(f"p{self.predicates[name]}", terms) + "."

    def run(self) -> Reached:
        """Ground the program and gather what was derived."""
        control = _ground("\n".join([*self._facts(), *self.lines]))
        for case in self.cases:
            case.values.extend(_instances(control, case.name, len(case.variables)))
        atoms = {}
        for name, number in self.predicates.items():
            if name in self.changing:
                arity = len(self.task.domain.predicates[name])
                atoms[name] = list(_instances(control, f"p{number}", arity))
        return Reached(self.actions, self.effects, atoms)


def _ground(program: str) -> clingo.Control:
    import clingo

    class Counter(clingo.Observer):
        """Ends the grounding of a task that would fill the memory."""

        derived = 0

        def rule(self, choice: bool, head: object, body: object) -> None:
            self.derived += 1
            if self.derived > MAX_DERIVED:
                raise OverflowError

    control = clingo.Control(["--warn=none"])
    counter = Counter()
    control.register_observer(counter)
    control.add("base", [], program)
    try:
        control.ground([("base", [])])
    except (OverflowError, MemoryError, RuntimeError):
        if counter.derived <= MAX_DERIVED:
            raise
        raise InputError(
            f"the task is too large: more than {MAX_DERIVED} facts and actions are reachable"
        ) from None
    return control


def _instances(control: clingo.Control, name: str, arity: int) -> Iterator[Values]:
    found = [
        tuple([argument.number for argument in atom.symbol.arguments])
        for atom in control.symbolic_atoms.by_signature(name, arity)
    ]
    # The order of the derivation is the grounder's own affair: plans must not depend on it.
    return iter(sorted(found))
