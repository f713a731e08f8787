"""What novelty is about in a task, and the table for widths that have no kernel."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from domains.pddl.features.rows import bits_of, mask_of
from domains.pddl.ground.task import GroundTask
from domains.pddl.state import State

Families = tuple[Callable[[State], Iterable[Any]], ...]


@dataclass(frozen=True)
class Atoms:
    """The atoms that novelty is about, as a mask, and those among them that some action or the
    goal asks to be false: for that action, becoming false is news as well."""

    mask: int
    negated: int

    def literals(self, bits: int) -> frozenset[int]:
        """What is true in a state: the bits of atoms, and those of negations below 0."""
        missing = bits_of(~bits & self.negated)
        return frozenset(bits_of(bits & self.mask)) | {~bit for bit in missing}


def atoms_of(families: Families, task: GroundTask) -> Atoms:
    """The atoms that families list of a state in which everything is true."""
    found: Atoms | None = task.memory.get(families)
    if found is None:
        full = State((1 << task.layout.size) - 1, task)
        mask = 0
        for family in families:
            for bit in family(full):
                mask |= 1 << bit
        negated = mask_of({bit for op in task.operators for bit in op.condition.zeros})
        for condition in task.goal:
            negated |= condition.false
        found = task.memory[families] = Atoms(mask, negated & mask)
    return found


class Tuples:
    """Novelty of any width k: k literals that were never true together."""

    def __init__(self, k: int) -> None:
        self.k = k
        self.seen: set[tuple[int, ...]] = set()

    def add(self, literals: frozenset[int], fresh: frozenset[int]) -> bool:
        """Remember a state; whether there was something new in it. `fresh` are those of its
        literals that were not true in the state before it, which was added."""
        size = len(self.seen)
        found = sorted(literals)
        self.seen.update(
            chosen
            for count in range(1, self.k + 1)
            for chosen in combinations(found, count)
            if not fresh.isdisjoint(chosen)
        )
        return len(self.seen) > size
