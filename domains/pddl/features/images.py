"""Images of sets under relations, and what can be reached by them.

On a board, the neighbours of a cell lie at a few fixed distances from it in the numbering of the
objects: the image of a whole set is then a shift for each distance, however large the set is.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable

from domains.pddl.features.rows import Image, Mask, Rows, bits_of, by_rows, mask_of, reached

FEW = 8
"""A distance that fewer pairs have is not worth a shift ..."""

SPARSE = 2
"""... and a set with fewer elements than this many times the shifts goes row by row."""

REMEMBERED = 1000
"""So many results of a closure or a distance are kept, ..."""

COMPONENTS = 64
"""... and so many components of a symmetric relation."""


def image_of(rows: Rows) -> Image:
    """The images of a relation that does not change."""
    starts: dict[int, list[int]] = {}
    for first, row in rows.items():
        for second in bits_of(row):
            starts.setdefault(second - first, []).append(first)
    shifted = {d: mask_of(found) for d, found in starts.items() if len(found) >= FEW}
    if not shifted:
        return by_rows(rows)
    left = [(d, sources) for d, sources in shifted.items() if d >= 0]
    right = [(-d, sources) for d, sources in shifted.items() if d < 0]
    rest: dict[int, Mask] = {}
    for distance, found in starts.items():
        if distance not in shifted:
            for first in found:
                rest[first] = rest.get(first, 0) | 1 << first + distance
    irregular = mask_of(rest)
    one_by_one, few = by_rows(rows), SPARSE * len(shifted)

    def image(start: Mask) -> Mask:
        if start.bit_count() < few:
            return one_by_one(start)
        found = 0
        for distance, sources in left:
            found |= (start & sources) << distance
        for distance, sources in right:
            found |= (start & sources) >> distance
        for element in bits_of(start & irregular):
            found |= rest[element]
        return found

    return image


def steps(image: Image, start: Mask, end: Mask) -> int | None:
    """The fewest steps from one set to another; None where there is no way."""
    seen, frontier, number = start, start, 0
    while frontier:
        if frontier & end:
            return number
        number += 1
        frontier = image(frontier) & ~seen
        seen |= frontier
    return None


Reach = Callable[[Hashable, Image, Mask], Mask]
"""What can be reached from a set in any number of steps, and none, of a relation that is known by
a key."""


def remembering() -> Reach:
    """Remembers what was reached, by relation and set."""
    memory: dict[Hashable, Mask] = {}

    def reach(key: Hashable, image: Image, start: Mask) -> Mask:
        place = key, start
        found = memory.get(place)
        if found is None:
            if len(memory) >= REMEMBERED:
                memory.clear()
            found = memory[place] = start | reached(image, start)
        return found

    return reach


def by_components() -> Reach:
    """The same for symmetric relations: whoever can be reached reaches the same."""
    memory: dict[Hashable, list[Mask]] = {}

    def reach(key: Hashable, image: Image, start: Mask) -> Mask:
        known = memory.get(key)
        if known is None:
            if len(memory) >= REMEMBERED:
                memory.clear()
            known = memory[key] = []
        found, rest = 0, start
        for component in known:
            if component & rest:
                found |= component
                rest &= ~component
                if not rest:
                    return found
        if len(known) >= COMPONENTS:
            return found | rest | reached(image, rest)
        while rest:
            first = rest & -rest
            component = first | reached(image, first)
            if len(known) < COMPONENTS:
                known.append(component)
            found |= component
            rest &= ~component
        return found

    return reach
