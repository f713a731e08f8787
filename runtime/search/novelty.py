"""The novelty tables of IW(k) (Lipovetzky & Geffner 2012; paper, Width) and BFWS (2017)."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from itertools import combinations
from operator import eq
from typing import Any

Atoms = tuple[Hashable, ...]


class NoveltyTable:
    """Remembers the tuples of up to k atoms that were true in some state so far."""

    def __init__(self, k: int) -> None:
        self.k = k
        self._seen: set[object] = set()

    def _tuples(self, atoms: Iterable[Hashable]) -> Iterable[object]:
        if self.k == 1:
            return atoms
        numbered = sorted(atoms, key=repr)
        return (c for size in range(1, self.k + 1) for c in combinations(numbered, size))

    def is_novel(self, atoms: Iterable[Hashable]) -> bool:
        """Whether some tuple of at most k of the atoms is new."""
        seen = self._seen
        return any(item not in seen for item in self._tuples(atoms))

    def add(self, atoms: Iterable[Hashable]) -> None:
        """Remember the tuples of a state that the search keeps."""
        self._seen.update(self._tuples(atoms))


def new_tuples(
    atoms: Atoms, other: Atoms, known: frozenset[Hashable], k: int
) -> tuple[Hashable, ...]:
    """The tuples of at most k atoms of a state that are not all true in another one, whose atoms
    are `known`, and `other` in order. Atoms come in the same order in every state."""
    # Most are the same as there, and to see that at their place takes less than to hash them.
    moved = [i for i, same in enumerate(map(eq, atoms, other)) if not same]
    moved += range(len(other), len(atoms))
    fresh = [i for i in moved if atoms[i] not in known]
    if k == 1:
        return tuple(atoms[i] for i in fresh)
    chosen = set(fresh)
    return tuple(
        tuple(atoms[i] for i in places)
        for size in range(1, k + 1)
        for places in combinations(range(len(atoms)), size)
        if not chosen.isdisjoint(places)
    )


class PartitionedNovelty:
    """Novelty of BFWS: tuples of up to `k` atoms, remembered apart for every part of a partition
    of the states."""

    def __init__(self, k: int) -> None:
        self.k = k
        self._numbers: dict[Hashable, int] = {}
        self._seen: dict[Any, set[tuple[int, ...]]] = {}

    def _known(self, atoms: Atoms) -> list[int]:
        """The atoms as numbers, which are quicker to compare, in ascending order."""
        numbers = self._numbers
        return sorted(numbers.setdefault(atom, len(numbers)) for atom in atoms)

    def width(self, part: Hashable, atoms: Atoms) -> int:
        """The size of the smallest tuple of atoms that is new in a part; k + 1 if none is."""
        seen = self._seen.get(part, set())
        numbers = self._known(atoms)
        for size in range(1, self.k + 1):
            if not seen.issuperset(combinations(numbers, size)):
                return size
        return self.k + 1

    def add(self, part: Hashable, atoms: Atoms) -> None:
        """Remember a state of a part."""
        seen, numbers = self._seen.setdefault(part, set()), self._known(atoms)
        for size in range(1, self.k + 1):
            seen.update(combinations(numbers, size))
