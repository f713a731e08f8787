"""A PDDL domain as sketches see it: types are sorts and sets, predicates are relations.

Names keep their spelling in lower case, with `_` for what a name in a sketch cannot have:
`robot-at` is `robot_at`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from domains.pddl.features.compiler import Meaning
from domains.pddl.features.evaluator import Evaluator
from domains.pddl.features.rows import bits_of
from domains.pddl.features.sources import source
from domains.pddl.ground.task import GroundTask, ground
from domains.pddl.show import action_lines, task_picture
from domains.pddl.state import State
from domains.pddl.syntax.lists import PddlError
from domains.pddl.syntax.model import OBJECT, Parameter, PddlDomain
from domains.pddl.syntax.read import load, read_domain, read_task
from sketchlang.diagnostics import Label
from sketchlang.domain import Domain, Function
from sketchlang.errors import InputError
from sketchlang.source import Span
from sketchlang.syntax.grammar import words
from sketchlang.types import BOOL, NAT, Type

if TYPE_CHECKING:
    from domains.pddl.problem import PddlProblem

OPEN_GOALS = "open_goals"
"""The function that every PDDL domain has, unless a name of its own takes its place."""


class Thing(NamedTuple):
    """An object of a task, by its number in the grounded task."""

    number: int
    name: str

    def __str__(self) -> str:
        return self.name


@dataclass
class PddlInterface(Domain):
    """The domain that a PDDL file declares. `meanings` tells what its functions are in PDDL,
    `types` maps names of sorts to those of types."""

    pddl: PddlDomain | None = None
    meanings: dict[Function, Meaning] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)


def sketch_name(name: str) -> str:
    """How a name of PDDL is written in sketches."""
    found = re.sub(r"[^a-z0-9_]", "_", name)
    if found[:1].isdigit() or not found:
        found = f"_{found}"
    return f"{found}_" if found in words() else found


def interface_of(path: str) -> PddlInterface:
    """What sketches can use of a domain file.

    Raises:
        PddlError: what is wrong with it, and where.
    """
    return make_interface(read_domain(load(path)))


def make_interface(pddl: PddlDomain) -> PddlInterface:
    """What sketches for a PDDL domain can use.

    Raises:
        PddlError: two of its names would be the same in a sketch.
    """
    return _Maker(pddl).make()


class _Maker:
    def __init__(self, pddl: PddlDomain) -> None:
        self.pddl = pddl
        self.domain = PddlInterface(sketch_name(pddl.name), summary=f"PDDL domain {pddl.name}")
        self.predicates: set[str] = set()
        self.taken: dict[str, str] = {}

    def make(self) -> PddlInterface:
        """The domain."""
        self._sorts()
        for name, parameters in self.pddl.predicates.items():
            self._predicate(name, parameters)
        for name in self.domain.sorts:
            if name not in self.predicates:
                self._type(name)
        for constant in self.pddl.constants:
            self._constant(constant)
        domain = self.domain
        if OPEN_GOALS not in domain.functions:
            function = Function(OPEN_GOALS, _open_goals, (), NAT)
            domain.add(function)
            domain.meanings[function] = Meaning("goals", "")
        domain.pddl = self.pddl
        domain.members = lambda state, sort: members(domain, state, domain.types[sort])
        domain.default_atoms = _facts
        domain.goal_test = lambda state: state.task.is_goal(state.bits)
        domain.evaluator = lambda checked: Evaluator(checked, domain.meanings, domain.types)
        domain.load = lambda path, _options: load_problem(domain, path)
        domain.draw = lambda path, _name: task_picture(path, self.pddl)
        domain.schemas = action_lines(self.pddl)
        return domain

    def _claim(self, name: str, original: str, span: Span | None) -> None:
        """Two different names of PDDL must not be one name in a sketch."""
        other = self.taken.setdefault(name, original)
        if other != original:
            raise PddlError(
                f"`{original}` and `{other}` would both be `{name}` in a sketch",
                self.pddl.source,
                span or Span(0, 0),
            )

    def _sorts(self) -> None:
        """A class for every type, below those of the types above it."""
        self.domain.types |= {sketch_name(name): name for name in (OBJECT, *self.pddl.types)}
        made: dict[str, type] = {OBJECT: type(sketch_name(OBJECT), (Thing,), {"__slots__": ()})}
        waiting = [name for name in self.pddl.types if name != OBJECT]
        while waiting:
            ready = [
                name
                for name in waiting
                if all(parent in made or parent == name for parent in self.pddl.types[name])
            ]
            # Types that are below each other in a circle are all the same: objects.
            for name in ready or waiting:
                parents = [made[p] for p in self.pddl.types[name] if p in made and p != name]
                bases = _lowest(parents) or (made[OBJECT],)
                made[name] = type(sketch_name(name), bases, {"__slots__": ()})
            waiting = [name for name in waiting if name not in made]
        for name, cls in made.items():
            self._claim(f"sort {sketch_name(name)}", name, self.pddl.places.get(f"type {name}"))
            self.domain.sorts[sketch_name(name)] = cls

    def _sort(self, parameter: Parameter) -> Type:
        """The sort of a parameter; objects where there are alternatives."""
        types = parameter.types
        return Type(sketch_name(types[0] if len(types) == 1 else OBJECT))

    def _label(self, span: Span | None) -> Label | None:
        return Label(self.pddl.source, span, "declared here") if span is not None else None

    def _predicate(self, name: str, parameters: tuple[Parameter, ...]) -> None:
        written = sketch_name(name)
        span = self.pddl.places.get(name)
        self._claim(written, name, span)
        self.predicates.add(written)
        sorts = tuple(map(self._sort, parameters))
        label = self._label(span)
        for goal in (False, True):
            holds, extension = _predicate(self.domain, name, goal)
            listed = extension if sorts else None
            function = Function(written, holds, sorts, BOOL, extension=listed, declared=label)
            self.domain.add(function, goal)
            self.domain.meanings[function] = Meaning("predicate", name, goal)
        self.domain.atoms[written] = _family(name)

    def _type(self, written: str) -> None:
        domain = self.domain
        name = domain.types[written]
        self._claim(written, name, self.pddl.places.get(f"type {name}"))

        def call(state: State) -> Collection[Thing]:
            return members(domain, state, name)

        label = self._label(self.pddl.places.get(f"type {name}"))
        function = Function(written, call, (), Type(written, True), declared=label)
        domain.add(function)
        domain.meanings[function] = Meaning("type", name)

    def _constant(self, constant: Parameter) -> None:
        written, name = sketch_name(constant.name), constant.name
        self._claim(written, name, constant.span)
        if written in self.domain.functions:
            return
        sort, domain = self._sort(constant), self.domain

        def call(state: State) -> Thing:
            return things(domain, state.task)[state.task.number(name)]

        function = Function(written, call, (), sort, declared=self._label(constant.span))
        domain.add(function)
        domain.meanings[function] = Meaning("constant", name)


def _lowest(classes: list[type]) -> tuple[type, ...]:
    """The classes that no other one of them is below."""
    kept = [
        cls
        for cls in classes
        if not any(other is not cls and issubclass(other, cls) for other in classes)
    ]
    return tuple(dict.fromkeys(kept))


# What the functions of such a domain compute.


def things(domain: PddlInterface, task: GroundTask) -> tuple[Thing, ...]:
    """The objects of a task, each of the class of its type."""
    found: tuple[Thing, ...] | None = task.memory.get(id(domain))
    if found is None:
        types = {thing.name: thing.types for thing in task.pddl.objects}
        made = []
        for number, name in enumerate(task.objects):
            bases = _lowest([domain.sorts[sketch_name(type_)] for type_ in types[name]])
            cls = bases[0] if len(bases) == 1 else type("object", bases, {"__slots__": ()})
            made.append(cls(number, name))
        found = task.memory[id(domain)] = tuple(made)
    return found


def members(domain: PddlInterface, state: State, name: str) -> tuple[Thing, ...]:
    """All objects of a type."""
    known = things(domain, state.task)
    return tuple(known[number] for number in bits_of(state.task.types[name]))


def _predicate(
    domain: PddlInterface, name: str, goal: bool
) -> tuple[Callable[..., bool], Callable[[State], frozenset[tuple[Thing, ...]]]]:
    """A predicate of states, or of the goal: whether it holds, and of what."""

    def tuples(state: State) -> Iterable[tuple[int, ...]]:
        task = state.task
        return source(task, name, goal).tuples(state.bits)

    def holds(state: State, *arguments: Thing) -> bool:
        values = tuple([argument.number for argument in arguments])
        return source(state.task, name, goal).holds(state.bits, values)

    def extension(state: State) -> frozenset[tuple[Thing, ...]]:
        known = things(domain, state.task)
        return frozenset(tuple([known[value] for value in values]) for values in tuples(state))

    return holds, extension


def _family(name: str) -> Callable[[Any], Iterable[Hashable]]:
    """The atoms of a predicate, as their bits."""

    def atoms(state: State) -> Iterator[Hashable]:
        box = state.task.layout.boxes.get(name)
        return iter(()) if box is None else bits_of(state.bits & box.mask)

    return atoms


def _open_goals(state: State) -> int:
    """How many parts of the task's goal do not hold; where there are cases, of the nearest."""
    return state.task.open_goals(state.bits)


def _facts(state: State) -> Iterator[Hashable]:
    """All atoms that change, as their bits."""
    return bits_of(state.bits)


def domain_beside(task: str | Path) -> Path:
    """The domain file of a task: `domain.pddl` in its folder, or one that bears the task's name.

    Raises:
        InputError: there is none.
    """
    path = Path(task)
    stem = path.stem
    if not path.exists():
        raise InputError("no such file", place=str(task))
    names = ("domain.pddl", f"{stem}-domain.pddl", f"domain-{stem}.pddl", f"domain_{stem}.pddl")
    for name in names:
        if path.with_name(name).is_file():
            return path.with_name(name)
    raise InputError(
        "there is no `domain.pddl` beside the task",
        place=str(task),
        hint="name the domain's file with --domain-pddl FILE",
    )


def load_problem(domain: PddlInterface, path: str) -> PddlProblem:
    """The problem of a task file.

    Raises:
        PddlError: what is wrong with it, and where.
        InputError: the task is too large.
    """
    from domains.pddl.problem import PddlProblem

    assert domain.pddl is not None
    return PddlProblem(ground(read_task(load(path), domain.pddl)))
