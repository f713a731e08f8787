"""How a domain declares sorts, functions, novelty atoms and scenes.

    domain = Domain("hanoi", summary="Towers of Hanoi")

    @domain.sort
    class Disk: ...

    @domain.function
    def disks(state: State) -> frozenset[Disk]: ...

    @domain.function
    def above(state: State, disk: Disk) -> Nat: ...

The signatures that a sketch is checked against are the annotations. The first parameter is
the state, whatever the domain uses as one, and its annotation is not looked at.
"""

from __future__ import annotations

import functools
import inspect
import linecache
import os
import re
import typing
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

from sketchlang.annotations import Nat, of_object, of_text
from sketchlang.diagnostics import Label
from sketchlang.source import Source, Span
from sketchlang.syntax.grammar import words
from sketchlang.types import BOOL, Type

__all__ = ["Domain", "DomainError", "Function", "LoadOptions", "Nat", "Problem", "SceneError"]

StateT = TypeVar("StateT")
ActionT_co = TypeVar("ActionT_co", covariant=True)
F = TypeVar("F", bound=Callable[..., Any])
C = TypeVar("C", bound=type)


class Problem(Protocol[StateT, ActionT_co]):
    """One task to solve: where it starts and where every state leads."""

    @property
    def initial(self) -> StateT: ...

    def successors(self, state: StateT) -> Iterable[tuple[ActionT_co, StateT]]:
        """The applicable actions and the states they lead to, in a fixed order."""
        ...


@dataclass(frozen=True)
class LoadOptions:
    """What a scene loader is told besides the path: the scene's name for people, the seed of
    the run, the robot's name or file (None: the default one), the domain's own actions, and
    whether motions that could overlap are to follow each other `in_turn`."""

    name: str = ""
    seed: int = 0
    robot: str | None = None
    actions: Mapping[str, Any] = field(default_factory=dict)
    in_turn: bool = False


class Picture(Protocol):
    """A scene or a state as people see it."""

    def text(self, width: int, colour: bool) -> list[str]:
        """Lines for a terminal with so many columns, with ANSI codes if `colour`; otherwise every
        character in them is seen (`sketchlang.escape`)."""
        ...

    def svg(self) -> str | None:
        """A drawing, or None where there is nothing to draw."""
        ...

    def data(self) -> dict[str, Any]:
        """The same as plain data."""
        ...


class DomainError(Exception):
    """A domain is declared in a way that sketches cannot use; the text says how to mend it."""


class SceneError(Exception):
    """What a scene loader raises for a file that is no scene of its domain; the text is for
    the user and begins with the file's name."""


_SENTENCE = re.compile(r"(?<=[.!?])\s")


def first_sentence(text: str | None) -> str:
    """The first sentence of a docstring, in one line."""
    paragraph = " ".join((text or "").partition("\n\n")[0].split())
    return _SENTENCE.split(paragraph, maxsplit=1)[0]


@dataclass(frozen=True, slots=True)
class Function:
    """A function of the domain as sketches see it; `call` takes the state first. `ignores`
    are the parts of the state that its result does not depend on.

    A relation is a function to `bool` that can list all tuples for which it holds:
    `extension(state)`. Its arguments may be left open. `declared` is its place where that is
    no Python file.
    """

    name: str
    call: Callable[..., Any]
    parameters: tuple[Type, ...]
    result: Type
    ignores: frozenset[str] = frozenset()
    extension: Callable[[Any], Collection[tuple[Any, ...]]] | None = None
    declared: Label | None = None

    @property
    def summary(self) -> str:
        """The first sentence of its docstring."""
        return first_sentence(inspect.getdoc(self.call))

    @property
    def position(self) -> str:
        """`file:line` of its definition, or its name where that is not to be had."""
        return position_of(self.call, self.name)

    def place(self) -> Label | None:
        """Where it is declared, or None where the source is not to be had."""
        if self.declared is not None:
            return self.declared
        code = getattr(inspect.unwrap(self.call), "__code__", None)
        if code is None:
            return None
        lines = linecache.getlines(code.co_filename)
        # `co_firstlineno` is the line of the first decorator.
        for number in range(code.co_firstlineno - 1, len(lines)):
            if lines[number].lstrip().startswith(f"def {self.name}"):
                start = sum(map(len, lines[:number])) + lines[number].index("def ")
                end = sum(map(len, lines[: number + 1])) - 1
                return Label(
                    Source(_shown(code.co_filename), "".join(lines)),
                    Span(start, end),
                    "declared here",
                )
        return None

    def __str__(self) -> str:
        arguments = ", ".join(map(str, self.parameters))
        return f"{self.name}({arguments}) : {self.result}" if arguments else self.name


@dataclass
class Domain:
    """Sorts, functions, atoms, actions and the scene loader of a domain, by their names.

    `atoms[name]` maps a state to the atoms of one family that are true in it; `load` makes
    a problem of the path of a scene and options. `actions` are further action schemas, for
    domains whose problems take such. A domain that `has_robots` plans for one of them.
    `members(state, sort)` lists all elements of a sort, where the domain can do that.
    `default_atoms` are the novelty atoms of sketches that name none; `evaluator(checked)` makes the
    function from states to feature values where the domain has a quicker one than the compiler's;
    `goal_test(state)` tells whether the scene's goal holds, where that is more than a sketch says.
    `namer(state, element)` is what an element of a sort is called where people read it, or None
    where the domain has no name for it. `draw(path, name)` makes a picture of a scene, where that
    takes less than to load it. `schemas` are the actions that its problems have by themselves, each
    in one line. `large` is a number that a function returns for what cannot be counted, and what
    it stands for, so that whoever reads it in a value is told.
    """

    name: str
    summary: str = ""
    sorts: dict[str, type] = field(default_factory=dict)
    atoms: dict[str, Callable[[Any], Iterable[Hashable]]] = field(default_factory=dict)
    actions: dict[str, Any] = field(default_factory=dict)
    load: Callable[[str, LoadOptions], Any] | None = None
    has_robots: bool = False
    members: Callable[[Any, str], Collection[Any]] | None = None
    default_atoms: Callable[[Any], Iterable[Hashable]] | None = None
    evaluator: Callable[[Any], Callable[[Any], tuple[int, ...]]] | None = None
    goal_test: Callable[[Any], bool] | None = None
    namer: Callable[[Any, Any], str | None] | None = None
    draw: Callable[[str, str], Picture] | None = None
    schemas: dict[str, str] = field(default_factory=dict)
    large: tuple[int, str] | None = None
    _ignores: dict[str, frozenset[str]] = field(default_factory=dict)
    _declared: dict[str, Callable[..., Any]] = field(default_factory=dict)
    _resolved: dict[str, Function] = field(default_factory=dict)
    _wanted: dict[str, Callable[..., Any]] = field(default_factory=dict)
    _goals: dict[str, Function] = field(default_factory=dict)

    def sort(self, cls: C) -> C:
        """Declare a class as a sort. Its instances must be hashable."""
        self._claim(cls.__name__, self.sorts, "sort")
        if cls.__hash__ is None:
            raise DomainError(f"sort {cls.__name__} of domain {self.name} is not hashable")
        self.sorts[cls.__name__] = cls
        return cls

    @classmethod
    def extend(cls, base: Domain, name: str | None = None, summary: str = "") -> Domain:
        """A domain that has all of another one, and to which more can be added.

        Where it keeps the name of its base, sketches that use the base use it instead as soon
        as its file is given with `--domain`.
        """
        if not isinstance(base, Domain):
            raise DomainError(f"Domain.extend takes a Domain, not {type(base).__name__}")
        return cls(
            name or base.name,
            summary or base.summary,
            dict(base.sorts),
            dict(base.atoms),
            dict(base.actions),
            base.load,
            base.has_robots,
            base.members,
            base.default_atoms,
            None,  # no evaluator: it would not know what is added
            base.goal_test,
            base.namer,
            base.draw,
            dict(base.schemas),
            base.large,
            _ignores=dict(base._ignores),
            _declared=dict(base._declared),
            _resolved=dict(base._resolved),
            _wanted=dict(base._wanted),
            _goals=dict(base._goals),
        )

    @typing.overload
    def function(self, function: F) -> F: ...

    @typing.overload
    def function(self, *, ignores: str | Iterable[str]) -> Callable[[F], F]: ...

    def function(
        self, function: F | None = None, *, ignores: str | Iterable[str] = ()
    ) -> F | Callable[[F], F]:
        """Declare a function that feature expressions can call, under its own name.

        `ignores` names the parts (fields) of the state that its result does not depend on: in
        states that differ in these only, it need not be asked again.
        """
        parts = frozenset((ignores,) if isinstance(ignores, str) else ignores)

        def declare(function: F) -> F:
            self._claim(function.__name__, self._declared, "function")
            self._declared[function.__name__] = function
            self._ignores[function.__name__] = parts
            return function

        return declare if function is None else declare(function)

    def action(self, schema: C) -> C:
        """Declare an action schema: a class whose instances are made without arguments. What it
        has to offer is up to the domain whose scenes are loaded."""
        self._claim(schema.__name__, self.actions, "action")
        self.actions[schema.__name__] = schema
        return schema

    def add(self, function: Function, goal: bool = False) -> None:
        """Declare a function whose types are not annotations, or what the goal says of it."""
        names, found = (self._wanted, self._goals) if goal else (self._declared, self._resolved)
        self._claim(function.name, names, "function")
        names[function.name] = function.call
        self._ignores.setdefault(function.name, function.ignores)
        found[function.name] = function

    def goal(self, name: str) -> Callable[[F], F]:
        """Declare what the goal says of a function: `goal NAME(...)` in a sketch."""

        def declare(function: F) -> F:
            self._claim(name, self._wanted, "goal")
            self._wanted[name] = function
            return function

        return declare

    def universe(self, function: F) -> F:
        """Declare the function `members(state, sort)` that lists all elements of a sort."""
        self.members = function
        return function

    def naming(self, function: F) -> F:
        """Declare the function `namer(state, element)` that tells what an element is called, or
        returns None."""
        self.namer = function
        return function

    def drawing(self, function: F) -> F:
        """Declare the function `draw(path, name)` that makes a picture of a scene."""
        self.draw = function
        return function

    def called(self, state: Any, element: Any) -> str:
        """What an element of a sort is called: as the domain's `namer` says, else by its `name`,
        else by its text."""
        named = self.namer(state, element) if self.namer is not None else None
        if named is not None:
            return named
        name = getattr(element, "name", None)
        return name if isinstance(name, str) else str(element)

    def atom(self, function: F) -> F:
        """Declare a family of novelty atoms: state -> hashable values true in it."""
        self._claim(function.__name__, self.atoms, "atom")
        self.atoms[function.__name__] = function
        return function

    def scenes(self, function: F) -> F:
        """Declare the function `load(path, options)` that makes a problem of a scene."""
        if self.load is not None:
            raise DomainError(f"domain {self.name} declares a second scene loader")
        self.load = function
        return function

    def _claim(self, name: str, taken: Mapping[str, object], what: str) -> None:
        if name in taken:
            raise DomainError(f"domain {self.name} declares {what} {name} twice")
        if name in words() or not (name.isascii() and name.isidentifier()):
            raise DomainError(f"{what} {name} of domain {self.name} cannot be named in a sketch")

    @property
    def functions(self) -> Mapping[str, Function]:
        """All functions with their signatures; raises `DomainError` for unusable ones."""
        # Not worked out by the decorator: annotations may name sorts that follow below.
        for name in self._declared.keys() - self._resolved.keys():
            self._resolved[name] = self._signature(name, self._declared[name])
        return self._resolved

    @property
    def goals(self) -> Mapping[str, Function]:
        """What can stand after `goal` in an expression; raises `DomainError`."""
        for name in self._wanted.keys() - self._goals.keys():
            self._goals[name] = self._signature(name, self._wanted[name])
        return self._goals

    def overlap(self, first: str, second: str) -> bool:
        """Whether something can be of both sorts: one is below the other, or a sort below both."""
        classes = self.sorts[first], self.sorts[second]
        if issubclass(classes[0], classes[1]) or issubclass(classes[1], classes[0]):
            return True
        return any(all(issubclass(sort, cls) for cls in classes) for sort in self.sorts.values())

    def above(self, first: str, second: str) -> str | None:
        """The lowest sort that two sorts are below of; None if there is none."""
        both = [
            name
            for name, cls in self.sorts.items()
            if issubclass(self.sorts[first], cls) and issubclass(self.sorts[second], cls)
        ]
        return max(both, key=lambda name: len(self.sorts[name].__mro__), default=None)

    def _signature(self, name: str, function: Callable[..., Any]) -> Function:
        parameters = list(inspect.signature(function).parameters.values())
        if not parameters:
            raise DomainError(f"{self._where(name, function)} takes no state")
        for parameter in parameters:
            if parameter.kind not in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD):
                raise DomainError(
                    f"{self._where(name, function)}: parameter {parameter.name} is not positional"
                )
        arguments = []
        for parameter in parameters[1:]:
            kind = self._type(name, function, parameter.name, parameter.annotation)
            if kind.is_set or kind.is_relation:
                raise DomainError(
                    f"{self._where(name, function)}: parameter {parameter.name} is a set; "
                    "only results can be"
                )
            arguments.append(kind)
        annotation = function.__annotations__.get("return", inspect.Parameter.empty)
        result = self._type(name, function, "the result", annotation)
        ignores = self._ignores.get(name, frozenset())
        if not result.is_relation:
            return Function(name, function, tuple(arguments), result, ignores)
        if arguments:
            raise DomainError(f"{self._where(name, function)}: a relation takes the state only")
        sides = (Type(result.name), Type(result.to or result.name))
        return Function(name, _membership(function), sides, BOOL, ignores, function)

    def _where(self, name: str, function: Callable[..., Any]) -> str:
        code = getattr(function, "__code__", None)
        place = f" ({_shown(code.co_filename)}:{code.co_firstlineno})" if code else ""
        return f"function {name} of domain {self.name}{place}"

    def _type(self, name: str, function: Callable[..., Any], what: str, annotation: Any) -> Type:
        if annotation is inspect.Parameter.empty:
            raise DomainError(f"{self._where(name, function)}: {what} has no annotation")
        if isinstance(annotation, str):
            namespace = dict(getattr(function, "__globals__", {}))
            found = of_text(annotation, namespace, self.sorts)
        else:
            found = of_object(annotation, self.sorts)
        if found is None:
            sorts = ", ".join(self.sorts) or "none so far"
            raise DomainError(
                f"{self._where(name, function)}: {what} is annotated with "
                f"{getattr(annotation, '__name__', annotation)}, which is none of: bool, Nat, a "
                f"sort ({sorts}), frozenset[SORT], frozenset[tuple[SORT, SORT]]"
            )
        return found


def _membership(relation: Callable[[Any], Collection[tuple[Any, ...]]]) -> Callable[..., bool]:
    """The relation as a function of its two sides."""

    @functools.wraps(relation)
    def holds(state: Any, first: Any, second: Any) -> bool:
        return (first, second) in relation(state)

    return holds


def position_of(code: Any, otherwise: str = "") -> str:
    """`file:line` of a function, a method or a class; its name, or what is said otherwise, where
    that is not to be had."""
    name = otherwise or getattr(code, "__name__", str(code))
    inner = getattr(inspect.unwrap(code), "__code__", None) if callable(code) else None
    if inner is not None:
        return f"{_shown(inner.co_filename)}:{inner.co_firstlineno}"
    try:
        file, (_, line) = inspect.getsourcefile(code), inspect.getsourcelines(code)
    except (TypeError, OSError):
        return name
    return f"{_shown(file)}:{line}" if file else name


def _shown(path: str) -> str:
    """A path as the user may have written it: relative if it is below the current folder."""
    relative = os.path.relpath(path)
    return path if relative.startswith("..") else relative
