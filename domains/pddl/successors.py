"""Applicable operators: a tree over preconditions, searched by a kernel.

Every operator hangs at the end of a path of the bits it needs, those that most operators need
first. What a state does not have cuts off all that lies below.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from domains.pddl.features.rows import bits_of
from domains.pddl.ground.task import GroundTask, Operator

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

WORD = 64
"""Bits of a word of a state."""


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

    needs = [list(bits_of(operator.condition.true)) for operator in operators]
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


class Successors:
    """The operators of a task that apply in a state, in a fixed order."""

    def __init__(self, task: GroundTask) -> None:
        self.operators = task.operators
        self.width = max(1, -(-task.layout.size // WORD))
        self._checked = tuple(
            number for number, op in enumerate(task.operators) if op.condition.false
        )

    @cached_property
    def tree(self) -> Tree:
        """The tree over all preconditions that are not negative."""
        return make_tree(self.operators)

    @cached_property
    def _room(self) -> NDArray[np.int64]:
        import numpy as np

        return np.empty(len(self.operators), np.int64)

    def words(self, bits: int) -> NDArray[np.uint64]:
        """A state as an array of words."""
        import numpy as np

        return np.frombuffer(bits.to_bytes(self.width * 8, "little"), np.uint64)

    def applicable(self, bits: int) -> list[Operator]:
        """The operators whose precondition a state satisfies."""
        from domains.pddl.kernels import applicable

        tree = self.tree
        found = applicable(
            self.words(bits), tree.bit, tree.skip, tree.start, tree.operators, self._room
        )
        operators = self.operators
        numbers = self._room[:found].tolist()
        if not self._checked:
            return [operators[number] for number in numbers]
        return [
            operators[number] for number in numbers if not bits & operators[number].condition.false
        ]
