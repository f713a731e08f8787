"""The novelty table of IW(k) (Lipovetzky & Geffner 2012; paper, Width)."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from itertools import combinations

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
