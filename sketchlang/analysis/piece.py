"""Pieces of the policy graph: some features tracked, some cells, some rules.

A cell is a valuation of the tracked features, the rest ignored. A rule with `?` on k
features would have 2^k edges out of every cell; here all cells from which a rule leads to the
same cells share one intermediate node, so that there are at most two edges for each cell and rule.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

from sketchlang.analysis.bits import RuleBits, subsets
from sketchlang.analysis.limits import Budget

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MANY = 2000
"""Cells from which on NumPy looks through them."""

MOST_BITS = 62
"""Bits of a cell that NumPy can hold."""


class Move(NamedTuple):
    """One edge of the policy graph, or of a piece of it."""

    before: int
    rule: int
    after: int


@dataclass(frozen=True, slots=True)
class Piece:
    """Cells over the features in `tracked`, and rules on them."""

    tracked: int
    cells: tuple[int, ...]
    rules: tuple[RuleBits, ...]


Arc = tuple[int, int, int]
"""What a rule does to a cell: the number of the cell, the rule, and the number of a cell or an
intermediate node."""


class WalkedGraph(Protocol):
    """What is asked of a piece's graph to walk through it; cells go by number."""

    @property
    def cells(self) -> Sequence[int]: ...

    @property
    def targets(self) -> Sequence[list[int]]: ...

    @property
    def arcs(self) -> Sequence[Arc]: ...

    def cell_with(self, rule: int) -> int: ...

    def path_by(self, start: int, rules: Collection[int]) -> tuple[list[Move], int]: ...

    def path_to(self, start: int, end: int) -> list[Move]: ...


class PieceGraph:
    """Cells 0..n-1 and, behind them, intermediate nodes; `arcs` is what rules do to cells."""

    def __init__(
        self, cells: Collection[int], tracked: int, rules: Sequence[RuleBits], budget: Budget
    ) -> None:
        self.cells = sorted(cells)
        self.number = {cell: i for i, cell in enumerate(self.cells)}
        self.targets: list[list[int]] = [[] for _ in self.cells]
        self.arcs: list[Arc] = []
        self._fans: dict[tuple[int, int], int] = {}
        self._outs: list[list[tuple[int, int]]] | None = None
        self._budget = budget
        self._packed: NDArray[np.int64] | None = None
        for rule in rules:
            budget.check()
            self._add(rule, tracked)
        budget.spend(len(self.cells) + len(self.arcs))

    def _add(self, rule: RuleBits, tracked: int) -> None:
        number, targets, arcs, index = self.number, self.targets, self.arcs, rule.index
        free, sinks, climbs = rule.free & tracked, rule.sinks & tracked, rule.climbs & tracked
        sets, kept = rule.sets & tracked, ~(rule.clears | rule.free)
        for i, cell in self._where(rule.needs & tracked, rule.wants & tracked):
            ways = free | (sinks & cell) | (climbs & ~cell)
            base = (cell & kept & ~ways) | sets
            node = self._intermediate(base, ways) if ways else number.get(base, -1)
            if node >= 0:
                targets[i].append(node)
                arcs.append((i, index, node))

    def _where(self, needs: int, wants: int) -> list[tuple[int, int]]:
        """The cells (number and bits) in which some bits are as they are wanted."""
        if len(self.cells) < MANY or max(needs, self.cells[-1]).bit_length() > MOST_BITS:
            return [(i, cell) for i, cell in enumerate(self.cells) if cell & needs == wants]
        import numpy as np

        if self._packed is None:
            self._packed = np.array(self.cells, np.int64)
        found = np.flatnonzero(self._packed & needs == wants)
        return [(i, self.cells[i]) for i in found.tolist()]

    def cell_with(self, rule: int) -> int:
        """The number of a cell to which a rule does something."""
        return next(cell for cell, by, _ in self.arcs if by == rule)

    def path_by(self, start: int, rules: Collection[int]) -> tuple[list[Move], int]:
        """The shortest path from a cell up to and with an edge of one of some rules, and the
        cell where it ends."""
        return self._path(start, lambda rule, _: rule in rules)

    def path_to(self, start: int, end: int) -> list[Move]:
        """The shortest path from a cell to another one."""
        return self._path(start, lambda _, after: after == end)[0]

    def _path(self, start: int, last: Callable[[int, int], bool]) -> tuple[list[Move], int]:
        """The shortest path up to and with an edge (rule, cell after) that is `last`."""
        cells = self.cells
        reached_by: dict[int, tuple[int, int]] = {}
        queue = deque([start])
        while queue:
            self._budget.check()
            cell = queue.popleft()
            for rule, node in self._out(cell):
                for after in [node] if node < len(cells) else self.targets[node]:
                    if last(rule, after):
                        moves = [Move(cells[cell], rule, cells[after])]
                        while cell != start:
                            earlier, by = reached_by[cell]
                            moves.append(Move(cells[earlier], by, cells[cell]))
                            cell = earlier
                        return moves[::-1], after
                    if after not in reached_by and after != start:
                        reached_by[after] = (cell, rule)
                        queue.append(after)
        raise AssertionError("a component is strongly connected")

    def _out(self, number: int) -> Sequence[tuple[int, int]]:
        """What the rules make of the cell of this number: (rule, cell or intermediate node)."""
        if self._outs is None:
            self._outs = [[] for _ in self.cells]
            for cell, rule, node in self.arcs:
                self._outs[cell].append((rule, node))
        return self._outs[number]

    def _intermediate(self, base: int, free: int) -> int:
        """The node from which all of `base | subset of free` are reached, -1 if none is here."""
        node = self._fans.get((base, free))
        if node is None:
            number = self.number
            if 1 << free.bit_count() <= len(self.cells):
                reached = [number[base | s] for s in subsets(free) if base | s in number]
            else:
                reached = [i for cell, i in number.items() if cell & ~free == base]
            node = len(self.targets) if reached else -1
            if reached:
                self.targets.append(reached)
            self._fans[base, free] = node
        return node
