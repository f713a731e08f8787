"""IW(k) over bits: what `runtime.search.iw` does, for states that are whole numbers.

IW(1) and IW(2) run in a kernel, which goes ahead by some states; features are computed of new
states only, and of them those that some rule says something about.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from domains.pddl.breadth import Breadth, table_rows
from domains.pddl.features.evaluator import Evaluator
from domains.pddl.ground.task import GroundTask, Operator
from domains.pddl.novelty import Atoms, Tuples, atoms_of
from domains.pddl.state import State
from domains.pddl.successors import Successors
from runtime.search.guide import GOAL, Guide, Values
from runtime.search.query import Query
from sketchlang.model import Effect

CHECKED_EVERY = 256
"""The clock is looked at after so many states."""

AHEAD = 16, 1024
"""The kernel goes ahead of the features by so many states: at first, and at most."""

LIKENESSES = 1000
"""So many states are remembered for a failed search that differ in what rules speak of."""

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
        atoms = atoms_of(query.guide.sketch.atoms, self.task)
        look = Look(query, self.task)
        quick = table_rows(self.generator, atoms, query.k) is not None
        try:
            found = (self._ahead if quick else self._one_by_one)(query, atoms, look)
            look.found = found is not None
        finally:
            look.close()
        return found

    def _ahead(self, query: Query, atoms: Atoms, look: Look) -> Found | None:
        """By the kernel, which runs ahead."""
        check, effort = query.limits.check, query.effort
        breadth = Breadth(self.generator, atoms, query.k, query.start.bits)
        # The states one step away are looked at before others, where all of them count.
        most = 1 if query.k == 1 else AHEAD[0]
        try:
            while breadth.head < breadth.tail:
                begun = breadth.tail
                for number, bits in enumerate(breadth.grow(most), begun):
                    rule = look.rule(bits)
                    if rule is not None:
                        # Who goes ahead has done more than was needed: that does not count.
                        before, _, breadth.tried = breadth.origin[number].tolist()
                        breadth.head = before + 1
                        return self._steps(breadth.path(number)), rule
                check()
                if most == 1:
                    found = self._one_step(query, look)
                    if found is not None:
                        return found
                most = min(max(AHEAD[0], most * 2), AHEAD[1])
        finally:
            effort.expanded += breadth.head
            effort.generated += breadth.tried
        return None

    def _one_by_one(self, query: Query, atoms: Atoms, look: Look) -> Found | None:
        """For any k: the plain way."""
        check, effort = query.limits.check, query.effort
        numbers, operators = self.generator.numbers, self.generator.operators
        start: int = query.start.bits
        table = Tuples(query.k)
        table.add(atoms.literals(start), atoms.literals(start))
        origin: dict[int, tuple[int, int]] = {}
        queue = [start]
        for bits in queue:
            effort.expanded += 1
            known = atoms.literals(bits)
            for number in numbers(bits):
                effort.generated += 1
                if not effort.generated % CHECKED_EVERY:
                    check()
                after = operators[number].apply(bits)
                now = atoms.literals(after)
                if not table.add(now, now - known):
                    continue
                origin[after] = bits, number
                rule = look.rule(after)
                if rule is not None:
                    path = []
                    while after != start:
                        before, number = origin[after]
                        path.append((number, after))
                        after = before
                    return self._steps(path[::-1]), rule
                queue.append(after)
        return None

    def _one_step(self, query: Query, look: Look) -> Found | None:
        """A subgoal among the states one step away. Of those that features cannot tell from each
        other, one is looked at."""
        start: int = query.start.bits
        for number, bits in self._alike(start, look.mask):
            if bits == start:
                continue
            rule = look.rule(bits)
            if rule is not None:
                return self._steps([(number, bits)]), rule
            query.limits.check()
        return None

    def _alike(self, bits: int, mask: int) -> Iterator[tuple[int, int]]:
        """Operators and the states after them, the first of all that agree in a mask."""
        import numpy as np

        generator = self.generator
        words = generator.words(mask & (1 << self.task.layout.size) - 1)
        seen: set[int] = set()
        for numbers, after in generator.following(bits):
            rows = np.ascontiguousarray(after & words).view(f"V{generator.width * 8}").ravel()
            _, firsts = np.unique(rows, return_index=True)
            firsts.sort()
            for place, whole in zip(firsts.tolist(), generator.whole(after[firsts]), strict=True):
                if whole & mask not in seen:
                    seen.add(whole & mask)
                    yield numbers[place], whole

    def _steps(self, path: list[tuple[int, int]]) -> list[tuple[Operator, tuple[()], State]]:
        operators, task = self.generator.operators, self.task
        return [(operators[number], (), State(bits, task)) for number, bits in path]


class Look:
    """Looks at states of a search: which rule leads there from its start.

    Where features are compiled, only those are computed that an applicable rule restricts: what
    is `?` in all of them does not matter. `mask` has the bits of a state that were looked at.
    """

    def __init__(self, query: Query, task: GroundTask) -> None:
        self.guide: Guide = query.guide
        self.before, self.task = query.before, task
        self.found = False
        self.mask = -1
        self._values: Callable[[int], Values] | None = None
        self._rules: dict[Values, str | None] = {}
        self._like: dict[Values, int] = {}
        self._count = 0
        sketch = self.guide.sketch
        if isinstance(sketch.evaluate, Evaluator) and sketch.goal_test is not None:
            wanted = {
                feature
                for rule in self.guide.model.rules
                if rule.applies(query.before)
                for feature in range(len(query.before))
                if rule.effects.get(feature) is not Effect.ANY
            }
            part = sketch.evaluate.part(task, frozenset(wanted), query.before)
            self._values, self.mask = part.values, part.mask | task.goal_mask

    def rule(self, bits: int) -> str | None:
        """The rule that a state satisfies, or `GOAL`; None where it is no subgoal."""
        self._count += 1
        if self._values is None:
            state = State(bits, self.task)
            return self.guide.fired(self.before, self.guide.values(state), state)
        values = self._values(bits)
        try:
            rule = self._rules[values]
        except KeyError:
            rule = self._rules[values] = self.guide.rule(self.before, values)
            self._like[values] = bits
        if rule is None and self.task.is_goal(bits):
            self.guide.hopeful = True
            return GOAL
        return rule

    def close(self) -> None:
        """Let the guide know what was seen, for those who ask why nothing was found."""
        if self.found or self._values is None:
            return
        like = list(self._like.values())[:LIKENESSES]
        for bits in like:
            self.guide.values(State(bits, self.task))
        self.guide.others += self._count - len(like)
