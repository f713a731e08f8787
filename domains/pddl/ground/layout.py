"""Which bit of a state stands for which atom.

A state is one whole number. The atoms of a predicate lie in a box: `p(x, y)` at
`offset + (x - low_x) * width_y + (y - low_y)`. So what `p(x, _)` is true of is a row of bits, and
with one shift a set of objects: features are made of such rows. Objects are numbered so that
those of a type, or those that share their places in atoms, are neighbours, and rows are short.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import prod

from domains.pddl.ground.reach import Values
from domains.pddl.syntax.model import OBJECT, PddlTask
from sketchlang.errors import InputError

MAX_BITS = 8_000_000
"""Bits of a state: a megabyte."""


@dataclass(frozen=True, slots=True)
class Box:
    """The bits of a predicate, `size` of them, all of which `mask` has. `strides[i]` is how far
    apart neighbours in argument i are."""

    predicate: str
    offset: int
    lows: tuple[int, ...]
    widths: tuple[int, ...]
    strides: tuple[int, ...]
    size: int
    mask: int

    def bit(self, values: Values) -> int | None:
        """The place of an atom's bit; None where it has none, since it can never be true."""
        place = self.offset
        for value, low, width, stride in zip(
            values, self.lows, self.widths, self.strides, strict=True
        ):
            if not 0 <= value - low < width:
                return None
            place += (value - low) * stride
        return place

    def values(self, bit: int) -> Values:
        """The atom of a bit."""
        rest = bit - self.offset
        found = []
        for low, stride in zip(self.lows, self.strides, strict=True):
            found.append(low + rest // stride)
            rest %= stride
        return tuple(found)


@dataclass(frozen=True)
class Layout:
    """The boxes of all predicates that change."""

    boxes: Mapping[str, Box]
    size: int

    def bit(self, predicate: str, values: Values) -> int | None:
        """The place of an atom's bit; None where it has none."""
        box = self.boxes.get(predicate)
        return None if box is None else box.bit(values)


def make_layout(atoms: Mapping[str, list[Values]]) -> Layout:
    """Boxes around the atoms that can become true.

    Raises:
        InputError: they do not fit into a state.
    """
    boxes: dict[str, Box] = {}
    size = 0
    for predicate, found in atoms.items():
        if not found:
            continue
        columns = list(zip(*found, strict=True))
        lows = tuple(map(min, columns))
        widths = tuple(max(column) - low + 1 for column, low in zip(columns, lows, strict=True))
        strides = tuple(prod(widths[place + 1 :]) for place in range(len(widths)))
        own = prod(widths)
        if own <= MAX_BITS:
            mask = (1 << own) - 1 << size
            boxes[predicate] = Box(predicate, size, lows, widths, strides, own, mask)
        size += own
        if size > MAX_BITS:
            raise InputError(f"the task is too large: its states have more than {MAX_BITS} bits")
    return Layout(boxes, size)


def object_order(task: PddlTask, atoms: Mapping[str, Iterable[Values]]) -> list[int]:
    """The numbers of the task's objects in the order in which boxes become small."""
    places: list[set[tuple[str, int]]] = [set() for _ in task.objects]
    for predicate, found in sorted(atoms.items()):
        for values in found:
            for place, value in enumerate(values):
                places[value].add((predicate, place))
    numbers = {thing.name: i for i, thing in enumerate(task.objects)}
    for name, *terms in task.init:
        if name not in atoms and len(terms) == 1:
            places[numbers[terms[0]]].add((name, -1))

    def key(number: int) -> tuple[object, ...]:
        lineages = sorted(_lineage(task, type_) for type_ in task.objects[number].types)
        return lineages[0], sorted(places[number]), number

    return sorted(range(len(task.objects)), key=key)


def _lineage(task: PddlTask, type_: str) -> tuple[str, ...]:
    """A type after those above it: sorted by this, subtypes stand together."""
    path: list[str] = [type_]
    while path[-1] != OBJECT:
        above = task.domain.types.get(path[-1], ())
        following = above[0] if above else OBJECT
        if following in path:
            break
        path.append(following)
    return tuple(reversed(path))
