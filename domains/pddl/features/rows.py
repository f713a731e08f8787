"""Relations as rows of bits: `{x: set of y}`, without empty rows. Sets of objects are masks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

Mask = int
Rows = Mapping[int, Mask]
Row = Callable[[int], Mask]
"""What an object is related to."""

Image = Callable[[Mask], Mask]
"""What the elements of a set are related to."""

FEW = 32
"""Fewer bits of a mask than this are looked at one by one."""


def bits_of(mask: Mask) -> Iterator[int]:
    """The places of a mask's ones, from the lowest."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def mask_of(places: Iterable[int]) -> Mask:
    """The mask with ones at some places."""
    found = 0
    for place in places:
        found |= 1 << place
    return found


def strided(mask: Mask, stride: int) -> Mask:
    """Every so many-th bit of a mask: bit `i` of the result is bit `i * stride`."""
    if stride == 1:
        return mask
    if mask.bit_count() < FEW:
        return mask_of(bit // stride for bit in bits_of(mask) if not bit % stride)
    # Text can be cut in strides; whole numbers cannot.
    return int(bin(mask)[:1:-1][::stride][::-1], 2)


def of_pairs(pairs: Iterable[tuple[int, int]]) -> dict[int, Mask]:
    """The rows of some pairs."""
    rows: dict[int, Mask] = {}
    for first, second in pairs:
        rows[first] = rows.get(first, 0) | 1 << second
    return rows


def size(rows: Rows) -> int:
    """How many pairs there are."""
    return sum(row.bit_count() for row in rows.values())


def by_rows(rows: Rows) -> Image:
    """The images of a relation, element by element."""
    get = rows.get

    def image(start: Mask) -> Mask:
        found = 0
        while start:
            low = start & -start
            found |= get(low.bit_length() - 1, 0)
            start ^= low
        return found

    return image


def reached(image: Image, start: Mask) -> Mask:
    """What can be reached from a set in one step or more."""
    found, frontier = 0, start
    while frontier:
        following = image(frontier)
        frontier = following & ~found
        found |= following
    return found


def inverse(rows: Rows) -> dict[int, Mask]:
    """The rows the other way round."""
    found: dict[int, Mask] = {}
    for first, row in rows.items():
        bit = 1 << first
        for second in bits_of(row):
            found[second] = found.get(second, 0) | bit
    return found


def getter(rows: Rows) -> Row:
    """The row of an object, empty where there is none."""
    get = rows.get
    return lambda element: get(element, 0)


def closure(rows: Rows) -> dict[int, Mask]:
    """The transitive closure."""
    image = by_rows(rows)
    return {start: reached(image, 1 << start) for start in rows}


def identity(mask: Mask) -> dict[int, Mask]:
    """Every element of a set with itself."""
    return {element: 1 << element for element in bits_of(mask)}


def composed(first: Rows, second: Rows) -> dict[int, Mask]:
    """First one step and then another."""
    image = by_rows(second)
    found = {start: image(middle) for start, middle in first.items()}
    return {start: end for start, end in found.items() if end}


def restricted(rows: Rows, start: Mask, end: Mask | None) -> dict[int, Mask]:
    """The pairs from one set to another."""
    kept = {x: row if end is None else row & end for x, row in rows.items() if start >> x & 1}
    return {x: row for x, row in kept.items() if row}


def combined(sign: str, first: Rows, second: Rows) -> dict[int, Mask]:
    """`|`, `&` or `-` of two relations."""
    if sign == "|":
        return {x: first.get(x, 0) | second.get(x, 0) for x in {**first, **second}}
    if sign == "&":
        found = {x: row & second.get(x, 0) for x, row in first.items()}
    else:
        found = {x: row & ~second.get(x, 0) for x, row in first.items()}
    return {x: row for x, row in found.items() if row}
