"""A component of a listed policy graph, and walks through it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sketchlang.analysis.limits import Budget
from sketchlang.analysis.piece import Arc, Move

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]


def csr(rows: Any, columns: Any, nodes: int) -> Any:
    """The edges from `rows` to `columns` as SciPy's searches want them: one between two nodes."""
    from scipy.sparse import csr_array

    # Several entries in one place are added up. That must be: SciPy's search for components does
    # not come back from two equal entries in a row.
    return csr_array((np.ones(len(rows)), (rows, columns)), (nodes, nodes))


class ListedPiece:
    """Cells 0..n-1 that reach each other, intermediate nodes, and arrays of edges.

    `arcs` are the edges of cells: cell, rule, cell or intermediate node. `fans` are those
    from intermediate nodes to cells.
    """

    def __init__(
        self,
        cells: Sequence[int],
        arcs: tuple[Any, Any, Any],
        fans: tuple[Any, Any],
        budget: Budget,
    ) -> None:
        self.cells = cells
        self._budget = budget
        self._nodes = int(max(map(_top, (*arcs[::2], *fans)))) + 1
        source, rule, target = arcs
        keys = source.astype(np.int64) * self._nodes + target
        order = np.argsort(keys, kind="stable")
        self._keys = keys[order]
        self._source, self._rule, self._target = source[order], rule[order], target[order]
        self._fan_source, self._fan_target = fans

    @cached_property
    def arcs(self) -> list[Arc]:
        """All edges of cells, one by one."""
        columns = (self._source, self._rule, self._target)
        return list(zip(*(column.tolist() for column in columns), strict=True))

    @cached_property
    def targets(self) -> list[list[int]]:
        """Where each node leads to."""
        found: list[list[int]] = [[] for _ in range(self._nodes)]
        for source, target in (
            (self._source, self._target),
            (self._fan_source, self._fan_target),
        ):
            for node, after in zip(source.tolist(), target.tolist(), strict=True):
                found[node].append(after)
        return found

    @cached_property
    def _graph(self) -> Any:
        rows = np.concatenate([self._source, self._fan_source])
        columns = np.concatenate([self._target, self._fan_target])
        return csr(rows, columns, self._nodes)

    def cell_with(self, rule: int) -> int:
        """The number of a cell to which a rule does something."""
        return int(self._source[np.flatnonzero(self._rule == rule)[0]])

    def path_by(self, start: int, rules: Collection[int]) -> tuple[list[Move], int]:
        """A short path from a cell up to and with an edge of one of some rules, and the cell
        where it ends."""
        moves, arc = self._path(start, np.isin(self._rule, list(rules)))
        node = int(self._target[arc])
        if node >= len(self.cells):
            node = int(self._fan_target[np.flatnonzero(self._fan_source == node)[0]])
        return [*moves, self._move(arc, node)], node

    def path_to(self, start: int, end: int) -> list[Move]:
        """A short path from a cell to another one."""
        leads = np.zeros(self._nodes, bool)
        leads[end] = True
        leads[self._fan_source[self._fan_target == end]] = True
        moves, arc = self._path(start, leads[self._target])
        return [*moves, self._move(arc, end)]

    def _move(self, arc: int, after: int) -> Move:
        before = self.cells[int(self._source[arc])]
        return Move(before, int(self._rule[arc]), self.cells[after])

    def _path(self, start: int, last: NDArray[np.bool_]) -> tuple[list[Move], int]:
        """The way to the nearest of the arcs that are `last`, and this arc."""
        from scipy.sparse.csgraph import breadth_first_order

        self._budget.check()
        found, earlier = breadth_first_order(self._graph, start)
        place = np.zeros(self._nodes, np.int64)
        place[found] = np.arange(len(found))
        arcs = np.flatnonzero(last)
        arc = int(arcs[place[self._source[arcs]].argmin()])
        before = earlier.tolist()
        path = [int(self._source[arc])]
        while path[-1] != start:
            path.append(before[path[-1]])
        return self._moves(np.array(path[::-1])), arc

    def _moves(self, path: Numbers) -> list[Move]:
        """The moves along nodes that follow each other, from a cell to a cell."""
        at_cell = np.flatnonzero(path < len(self.cells))
        here, then = path[at_cell[:-1]], path[at_cell[1:]]
        keys = here * self._nodes + path[at_cell[:-1] + 1]
        rules = self._rule[np.searchsorted(self._keys, keys)]
        cells = self.cells
        return [
            Move(cells[before], rule, cells[after])
            for before, rule, after in zip(
                here.tolist(), rules.tolist(), then.tolist(), strict=True
            )
        ]


def _top(numbers: Any) -> int:
    return int(numbers.max(initial=0))
