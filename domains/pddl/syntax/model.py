"""PDDL domains and tasks as data. All names are in lower case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from sketchlang.source import Source, Span

OBJECT = "object"
"""The type above all others."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A variable (with its `?`), object or constant with its types: several are alternatives
    (`either`)."""

    name: str
    types: tuple[str, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Atom:
    """A predicate or function with its terms: variables begin with `?`."""

    name: str
    terms: tuple[str, ...]
    span: Span

    def __str__(self) -> str:
        return f"({' '.join((self.name, *self.terms))})"


@dataclass(frozen=True, slots=True)
class Equal:
    """`(= a b)`"""

    left: str
    right: str


@dataclass(frozen=True, slots=True)
class Not:
    """`(not F)`"""

    part: Formula


@dataclass(frozen=True, slots=True)
class And:
    """`(and F ...)`; without parts it is true."""

    parts: tuple[Formula, ...] = ()


@dataclass(frozen=True, slots=True)
class Or:
    """`(or F ...)`; without parts it is false. `(imply F G)` is read as `(or (not F) G)`."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Quantified:
    """`(forall (PARAMETERS) F)` or `(exists (PARAMETERS) F)`"""

    every: bool
    parameters: tuple[Parameter, ...]
    part: Formula


Formula = Atom | Equal | Not | And | Or | Quantified
TRUE = And()


@dataclass(frozen=True, slots=True)
class Effect:
    """One literal that an action makes true or false: for all values of `parameters` for which
    `condition` holds before the action."""

    positive: bool
    atom: Atom
    parameters: tuple[Parameter, ...] = ()
    condition: Formula = TRUE


@dataclass(frozen=True, slots=True)
class Action:
    """An action schema. `costs` are what it adds to the total cost: whole numbers, and
    functions whose values the task gives."""

    name: str
    parameters: tuple[Parameter, ...]
    precondition: Formula
    effects: tuple[Effect, ...]
    costs: tuple[int | Atom, ...]
    span: Span


@dataclass(frozen=True)
class PddlDomain:
    """A domain file. `types` maps a type to those directly above it; `predicates` and
    `functions` map names to the types of their arguments."""

    source: Source
    name: str
    types: Mapping[str, tuple[str, ...]]
    constants: tuple[Parameter, ...]
    predicates: Mapping[str, tuple[Parameter, ...]]
    functions: Mapping[str, tuple[Parameter, ...]]
    actions: tuple[Action, ...]
    places: Mapping[str, Span] = field(default_factory=dict)

    def above(self, name: str) -> frozenset[str]:
        """A type and all those above it."""
        found = self._above.get(name)
        return found if found is not None else frozenset((name, OBJECT))

    @cached_property
    def _above(self) -> dict[str, frozenset[str]]:
        return {name: self._lineage(name) for name in (*self.types, OBJECT)}

    def _lineage(self, name: str) -> frozenset[str]:
        found: set[str] = set()
        todo = [name]
        while todo:
            type_ = todo.pop()
            if type_ not in found:
                found.add(type_)
                todo.extend(self.types.get(type_, ()))
        return frozenset(found | {OBJECT})

    def changing(self) -> frozenset[str]:
        """The predicates that some action changes; the others are static."""
        return frozenset(effect.atom.name for a in self.actions for effect in a.effects)


@dataclass(frozen=True)
class PddlTask:
    """A task file with its domain. `objects` includes the domain's constants."""

    source: Source
    domain: PddlDomain
    name: str
    objects: tuple[Parameter, ...]
    init: frozenset[tuple[str, ...]]
    values: Mapping[tuple[str, ...], int]
    goal: Formula
    minimises_cost: bool

    def members(self, types: tuple[str, ...]) -> Iterator[str]:
        """The objects of any of some types, in the order of the file."""
        wanted = set(types)
        for thing in self.objects:
            if any(not wanted.isdisjoint(self.domain.above(type_)) for type_ in thing.types):
                yield thing.name


def substitute(formula: Formula, values: Mapping[str, str]) -> Formula:
    """A formula with variables replaced."""
    match formula:
        case Atom(name, terms, span):
            return Atom(name, tuple(values.get(term, term) for term in terms), span)
        case Equal(left, right):
            return Equal(values.get(left, left), values.get(right, right))
        case Not(part):
            return Not(substitute(part, values))
        case And(parts):
            return And(tuple(substitute(part, values) for part in parts))
        case Or(parts):
            return Or(tuple(substitute(part, values) for part in parts))
        case Quantified(every, parameters, part):
            hidden = {parameter.name for parameter in parameters}
            inner = {name: value for name, value in values.items() if name not in hidden}
            return Quantified(every, parameters, substitute(part, inner))
