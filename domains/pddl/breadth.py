"""Breadth-first search that keeps what is new: the queue of IW(1) and IW(2), filled by a kernel.

The kernel runs ahead of who looks at the states: what it finds does not depend on them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from domains.pddl.novelty import Atoms
from domains.pddl.successors import WORD, Successors

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MAX_TABLE = 2 << 30
"""Bytes of a novelty table; most of them are never touched."""

FIRST_ROOM = 256
"""So many states a queue has room for at first."""


def table_rows(generator: Successors, atoms: Atoms, k: int) -> int | None:
    """How many rows the novelty table has; None where there is no kernel for it."""
    if k > 2:
        return None
    words = generator.width * (2 if atoms.negated else 1)
    rows = 1 if k == 1 else words * WORD
    return rows if rows * words * 8 <= MAX_TABLE else None


@dataclass(eq=False)
class Breadth:
    """The states of a search from `start` in the order in which they were found: `states[:tail]`,
    of which those before `head` are expanded. `origin[i]` has the place of the state that state i
    came from, the number of the operator, and how many operators had been tried by then."""

    generator: Successors
    atoms: Atoms
    k: int
    start: int
    head: int = 0
    tail: int = 1
    tried: int = 0
    states: NDArray[np.uint64] = field(init=False)
    origin: NDArray[np.int64] = field(init=False)

    def __post_init__(self) -> None:
        import numpy as np

        from domains.pddl.kernels import add, literals

        generator, atoms = self.generator, self.atoms
        rows = table_rows(generator, atoms, self.k)
        assert rows is not None, "asked for before"
        self._mask, self._negated = generator.words(atoms.mask), generator.words(atoms.negated)
        self._seen = np.zeros((rows, generator.width * (2 if atoms.negated else 1)), np.uint64)
        self.states = np.empty((FIRST_ROOM, generator.width), np.uint64)
        self.origin = np.zeros((FIRST_ROOM, 3), np.int64)
        self._marks = generator.marks.copy()
        self.states[0] = generator.words(self.start)
        now = np.empty(self._seen.shape[1], np.uint64)
        literals(self.states[0], self._mask, self._negated, now)
        add(now, self._seen, self.k)

    def grow(self, most: int) -> list[int]:
        """Expand some states: about as many as give `most` new ones, at least one. Returns the
        new states."""
        from domains.pddl.kernels import expand

        tree, changes = self.generator.tree, self.generator.changes
        begun = self.tail
        while True:
            self.head, self.tail, self.tried, lacking = expand(
                tree.bit, tree.skip, tree.start, tree.operators,
                changes.first, changes.bits, changes.conditional,
                self._mask, self._negated, self._seen, self.k, self._marks,
                self.states, self.origin, self.head, self.tail, most, self.generator.room,
            )  # fmt: skip
            if not lacking:
                break
            self._enlarge(max(len(self.states) * 2, len(self.states) + lacking))
        return self.generator.whole(self.states[begun : self.tail])

    def _enlarge(self, room: int) -> None:
        import numpy as np

        more = room - len(self.states)
        width = self.states.shape[1]
        self.states = np.concatenate([self.states, np.empty((more, width), np.uint64)])
        self.origin = np.concatenate([self.origin, np.zeros((more, 3), np.int64)])

    def path(self, number: int) -> list[tuple[int, int]]:
        """The numbers of the operators that lead to a state, with the states after them."""
        steps = []
        while number:
            before, operator, _ = self.origin[number].tolist()
            steps.append((operator, self.generator.whole(self.states[number : number + 1])[0]))
            number = before
        return steps[::-1]
