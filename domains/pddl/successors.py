"""Applicable operators: a tree over preconditions, searched by a kernel.

Every operator hangs at the end of a path of the bits it needs, those that most operators need
first. What a state does not have cuts off all that lies below.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from domains.pddl.ground.task import GroundTask, Operator, Places

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

WORD = 64
"""Bits of a word of a state."""

PORTION = 4096
"""So many successors of a state are made at once."""


@dataclass(frozen=True, eq=False)
class Tree:
    """The tree in arrays, nodes numbered in the order of a walk. At node i a state has to have
    `bit[i]`; if it does, operators `operators[start[i]:start[i + 1]]` have all they need, and
    the walk goes on with node i + 1; if not, with `skip[i]`."""

    bit: NDArray[np.int64]
    skip: NDArray[np.int64]
    start: NDArray[np.int64]
    operators: NDArray[np.int64]


def make_tree(operators: tuple[Operator, ...]) -> Tree:
    """The tree of some operators, whose numbers are their places."""
    import numpy as np

    needs = [operator.condition.ones for operator in operators]
    frequency = Counter(bit for need in needs for bit in need)
    paths = [
        (sorted(need, key=lambda bit: (-frequency[bit], bit)), number)
        for number, need in enumerate(needs)
    ]
    paths.sort()
    # A node 0 that every state passes is the root.
    bit, skip, start = [-1], [0], [0]
    listed: list[int] = []
    open_nodes = [0]
    depth_bits: list[int] = []
    for path, number in paths:
        common = 0
        while common < min(len(path), len(depth_bits)) and path[common] == depth_bits[common]:
            common += 1
        while len(open_nodes) > common + 1:
            skip[open_nodes.pop()] = len(bit)
        del depth_bits[common:]
        for place in path[common:]:
            open_nodes.append(len(bit))
            bit.append(place)
            skip.append(0)
            start.append(len(listed))
            depth_bits.append(place)
        listed.append(number)
    for node in open_nodes:
        skip[node] = len(bit)
    start.append(len(listed))
    return Tree(*(np.array(part, np.int64) for part in (bit, skip, start, listed)))


@dataclass(frozen=True, eq=False)
class Changes:
    """What operators do, in arrays: row i is operator i, and the rows after them are conditional
    changes, those of operator i at `conditional[i]` to `conditional[i + 1]`. List j of row r is
    `bits[first[4 r + j]:first[4 r + j + 1]]`: what has to be true (left out of operators, whose
    tree knows it) and false, what becomes true and false."""

    first: NDArray[np.int64]
    bits: NDArray[np.int64]
    conditional: NDArray[np.int64]


def make_changes(operators: tuple[Operator, ...]) -> Changes:
    """The changes of some operators, whose numbers are their places."""
    import numpy as np

    rows: list[tuple[Places, ...]] = [
        ((), op.condition.zeros, op.change.added, op.change.deleted) for op in operators
    ]
    conditional = [len(rows)]
    for operator in operators:
        rows += [
            (condition.ones, condition.zeros, change.added, change.deleted)
            for condition, change in operator.conditional
        ]
        conditional.append(len(rows))
    first, bits = [0], list[int]()
    for row in rows:
        for places in row:
            bits += places
            first.append(len(bits))
    return Changes(*(np.array(part, np.int64) for part in (first, bits, conditional)))


class Successors:
    """The operators of a task that apply in a state, in a fixed order."""

    def __init__(self, task: GroundTask) -> None:
        self._task = task
        self.width = max(1, -(-task.layout.size // WORD))

    @cached_property
    def operators(self) -> tuple[Operator, ...]:
        """The operators in the order of the walk, so that what is needed together lies together;
        their numbers are their places here."""
        operators = self._task.operators
        return tuple([operators[number] for number in make_tree(operators).operators.tolist()])

    @cached_property
    def tree(self) -> Tree:
        """The tree over all preconditions that are not negative."""
        return make_tree(self.operators)

    @cached_property
    def changes(self) -> Changes:
        """What the operators do."""
        return make_changes(self.operators)

    @cached_property
    def marks(self) -> NDArray[np.uint8]:
        """What operators have, as `kernels.CHECKED` and its neighbours say."""
        import numpy as np

        from domains.pddl.kernels import CHECKED, CONDITIONAL

        return np.array(
            [
                (CHECKED if operator.condition.zeros else 0)
                | (CONDITIONAL if operator.conditional else 0)
                for operator in self.operators
            ],
            np.uint8,
        )

    @cached_property
    def room(self) -> NDArray[np.int64]:
        """A place for the number of every operator."""
        import numpy as np

        return np.empty(len(self.operators), np.int64)

    def words(self, bits: int) -> NDArray[np.uint64]:
        """A state as an array of words."""
        import numpy as np

        return np.frombuffer(bits.to_bytes(self.width * 8, "little"), np.uint64).copy()

    def whole(self, words: NDArray[np.uint64]) -> list[int]:
        """States as whole numbers; one a row."""
        data, size = words.tobytes(), self.width * 8
        number = int.from_bytes
        return [number(data[at : at + size], "little") for at in range(0, len(data), size)]

    def following(self, bits: int) -> Iterator[tuple[list[int], NDArray[np.uint64]]]:
        """The operators that apply in a state, by their numbers, and the states after them, in
        portions."""
        import numpy as np

        from domains.pddl.kernels import follow_all

        changes, before = self.changes, self.words(bits)
        numbers = self.numbers(bits)
        for start in range(0, len(numbers), PORTION):
            chosen = numbers[start : start + PORTION]
            after = np.empty((len(chosen), self.width), np.uint64)
            follow_all(
                before, np.array(chosen, np.int64), changes.first, changes.bits,
                changes.conditional, after,
            )  # fmt: skip
            yield chosen, after

    def numbers(self, bits: int) -> list[int]:
        """The numbers of the operators whose precondition a state satisfies."""
        from domains.pddl.kernels import CHECKED, applicable

        tree, operators, marks = self.tree, self.operators, self.marks
        found = applicable(
            self.words(bits), tree.bit, tree.skip, tree.start, tree.operators, self.room
        )
        numbers: list[int] = self.room[:found].tolist()
        if not (marks[self.room[:found]] & CHECKED).any():
            return numbers
        return [number for number in numbers if not bits & operators[number].condition.false]

    def applicable(self, bits: int) -> list[Operator]:
        """The operators whose precondition a state satisfies."""
        operators = self.operators
        return [operators[number] for number in self.numbers(bits)]
