"""IW(k) over bits: what `runtime.search.iw` does, for states that are whole numbers.

The novelty table for k = 1 is the set of atoms seen, for k = 2 a set for every atom: those that
were seen together with it. An action makes nothing new but by what it adds, so only that is looked
up; and features are computed of new states only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from domains.pddl.features.rows import bits_of
from domains.pddl.ground.task import GroundTask, Operator
from domains.pddl.state import State
from domains.pddl.successors import Successors
from runtime.search.query import Query

CHECKED_EVERY = 256
"""The clock is looked at after so many states."""


class Singles:
    """Novelty of width 1: an atom that was never true."""

    def __init__(self, mask: int) -> None:
        self.mask = mask
        self.seen = 0

    def is_new(self, before: int, after: int) -> bool:
        """Whether a state has something new, if the one before it was added."""
        return bool(after & self.mask & ~self.seen)

    def add(self, after: int) -> None:
        """Remember a state."""
        self.seen |= after


class Pairs:
    """Novelty of width 2: two atoms, or one, that were never true together."""

    def __init__(self, mask: int) -> None:
        self.mask = mask
        self.seen: dict[int, int] = {}

    def is_new(self, before: int, after: int) -> bool:
        """Whether a state has something new, if the one before it was added."""
        after &= self.mask
        seen = self.seen
        return any(after & ~seen.get(bit, 0) for bit in bits_of(after & ~before))

    def add(self, after: int) -> None:
        """Remember a state."""
        after &= self.mask
        seen = self.seen
        for bit in bits_of(after):
            seen[bit] = seen.get(bit, 0) | after


class Tuples:
    """Novelty of any width k: k atoms that were never true together."""

    def __init__(self, mask: int, k: int) -> None:
        self.mask = mask
        self.k = k
        self.seen: set[tuple[int, ...]] = set()

    def is_new(self, before: int, after: int) -> bool:
        """Whether a state has something new, if the one before it was added."""
        after &= self.mask
        fresh = set(bits_of(after & ~before))
        return any(
            not fresh.isdisjoint(found) and found not in self.seen
            for size in range(1, self.k + 1)
            for found in combinations(bits_of(after), size)
        )

    def add(self, after: int) -> None:
        """Remember a state."""
        atoms = list(bits_of(after & self.mask))
        for size in range(1, self.k + 1):
            self.seen.update(combinations(atoms, size))


Table = Singles | Pairs | Tuples


def novelty_table(mask: int, k: int) -> Table:
    """An empty table for the atoms of a mask."""
    if k == 1:
        return Singles(mask)
    return Pairs(mask) if k == 2 else Tuples(mask, k)


Found = tuple[list[tuple[Operator, tuple[()], State]], str]
"""The steps to a subgoal, and the rule that it satisfies."""


@dataclass(frozen=True, eq=False)
class PddlSubproblem:
    """All operators of a task; each is executable. `attempt` counts how often it is tried."""

    task: GroundTask
    generator: Successors
    attempt: int

    def actions(self, state: State) -> list[tuple[Operator, State]]:
        """The operators that apply, and where they lead."""
        bits, task = state.bits, self.task
        return [
            (operator, State(operator.apply(bits), task))
            for operator in self.generator.applicable(bits)
        ]

    def execute(self, state: State, action: Operator) -> tuple[()]:
        """Nothing moves."""
        return ()

    def search(self, query: Query) -> Found | None:
        """IW(k) from the start of a query; see `runtime.search.iw`.

        Where IW(1) fails, IW(0) follows: a state one step away may be a subgoal although nothing in
        it is new.
        """
        if query.k > 1:
            return self._iw(query)
        if self.attempt:
            return None  # the same actions again, and the same result
        return self._iw(query) or self._one_step(query)

    def _one_step(self, query: Query) -> Found | None:
        start: int = query.start.bits
        for operator in self.generator.applicable(start):
            query.limits.check()
            query.effort.generated += 1
            state = State(operator.apply(start), self.task)
            rule = query.guide.fired(query.before, query.guide.values(state), state)
            if rule is not None:
                return [(operator, (), state)], rule
        return None

    def _iw(self, query: Query) -> Found | None:
        task, applicable = self.task, self.generator.applicable
        fired, values, before = query.guide.fired, query.guide.values, query.before
        effort, check = query.effort, query.limits.check
        start: int = query.start.bits
        table = novelty_table(atom_mask(query.guide.sketch.atoms, task), query.k)
        table.add(start)
        is_new = table.is_new
        origin: dict[int, tuple[int, Operator]] = {}
        queue = [start]
        looked = 0
        for bits in queue:
            effort.expanded += 1
            for operator in applicable(bits):
                looked += 1
                if not looked % CHECKED_EVERY:
                    check()
                after = operator.apply(bits)
                if not is_new(bits, after):
                    continue
                state = State(after, task)
                rule = fired(before, values(state), state)
                if rule is not None:
                    effort.generated += looked
                    origin.setdefault(after, (bits, operator))
                    return self._steps(origin, start, after), rule
                table.add(after)
                if after not in origin:
                    queue.append(after)
                    origin[after] = (bits, operator)
            effort.generated += looked
            looked = 0
        return None

    def _steps(
        self, origin: dict[int, tuple[int, Operator]], start: int, end: int
    ) -> list[tuple[Operator, tuple[()], State]]:
        steps = []
        while end != start:
            before, operator = origin[end]
            steps.append((operator, (), State(end, self.task)))
            end = before
        return steps[::-1]


def atom_mask(families: tuple[Callable[[State], Iterable[Any]], ...], task: GroundTask) -> int:
    """The bits of the atoms that novelty is about: what the families list of a state in which
    everything is true."""
    full = State((1 << task.layout.size) - 1, task)
    found = 0
    for family in families:
        for bit in family(full):
            found |= 1 << bit
    return found
