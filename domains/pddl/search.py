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

from domains.pddl.features.evaluator import Evaluator
from domains.pddl.features.rows import bits_of
from domains.pddl.ground.task import GroundTask, Operator
from domains.pddl.state import State
from domains.pddl.successors import Successors
from runtime.search.query import Query

CHECKED_EVERY = 256
"""The clock is looked at after so many states."""


class Singles:
    """Novelty of width 1: an atom that was never true."""

    def __init__(self) -> None:
        self.seen = 0

    def is_new(self, before: int, after: int) -> bool:
        """Whether a state has something new, if the one before it was added."""
        return bool(after & ~self.seen)

    def add(self, after: int) -> None:
        """Remember a state."""
        self.seen |= after


class Pairs:
    """Novelty of width 2: two atoms, or one, that were never true together."""

    def __init__(self) -> None:
        self.seen: dict[int, int] = {}

    def is_new(self, before: int, after: int) -> bool:
        """Whether a state has something new, if the one before it was added."""
        seen = self.seen
        return any(after & ~seen.get(bit, 0) for bit in bits_of(after & ~before))

    def add(self, after: int) -> None:
        """Remember a state."""
        seen = self.seen
        for bit in bits_of(after):
            seen[bit] = seen.get(bit, 0) | after


class Tuples:
    """Novelty of any width k: k atoms that were never true together."""

    def __init__(self, k: int) -> None:
        self.k = k
        self.seen: set[tuple[int, ...]] = set()

    def is_new(self, before: int, after: int) -> bool:
        """Whether a state has something new, if the one before it was added."""
        fresh = set(bits_of(after & ~before))
        return any(
            not fresh.isdisjoint(found) and found not in self.seen
            for size in range(1, self.k + 1)
            for found in combinations(bits_of(after), size)
        )

    def add(self, after: int) -> None:
        """Remember a state."""
        atoms = list(bits_of(after))
        for size in range(1, self.k + 1):
            self.seen.update(combinations(atoms, size))


Table = Singles | Pairs | Tuples


def novelty_table(k: int) -> Table:
    """An empty table."""
    if k == 1:
        return Singles()
    return Pairs() if k == 2 else Tuples(k)


class Atoms:
    """The atoms that novelty is about, of a mask, and the negations of those among them that
    some action asks to be false: for that action, becoming false is news as well."""

    def __init__(self, mask: int, task: GroundTask) -> None:
        negated = 0
        for operator in task.operators:
            negated |= operator.condition.false
        for condition in task.goal:
            negated |= condition.false
        negated &= mask
        size = task.layout.size

        def with_negations(bits: int) -> int:
            return bits & mask | (~bits & negated) << size

        self.true: Callable[[int], int]
        """What is true in a state."""
        if negated:
            self.true = with_negations
        elif mask == (1 << size) - 1:
            self.true = lambda bits: bits
        else:
            self.true = lambda bits: bits & mask


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

        IW(1) includes IW(0): a state one step away may be a subgoal although nothing in it is new.
        """
        if query.k == 1 and self.attempt:
            return None  # the same actions again, and the same result
        task, applicable = self.task, self.generator.applicable
        fired, values, before = query.guide.fired, query.guide.values, query.before
        effort, check = query.effort, query.limits.check
        start: int = query.start.bits
        atoms = Atoms(atom_mask(query.guide.sketch.atoms, task), task)
        true, table = atoms.true, novelty_table(query.k)
        table.add(true(start))
        is_new = table.is_new
        origin: dict[int, tuple[int, Operator]] = {}
        stale: dict[int, Operator] = {}
        queue = [start]
        looked = 0
        for bits in queue:
            effort.expanded += 1
            known = true(bits)
            first = bits == start and query.k == 1
            for operator in applicable(bits):
                looked += 1
                if not looked % CHECKED_EVERY:
                    check()
                after = operator.apply(bits)
                now = true(after)
                if not is_new(known, now):
                    if first and after != bits:
                        stale.setdefault(after, operator)
                    continue
                state = State(after, task)
                rule = fired(before, values(state), state)
                if rule is not None:
                    effort.generated += looked
                    origin.setdefault(after, (bits, operator))
                    return self._steps(origin, start, after), rule
                table.add(now)
                if after not in origin:
                    queue.append(after)
                    origin[after] = (bits, operator)
            effort.generated += looked
            looked = 0
            if first:
                found = self._one_step(query, stale)
                if found is not None:
                    return found
        return None

    def _one_step(self, query: Query, stale: dict[int, Operator]) -> Found | None:
        """A subgoal among states one step away that have nothing new. Of those that features
        cannot tell from each other, one is looked at."""
        evaluate = query.guide.sketch.evaluate
        mask = -1
        if isinstance(evaluate, Evaluator):
            mask = evaluate.looks_at(self.task) | self.task.goal_mask
        alike: dict[int, tuple[int, Operator]] = {}
        for bits, operator in stale.items():
            alike.setdefault(bits & mask, (bits, operator))
        for number, (bits, operator) in enumerate(alike.values(), 1):
            if not number % CHECKED_EVERY:
                query.limits.check()
            state = State(bits, self.task)
            rule = query.guide.fired(query.before, query.guide.values(state), state)
            if rule is not None:
                return [(operator, (), state)], rule
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
    found: int | None = task.memory.get(families)
    if found is None:
        full = State((1 << task.layout.size) - 1, task)
        found = 0
        for family in families:
            for bit in family(full):
                found |= 1 << bit
        task.memory[families] = found
    return found
