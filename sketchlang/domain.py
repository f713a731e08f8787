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

import ast
import collections.abc
import inspect
import linecache
import os
import types
import typing
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Protocol, TypeVar

from sketchlang.diagnostics import Label
from sketchlang.source import Source, Span
from sketchlang.syntax.grammar import words
from sketchlang.types import BOOL, NAT, Type

Nat = Annotated[int, "a whole number from 0 on"]
"""The annotation for a non-negative integer."""

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
    the run, the robot's name or file (None: the default one) and the domain's own actions."""

    name: str = ""
    seed: int = 0
    robot: str | None = None
    actions: Mapping[str, Any] = field(default_factory=dict)


class DomainError(Exception):
    """A domain is declared in a way that sketches cannot use; the text says how to mend it."""


class SceneError(Exception):
    """What a scene loader raises for a file that is no scene of its domain; the text is for
    the user and begins with the file's name."""


@dataclass(frozen=True, slots=True)
class Function:
    """A function of the domain as sketches see it; `call` takes the state first. `ignores`
    are the parts of the state that its result does not depend on."""

    name: str
    call: Callable[..., Any]
    parameters: tuple[Type, ...]
    result: Type
    ignores: frozenset[str] = frozenset()

    @property
    def summary(self) -> str:
        """The first line of its docstring."""
        return (inspect.getdoc(self.call) or "").partition("\n")[0]

    @property
    def position(self) -> str:
        """`file:line` of its definition, or its name where that is not to be had."""
        code = getattr(inspect.unwrap(self.call), "__code__", None)
        return f"{_shown(code.co_filename)}:{code.co_firstlineno}" if code else self.name

    def place(self) -> Label | None:
        """Its `def` line, or None where the source is not to be had."""
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
    """

    name: str
    summary: str = ""
    sorts: dict[str, type] = field(default_factory=dict)
    atoms: dict[str, Callable[[Any], Iterable[Hashable]]] = field(default_factory=dict)
    actions: dict[str, Any] = field(default_factory=dict)
    load: Callable[[str, LoadOptions], Any] | None = None
    has_robots: bool = False
    _ignores: dict[str, frozenset[str]] = field(default_factory=dict)
    _declared: dict[str, Callable[..., Any]] = field(default_factory=dict)
    _resolved: dict[str, Function] = field(default_factory=dict)

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
            dict(base._ignores),
            dict(base._declared),
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
            if kind.is_set:
                raise DomainError(
                    f"{self._where(name, function)}: parameter {parameter.name} is a set; "
                    "only results can be"
                )
            arguments.append(kind)
        result = function.__annotations__.get("return", inspect.Parameter.empty)
        kind = self._type(name, function, "the result", result)
        return Function(name, function, tuple(arguments), kind, self._ignores[name])

    def _where(self, name: str, function: Callable[..., Any]) -> str:
        code = getattr(function, "__code__", None)
        place = f" ({_shown(code.co_filename)}:{code.co_firstlineno})" if code else ""
        return f"function {name} of domain {self.name}{place}"

    def _type(self, name: str, function: Callable[..., Any], what: str, annotation: Any) -> Type:
        if annotation is inspect.Parameter.empty:
            raise DomainError(f"{self._where(name, function)}: {what} has no annotation")
        if isinstance(annotation, str):
            namespace = dict(getattr(function, "__globals__", {}))
            found = _of_text(annotation, namespace, self.sorts)
        else:
            found = _of_object(annotation, self.sorts)
        if found is None:
            sorts = ", ".join(self.sorts) or "none so far"
            raise DomainError(
                f"{self._where(name, function)}: {what} is annotated with "
                f"{getattr(annotation, '__name__', annotation)}, which is none of: bool, Nat, a "
                f"sort ({sorts}), frozenset[SORT]"
            )
        return found


def _shown(path: str) -> str:
    """A path as the user may have written it: relative if it is below the current folder."""
    relative = os.path.relpath(path)
    return path if relative.startswith("..") else relative


_SETS = (frozenset, set, collections.abc.Set, collections.abc.Collection, collections.abc.Sequence)


def _of_object(annotation: Any, sorts: Mapping[str, type]) -> Type | None:
    """The type that an evaluated annotation stands for."""
    if annotation is bool:
        return BOOL
    if annotation is Nat:
        return NAT
    for name, cls in sorts.items():
        if annotation is cls:
            return Type(name)
    if isinstance(annotation, typing.ForwardRef):
        return _of_text(annotation.__forward_arg__, {}, sorts)
    if isinstance(annotation, types.GenericAlias | typing._GenericAlias):  # type: ignore[attr-defined]
        origin = typing.get_origin(annotation)
        arguments = typing.get_args(annotation)
        many = origin in _SETS or origin is list
        if origin is tuple and len(arguments) == 2 and arguments[1] is Ellipsis:
            many, arguments = True, arguments[:1]
        if many and len(arguments) == 1:
            inner = arguments[0]
            element = (
                _of_text(inner, {}, sorts) if isinstance(inner, str) else _of_object(inner, sorts)
            )
            return Type(element.name, True) if element and not element.is_set else None
    return None


def _of_text(annotation: str, namespace: dict[str, Any], sorts: Mapping[str, type]) -> Type | None:
    """The same for an annotation that is a string (`from __future__ import annotations`).

    A sort counts by its name even where the function's module does not have it, for
    instance because it imports it for the type checker only.
    """
    known: dict[str, Any] = {"bool": bool, "frozenset": frozenset, "set": set, "tuple": tuple}
    known |= {"list": list, "Nat": Nat, **namespace, **sorts}
    try:
        ast.parse(annotation, mode="eval")
        value = eval(annotation, {"__builtins__": {}}, known)
    except Exception:
        return None
    return _of_object(value, sorts)
