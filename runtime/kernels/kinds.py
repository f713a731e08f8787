"""Kinds of values: what the compiler makes of an argument, known without the compiler.

Two values of one kind are of one type to Numba, whatever process or machine they are in. A kind is
plain data that can be written to a file: the name of a type for a number, else a tuple. Here every
kind has a small number of this process besides, by which kernels find their machine code: the
numbers of most values come from one look into a dictionary.
"""

from __future__ import annotations

from enum import Enum

import numpy as np

Kind = str | tuple["Kind", ...]
"""`float64`; `(array, dtype, dimensions, layout, flags)`; `(tuple, kind, ...)`; `(MODULE:CLASS,
kind, ...)` for a named tuple."""

LAYOUT = 0x1 | 0x2 | 0x100 | 0x400
"""Those flags of an array that its type depends on: contiguous rows, contiguous columns, aligned,
writable."""

ROWS, COLUMNS, ALIGNED, WRITABLE = 0x1, 0x2, 0x100, 0x400

UNKNOWN = -1
"""The number of whatever has no kind: only the compiler knows what to do with it."""

PLAIN = "biuf"
"""Kinds of elements, as NumPy calls them, that kernels are about."""

REMEMBERED = 256
"""Named tuples whose number is remembered: what they hold does not change."""

_numbers: dict[Kind, int] = {}
_kinds: list[Kind] = []


def number_of(kind: Kind) -> int:
    """The number that a kind has in this process."""
    found = _numbers.get(kind)
    if found is None:
        found = _numbers[kind] = len(_kinds)
        _kinds.append(kind)
    return found


def kind_of(number: int) -> Kind:
    """The kind of a number."""
    return _kinds[number]


_of_classes: dict[type, int] = {}
_of_arrays: dict[tuple[np.dtype, int, int], int] = {}
_of_tuples: dict[int, tuple[tuple[object, ...], int]] = {}
_of_parts: dict[tuple[type, tuple[int, ...]], int] = {}


def numbers_of(values: tuple[object, ...]) -> tuple[int, ...]:
    """The numbers of the kinds of values."""
    out = []
    for value in values:
        cls = value.__class__
        if cls is np.ndarray:
            key = (value.dtype, value.ndim, value.flags.num & LAYOUT)  # type: ignore[attr-defined]
            number = _of_arrays.get(key)
            if number is None:
                number = _of_arrays[key] = _array(*key)
        else:
            number = _of_classes.get(cls)
            if number is None:
                if isinstance(value, tuple):
                    number = _tuple(value)
                else:
                    number = _of_classes[cls] = _scalar(cls)
        out.append(number)
    return tuple(out)


def _scalar(cls: type) -> int:
    if cls is type(None):
        return number_of("none")
    if issubclass(cls, Enum):
        return UNKNOWN
    if issubclass(cls, np.generic):
        dtype = np.dtype(cls)
        return number_of(dtype.name) if dtype.kind in PLAIN else UNKNOWN
    for python, name in ((bool, "bool"), (int, "int64"), (float, "float64")):
        if issubclass(cls, python):
            return number_of(name)
    return UNKNOWN


def _array(dtype: np.dtype, dimensions: int, flags: int) -> int:
    if dtype.kind not in PLAIN or not dtype.isnative:
        return UNKNOWN
    layout = "C" if flags & ROWS else "F" if flags & COLUMNS else "A"
    kept = f"{flags & (ALIGNED | WRITABLE):#x}"
    return number_of(("array", dtype.str, str(dimensions), layout, kept))


def _tuple(value: tuple[object, ...]) -> int:
    cls = value.__class__
    named = cls is not tuple
    if named:
        if not hasattr(cls, "_fields"):
            return UNKNOWN
        found = _of_tuples.get(id(value))
        if found is not None:  # the same one still: it is kept with its number
            return found[1]
    inner = numbers_of(value)
    if UNKNOWN in inner:
        return UNKNOWN
    number = _of_parts.get((cls, inner))
    if number is None:
        name = f"{cls.__module__}:{cls.__qualname__}" if named else "tuple"
        number = number_of((name, *(kind_of(each) for each in inner)))
        _of_parts[cls, inner] = number
    if named:
        if len(_of_tuples) >= REMEMBERED:
            _of_tuples.clear()
        _of_tuples[id(value)] = (value, number)
    return number
