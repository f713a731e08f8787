"""Plain data as messages of the package rosbags: every field that is left out has its default."""

from __future__ import annotations

from typing import Any

import numpy as np

BASE, NAME, ARRAY, SEQUENCE = 1, 2, 3, 4
"""Kinds of fields, as rosbags numbers them."""


def typed(store: Any, kind: str, data: dict[str, Any]) -> Any:
    """A message of a type store, of plain data.

    Raises:
        KeyError: the type has no field of a name in the data, or is not in the store.
    """
    _, fields = store.fielddefs[kind]
    unknown = set(data) - {name for name, _ in fields}
    if unknown:
        raise KeyError(f"{kind} has no field {min(unknown)!r}")
    values = {name: _value(store, field, data.get(name)) for name, field in fields}
    return store.types[kind](**values)


def _value(store: Any, field: Any, value: Any) -> Any:
    node, detail = int(field[0]), field[1]
    if node == NAME:
        return typed(store, detail, value or {})
    if node == BASE:
        return _zero(detail[0]) if value is None else value
    element, count = detail
    items = [] if value is None else value
    if node == ARRAY and not len(items):
        items = [None] * count
    if int(element[0]) == BASE and element[1][0] != "string":
        plain = [_zero(element[1][0]) if item is None else item for item in items]
        return np.array(plain, dtype=element[1][0])
    return [_value(store, element, item) for item in items]


def _zero(base: str) -> Any:
    if base == "string":
        return ""
    if base == "bool":
        return False
    return 0.0 if base.startswith("float") else 0
