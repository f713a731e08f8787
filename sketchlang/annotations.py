"""Annotations of a domain's functions to the types that sketches know."""

from __future__ import annotations

import ast
import collections.abc
import types
import typing
from collections.abc import Mapping
from typing import Annotated, Any

from sketchlang.types import BOOL, NAT, Type

Nat = Annotated[int, "a whole number from 0 on"]
"""The annotation for a non-negative integer."""

_SETS = (frozenset, set, collections.abc.Set, collections.abc.Collection, collections.abc.Sequence)


def of_object(annotation: Any, sorts: Mapping[str, type]) -> Type | None:
    """The type that an evaluated annotation stands for."""
    if annotation is bool:
        return BOOL
    if annotation is Nat:
        return NAT
    for name, cls in sorts.items():
        if annotation is cls:
            return Type(name)
    if isinstance(annotation, typing.ForwardRef):
        return of_text(annotation.__forward_arg__, {}, sorts)
    if isinstance(annotation, types.GenericAlias | typing._GenericAlias):  # type: ignore[attr-defined]
        origin = typing.get_origin(annotation)
        arguments = typing.get_args(annotation)
        many = origin in _SETS or origin is list
        if origin is tuple and len(arguments) == 2 and arguments[1] is Ellipsis:
            many, arguments = True, arguments[:1]
        if many and len(arguments) == 1:
            inner = arguments[0]
            sides = _sides(inner, sorts)
            if sides is not None:
                return Type(sides[0], to=sides[1])
            element = (
                of_text(inner, {}, sorts) if isinstance(inner, str) else of_object(inner, sorts)
            )
            return (
                Type(element.name, True)
                if element and element.to is None and not element.is_set
                else None
            )
    return None


def _sides(annotation: Any, sorts: Mapping[str, type]) -> tuple[str, str] | None:
    """The sorts of `tuple[A, B]`."""
    if typing.get_origin(annotation) is not tuple:
        return None
    found = []
    for part in typing.get_args(annotation):
        side = of_text(part, {}, sorts) if isinstance(part, str) else of_object(part, sorts)
        if side is None or side.is_set or side.is_relation or side in (BOOL, NAT):
            return None
        found.append(side.name)
    return (found[0], found[1]) if len(found) == 2 else None


def of_text(annotation: str, namespace: dict[str, Any], sorts: Mapping[str, type]) -> Type | None:
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
    return of_object(value, sorts)
