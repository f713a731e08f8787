"""A grounded task: states are whole numbers, operators are masks on them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from domains.pddl.features.rows import bits_of, mask_of
from domains.pddl.ground.conjunctions import Conjunction, TooLargeError, conjunctions
from domains.pddl.ground.layout import Layout, make_layout, object_order
from domains.pddl.ground.reach import Case, Reached, Values, reach
from domains.pddl.syntax.lists import PddlError
from domains.pddl.syntax.model import OBJECT, Action, Atom, Effect, PddlTask
from sketchlang.source import Span

Places = tuple[int, ...]
"""Bits by their places, in order: of large tasks, masks would fill the memory."""


def places_of(bits: Iterable[int]) -> Places:
    """Bits in order, each once."""
    return tuple(sorted(set(bits)))


@dataclass(frozen=True, slots=True)
class Condition:
    """Bits that have to be 1 and bits that have to be 0."""

    ones: Places = ()
    zeros: Places = ()

    @property
    def true(self) -> int:
        """The mask of what has to be 1."""
        return mask_of(self.ones)

    @property
    def false(self) -> int:
        """The mask of what has to be 0."""
        return mask_of(self.zeros)

    def holds(self, bits: int) -> bool:
        """Whether a state satisfies it."""
        true = self.true
        return bits & true == true and not bits & self.false


@dataclass(frozen=True, slots=True)
class Change:
    """Bits that become 1 and bits that become 0; what is in both becomes 1."""

    added: Places = ()
    deleted: Places = ()


@dataclass(frozen=True, slots=True)
class Operator:
    """A ground action. `conditional` are changes that happen where a condition holds before."""

    name: str
    condition: Condition
    change: Change
    conditional: tuple[tuple[Condition, Change], ...]
    cost: int

    def __str__(self) -> str:
        return self.name

    def apply(self, bits: int) -> int:
        """The state after it."""
        adds, deletes = mask_of(self.change.added), mask_of(self.change.deleted)
        for condition, change in self.conditional:
            if condition.holds(bits):
                adds |= mask_of(change.added)
                deletes |= mask_of(change.deleted)
        return bits & ~deletes | adds


@dataclass(frozen=True, eq=False)
class GroundTask:
    """What does not change in a task. Objects are numbered by their place in `objects`; sets of
    objects are bits. `static` has the atoms of predicates that no action changes, `goal` the
    cases of the goal that can hold, `goal_atoms` the atoms that all of its cases ask for. If there
    is no such case, `unreachable` are the parts of the goal, in words, that keep the case back
    which has fewest. `memory` is for what others work out once from a task."""

    pddl: PddlTask
    objects: tuple[str, ...]
    types: Mapping[str, int]
    layout: Layout
    static: Mapping[str, frozenset[Values]]
    initial: int
    goal: tuple[Condition, ...]
    goal_atoms: Mapping[str, frozenset[Values]]
    operators: tuple[Operator, ...]
    unreachable: tuple[str, ...] = ()
    memory: dict[object, Any] = field(default_factory=dict, repr=False)

    def number(self, name: str) -> int:
        """The number of an object."""
        return self.objects.index(name)

    @cached_property
    def goal_masks(self) -> tuple[tuple[int, int], ...]:
        """For each case of the goal: what has to be 1, and what has to be 0."""
        return tuple([(case.true, case.false) for case in self.goal])

    def open_goals(self, bits: int) -> int:
        """How many parts of the goal do not hold, in the case of which fewest do not."""
        return min(
            (
                (true & ~bits).bit_count() + (false & bits).bit_count()
                for true, false in self.goal_masks
            ),
            default=1,
        )

    def open_parts(self, bits: int) -> list[str]:
        """The parts of the goal that do not hold, in the case of which fewest do not."""
        lacking = [(true & ~bits, false & bits) for true, false in self.goal_masks]
        true, false = min(lacking, key=lambda pair: pair[0].bit_count() + pair[1].bit_count())
        return [f"{self.atom(bit)} is false" for bit in bits_of(true)] + [
            f"{self.atom(bit)} is true" for bit in bits_of(false)
        ]

    def atom(self, bit: int) -> str:
        """The atom of a bit, as PDDL writes it."""
        (box,) = [box for box in self.layout.boxes.values() if box.mask >> bit & 1]
        return f"({' '.join((box.predicate, *(self.objects[v] for v in box.values(bit))))})"

    @cached_property
    def goal_mask(self) -> int:
        """The bits that the goal looks at."""
        found = 0
        for true, false in self.goal_masks:
            found |= true | false
        return found

    def is_goal(self, bits: int) -> bool:
        """Whether a state satisfies the goal."""
        return any(bits & true == true and not bits & false for true, false in self.goal_masks)


def ground(task: PddlTask) -> GroundTask:
    """The grounded task.

    Raises:
        PddlError: a condition is too large, with its place.
        InputError: the task is too large.
    """
    return _Grounder(task, reach(task)).task()


Lists = tuple[list[int], list[int]]


class _Grounder:
    def __init__(self, pddl: PddlTask, reached: Reached) -> None:
        self.pddl = pddl
        self.reached = reached
        order = object_order(pddl, reached.atoms)
        self.objects = tuple(pddl.objects[number].name for number in order)
        self.number = {name: i for i, name in enumerate(self.objects)}
        self.renumbered = [0] * len(order)
        for new, old in enumerate(order):
            self.renumbered[old] = new
        self.layout = make_layout(
            {
                name: [tuple([self.renumbered[value] for value in values]) for values in found]
                for name, found in reached.atoms.items()
            }
        )
        self.changing = pddl.domain.changing()
        self.place = {thing.name: number for number, thing in enumerate(pddl.objects)}
        self.derived = {name: frozenset(found) for name, found in reached.atoms.items()}

    def task(self) -> GroundTask:
        """All of it."""
        static: dict[str, set[Values]] = {
            name: set() for name in self.pddl.domain.predicates if name not in self.changing
        }
        initial = 0
        for name, *terms in self.pddl.init:
            values = tuple(self.number[term] for term in terms)
            if name in static:
                static[name].add(values)
            else:
                bit = self.layout.bit(name, values)
                assert bit is not None, "what is true at the start has been derived"
                initial |= 1 << bit
        types = {
            type_: sum(1 << self.number[name] for name in self.pddl.members((type_,)))
            for type_ in {OBJECT, *self.pddl.domain.types}
        }
        goal, goal_atoms, unreachable = self._goal()
        return GroundTask(
            self.pddl,
            self.objects,
            types,
            self.layout,
            {name: frozenset(found) for name, found in static.items()},
            initial,
            goal,
            goal_atoms,
            tuple(dict.fromkeys(self._operators())),
            unreachable,
        )

    # The goal.

    def _goal(
        self,
    ) -> tuple[tuple[Condition, ...], dict[str, frozenset[Values]], tuple[str, ...]]:
        try:
            cases = conjunctions(self.pddl.goal, self.pddl)
        except TooLargeError as error:
            raise PddlError(
                f"the goal is too large: {error}", self.pddl.source, _goal_place(self.pddl)
            ) from None
        conditions = []
        common: set[tuple[str, Values]] | None = None
        missing: list[list[str]] = []
        for case in cases:
            missing.append(self._out_of_reach(case))
            if any((left == right) != same for left, right, same in case.equal):
                continue
            named = {(atom.name, self._values(atom, {})) for atom in case.true}
            common = named if common is None else common & named
            if not missing[-1]:
                condition = self._condition(case.true, case.false, {}, static=True)
                assert condition is not None, "all of its atoms can become true"
                conditions.append(condition)
        atoms: dict[str, set[Values]] = {}
        for name, values in common or ():
            atoms.setdefault(name, set()).add(values)
        unreachable = () if conditions or not missing else tuple(sorted(missing, key=len)[0])
        return (
            tuple(conditions),
            {name: frozenset(found) for name, found in atoms.items()},
            unreachable,
        )

    def _out_of_reach(self, case: Conjunction) -> list[str]:
        """The parts of a case of the goal that can never hold, in words."""
        init = self.pddl.init
        found = []
        for atom in case.true:
            fact = (atom.name, *atom.terms)
            values = tuple(self.place[term] for term in atom.terms)
            if atom.name in self.changing:
                if values not in self.derived[atom.name]:
                    found.append(f"({' '.join(fact)}) can never become true")
            elif fact not in init:
                found.append(f"({' '.join(fact)}) is false, and no action makes it true")
        for atom in case.false:
            fact = (atom.name, *atom.terms)
            if atom.name not in self.changing and fact in init:
                found.append(f"({' '.join(fact)}) is true, and no action makes it false")
        for left, right, same in case.equal:
            if (left == right) != same:
                found.append(f"`{left}` is {'not' if same else 'the same as'} `{right}`")
        both = {(a.name, *a.terms) for a in case.true} & {(a.name, *a.terms) for a in case.false}
        return found + [f"({' '.join(fact)}) would have to be true and false" for fact in both]

    # Operators.

    def _operators(self) -> list[Operator]:
        found: list[Operator] = []
        for (action, case), effects in zip(self.reached.actions, self.reached.effects, strict=True):
            instances = [self._instances(case, inner) for _, inner in effects]
            for values in case.values:
                operator = self._operator(action, case, values, effects, instances)
                if operator is not None:
                    found.append(operator)
        return found

    def _instances(self, case: Case, inner: Case | None) -> dict[Values, list[Values]]:
        """The instances of an effect by the instance of the action that they belong to."""
        found: dict[Values, list[Values]] = {}
        if inner is not None:
            width = len(case.variables)
            for values in inner.values:
                found.setdefault(values[:width], []).append(values)
        return found

    def _operator(
        self,
        action: Action,
        case: Case,
        values: Values,
        effects: list[tuple[Effect, Case | None]],
        instances: list[dict[Values, list[Values]]],
    ) -> Operator | None:
        variables = self._variables(case, values)
        conjunction = case.conjunction
        condition = self._condition(conjunction.true, conjunction.false, variables)
        if condition is None or not set(condition.ones).isdisjoint(condition.zeros):
            return None
        always: Lists = [], []
        when: dict[Condition, Lists] = {}
        for (effect, inner), found in zip(effects, instances, strict=True):
            if inner is None:
                self._change(effect, variables, always)
                continue
            for own in found.get(values, ()):
                bound = self._variables(inner, own)
                asked = self._condition(inner.conjunction.true, inner.conjunction.false, bound)
                if asked is None or not set(asked.ones).isdisjoint(asked.zeros + condition.zeros):
                    continue
                # What the action asks for itself need not be asked for again, nor whether an atom
                # is true before it is deleted.
                true = set(asked.ones).difference(condition.ones)
                if not effect.positive:
                    true.discard(self._bit(effect, bound))
                false = set(asked.zeros).difference(condition.zeros)
                asked = Condition(places_of(true), places_of(false))
                target = always if asked == Condition() else when.setdefault(asked, ([], []))
                self._change(effect, bound, target)
        terms = [self.objects[variables[p.name]] for p in action.parameters]
        return Operator(
            f"({' '.join((action.name, *terms))})",
            condition,
            _changed(always),
            tuple((asked, _changed(change)) for asked, change in when.items() if any(change)),
            sum(self._cost(cost, variables) for cost in action.costs),
        )

    def _variables(self, case: Case, values: Values) -> dict[str, int]:
        return {
            parameter.name: self.renumbered[value]
            for parameter, value in zip(case.variables, values, strict=True)
        }

    def _values(self, atom: Atom, variables: Mapping[str, int]) -> Values:
        return tuple([variables[t] if t in variables else self.number[t] for t in atom.terms])

    def _condition(
        self,
        true: tuple[Atom, ...],
        false: tuple[Atom, ...],
        variables: Mapping[str, int],
        static: bool = False,
    ) -> Condition | None:
        """The bits of some atoms; None if they cannot hold. What never changes has been looked
        at by the grounder, unless `static`."""
        places: Lists = [], []
        for side, atoms in enumerate((true, false)):
            for atom in atoms:
                if atom.name in self.changing:
                    bit = self.layout.bit(atom.name, self._values(atom, variables))
                    if bit is not None:
                        places[side].append(bit)
                    elif side == 0:
                        return None
                elif static and ((atom.name, *atom.terms) in self.pddl.init) == (side == 1):
                    return None
        return Condition(places_of(places[0]), places_of(places[1]))

    def _bit(self, effect: Effect, variables: Mapping[str, int]) -> int | None:
        """The bit that an effect changes; None if it can never be true anyway."""
        return self.layout.bit(effect.atom.name, self._values(effect.atom, variables))

    def _change(self, effect: Effect, variables: Mapping[str, int], found: Lists) -> None:
        bit = self._bit(effect, variables)
        if bit is not None:
            found[0 if effect.positive else 1].append(bit)

    def _cost(self, cost: int | Atom, variables: Mapping[str, int]) -> int:
        if isinstance(cost, int):
            return cost
        terms = [self.objects[value] for value in self._values(cost, variables)]
        key = (cost.name, *terms)
        if key not in self.pddl.values:
            raise PddlError(
                f"the task gives no value for `({' '.join(key)})`, which an action costs",
                self.pddl.domain.source,
                cost.span,
            )
        return self.pddl.values[key]


def _changed(found: Lists) -> Change:
    return Change(places_of(found[0]), places_of(found[1]))


def _goal_place(task: PddlTask) -> Span:
    start = max(0, task.source.text.lower().find("(:goal"))
    return Span(start, start + 6)
