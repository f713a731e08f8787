"""Strongly connected components of a piece of the policy graph.

The piece is a set of cells - valuations of some tracked features, the rest ignored - and
some rules. A rule with `?` on k features would have 2^k edges out of every cell; here all
cells from which a rule leads to the same cells share one intermediate node, so that there
are at most two edges for each cell and rule.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sketchlang.analysis.bits import RuleBits, subsets
from sketchlang.analysis.limits import Budget

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

CELL_MB = 0.0004
"""What a cell takes at least, with its edges, while components are found (measured)."""


MANY = 2000
"""Cells from which on NumPy looks through them."""

MOST_BITS = 62
"""Bits of a cell that NumPy can hold."""


@dataclass(frozen=True, slots=True)
class Component:
    """Cells that reach each other, and the rules with an edge among them.

    `rules` is empty for a cell that no rule leads back to. `level` is the length of the
    longest path of components that ends here, so edges between components go up.
    """

    cells: tuple[int, ...]
    rules: tuple[int, ...]
    level: int


class PieceGraph:
    """Cells 0..n-1 and, behind them, intermediate nodes; `arcs` is what rules do to cells."""

    def __init__(
        self, cells: Collection[int], tracked: int, rules: Sequence[RuleBits], budget: Budget
    ) -> None:
        self.cells = sorted(cells)
        self.number = {cell: i for i, cell in enumerate(self.cells)}
        self.targets: list[list[int]] = [[] for _ in self.cells]
        self.arcs: list[tuple[int, int, int]] = []  # cell, rule, cell or intermediate node
        self._fans: dict[tuple[int, int], int] = {}
        self._out: list[list[tuple[int, int]]] | None = None
        self._packed: NDArray[np.int64] | None = None
        for rule in rules:
            budget.check()
            self._add(rule, tracked)
        budget.spend(len(self.cells) + len(self.arcs))

    def _add(self, rule: RuleBits, tracked: int) -> None:
        needs = rule.needs & tracked
        wants = rule.wants & tracked
        chosen = self._where(needs, wants)
        number, targets, arcs, index = self.number, self.targets, self.arcs, rule.index
        for i, cell in chosen:
            base, free = rule.fan(cell)
            base &= tracked
            free &= tracked
            node = self._intermediate(base, free) if free else number.get(base, -1)
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

    def out(self, number: int) -> Sequence[tuple[int, int]]:
        """What the rules make of the cell of this number: (rule, cell or intermediate node)."""
        if self._out is None:
            self._out = [[] for _ in self.cells]
            for cell, rule, node in self.arcs:
                self._out[cell].append((rule, node))
        return self._out[number]

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


def components(
    cells: Collection[int], tracked: int, rules: Sequence[RuleBits], budget: Budget
) -> list[Component]:
    """The components of a piece, in an order in which edges only lead onwards."""
    budget.reserve(len(cells) * CELL_MB)
    graph = PieceGraph(cells, tracked, rules, budget)
    owner, count = strongly_connected(graph.targets)
    budget.check()

    inside: list[set[int]] = [set() for _ in range(count)]
    for i, rule, node in graph.arcs:
        if owner[i] == owner[node]:
            inside[owner[i]].add(rule)

    levels = _levels(graph.targets, owner, count)
    grouped: list[list[int]] = [[] for _ in range(count)]
    for i, cell in enumerate(graph.cells):
        grouped[owner[i]].append(cell)
    found = [
        Component(tuple(group), tuple(sorted(inside[c])), levels[c])
        for c, group in enumerate(grouped)
        if group
    ]
    found.sort(key=lambda component: (component.level, component.cells))
    return found


def _levels(targets: list[list[int]], owner: list[int], count: int) -> list[int]:
    """Longest path to each component; Tarjan numbers components from the sinks upwards."""
    members: list[list[int]] = [[] for _ in range(count)]
    for node, component in enumerate(owner):
        members[component].append(node)
    levels = [0] * count
    for component in range(count - 1, -1, -1):
        onwards = levels[component] + 1
        for node in members[component]:
            for target in targets[node]:
                other = owner[target]
                if other != component and levels[other] < onwards:
                    levels[other] = onwards
    return levels


def strongly_connected(targets: Sequence[Sequence[int]]) -> tuple[list[int], int]:
    """Tarjan's algorithm without recursion.

    Returns the component of every node, and how many there are. Edges between components
    lead from higher to lower numbers.
    """
    unseen = -1
    order = [unseen] * len(targets)
    low = [0] * len(targets)
    owner = [unseen] * len(targets)
    stack: list[int] = []
    count = clock = 0
    for root in range(len(targets)):
        if order[root] != unseen:
            continue
        order[root] = low[root] = clock
        clock += 1
        stack.append(root)
        path = [root]
        iterators = [iter(targets[root])]
        while path:
            node = path[-1]
            for target in iterators[-1]:
                if order[target] == unseen:
                    order[target] = low[target] = clock
                    clock += 1
                    stack.append(target)
                    path.append(target)
                    iterators.append(iter(targets[target]))
                    break
                if owner[target] == unseen and order[target] < low[node]:
                    low[node] = order[target]
            else:
                path.pop()
                iterators.pop()
                if path and low[node] < low[path[-1]]:
                    low[path[-1]] = low[node]
                if low[node] == order[node]:
                    while True:
                        member = stack.pop()
                        owner[member] = count
                        if member == node:
                            break
                    count += 1
    return owner, count
