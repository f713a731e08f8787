"""The policy graph as arrays of edges, and rounds of Sieve on it.

Nodes 0..n-1 are cells, behind them come intermediate nodes: all cells from which a rule leads
to the same cells share one. Round by round only the cells that some edge is left at are kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sketchlang.analysis.bits import RuleBits, members, subsets
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.listed_piece import ListedPiece, csr
from sketchlang.analysis.piece import Piece
from sketchlang.analysis.valuations import Valuations

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Truth = NDArray[np.bool_]

MOST_EDGES = 60_000_000
"""Edges beyond which nothing is listed: a gigabyte."""

EDGE_MB = 40 / (1 << 20)
"""Memory of an edge at the worst moment (measured)."""

FEW = 1 / 64
"""The part of all valuations up to which sorting numbers is quicker than marking them."""


class TooManyEdgesError(Exception):
    """The policy graph is too large to be listed."""


class ListedGraph:
    """The edges of some rules among the valuations that are `alive`.

    `ranks` has a number for each of these: lower ones for components that come earlier.
    """

    def __init__(
        self, space: Valuations, alive: Truth, rules: Sequence[RuleBits], budget: Budget
    ) -> None:
        self.rules = rules
        self._space = space
        self._budget = budget
        self._valuations = np.flatnonzero(alive.ravel())
        self.cells = np.arange(len(self._valuations))  # those of the nodes 0..n-1
        self.ranks: NDArray[np.int32] = np.zeros(len(self.cells), np.int32)
        self.nodes = len(self.cells)
        self._list_edges(alive)
        self._order: NDArray[np.int32] = np.zeros(0, np.int32)

    def _list_edges(self, alive: Truth) -> None:
        self._number = np.full(self._space.count, -1, np.int32)
        self._number[self._valuations] = np.arange(self.nodes, dtype=np.int32)
        self._listed = 0
        arcs: list[Any] = []
        self._fans: list[Any] = []
        numbers = np.arange(self._space.count, dtype=np.uint32).reshape(self._space.shape)
        marks = np.zeros(self._space.count, bool)
        for position, rule in enumerate(self.rules):
            self._budget.check()
            where = self._space.before(rule)
            used = alive[where] & self._space.leading_into(rule, alive)
            arcs += self._arcs(position, rule, numbers[where][used], marks)
        self.source, self.target, self.by = _joined(arcs, 3)
        self.fan_source, self.fan_target = _joined(self._fans, 2)
        del self._number, self._fans

    def _arcs(self, position: int, rule: RuleBits, cells: Any, marks: Truth) -> list[Any]:
        """What a rule does to cells: (cells, nodes, number of the rule), each an array."""
        space = self._space
        sinks, climbs, sets = (space.squeezed(m) for m in (rule.sinks, rule.climbs, rule.sets))
        free, clears = space.squeezed(rule.free), space.squeezed(rule.clears)
        ways = free | (cells & np.uint32(sinks)) | (~cells & np.uint32(climbs))
        found: list[Any] = []
        for way in [free] if not sinks | climbs else np.unique(ways).tolist():
            chosen = cells[ways == way] if sinks | climbs else cells
            base = (chosen & ~np.uint32(clears | way)) | np.uint32(sets)
            if way.bit_count() <= 1:
                found += [
                    self._edges(chosen, base | np.uint32(choice), position)
                    for choice in subsets(way)
                ]
                continue
            bases, places = _distinct(base, marks)
            self._reserve(len(chosen) + (len(bases) << way.bit_count()))
            fan = np.arange(self.nodes, self.nodes + len(bases), dtype=np.int32)
            self.nodes += len(bases)
            for choice in subsets(way):
                target = self._number[bases | np.uint32(choice)]
                self._fans.append((fan[target >= 0], target[target >= 0]))
            by = np.full(len(chosen), position, np.int32)
            found.append((self._number[chosen], fan[places], by))
        return found

    def _edges(self, cells: Any, after: Any, position: int) -> Any:
        self._reserve(len(cells))
        target = self._number[after]
        kept = target >= 0
        by = np.full(np.count_nonzero(kept), position, np.int32)
        return self._number[cells[kept]], target[kept], by

    def _reserve(self, edges: int) -> None:
        self._listed += edges
        self._budget.reserve(self._listed * EDGE_MB)
        if self._listed > MOST_EDGES:
            raise TooManyEdgesError

    @property
    def is_acyclic(self) -> bool:
        """Whether no edge was left inside a component."""
        return not len(self.source)

    def find_components(self) -> None:
        """Numbers the strongly connected components such that edges never lead to lower ones,
        ranks the cells by them, and keeps the edges inside."""
        if not self.nodes:
            return
        from scipy.sparse.csgraph import connected_components

        rows = np.concatenate([self.source, self.fan_source])
        columns = np.concatenate([self.target, self.fan_target])
        graph = csr(rows, columns, self.nodes)
        count, order = connected_components(graph, directed=True, connection="strong")
        if (order[rows] > order[columns]).any():
            order = count - 1 - order
            # Components come in the order in which the search leaves them: always one of the two.
            assert not (order[rows] > order[columns]).any()
        self._order = order
        self._rank(count)
        self._keep(order[self.source] == order[self.target])

    def _rank(self, count: int) -> None:
        """Tells cells of one rank apart by their components. The others keep theirs."""
        order = self._order[: len(self.cells)]
        rank_of = np.full(count, -1, np.int32)
        rank_of[order] = self.ranks[self.cells]
        used = np.flatnonzero(rank_of >= 0)  # components that have cells, in order
        ranks = rank_of[used]
        used = used[np.argsort(ranks, kind="stable")]
        sizes = np.bincount(ranks, minlength=int(self.ranks.max(initial=-1)) + 1)
        within = np.arange(len(used)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        sizes = np.maximum(sizes, 1)
        first = (np.cumsum(sizes) - sizes).astype(np.int32)
        of_component = np.zeros(count, np.int32)
        of_component[used] = within
        self.ranks = first[self.ranks]
        self.ranks[self.cells] += of_component[order]

    def _keep(self, kept: Truth) -> None:
        self.source, self.target, self.by = self.source[kept], self.target[kept], self.by[kept]
        inside = self._order[self.fan_source] == self._order[self.fan_target]
        self.fan_source, self.fan_target = self.fan_source[inside], self.fan_target[inside]

    def take_apart(self, bounded: int) -> tuple[Piece, ListedPiece] | None:
        """Takes away the edges that change a nat strictly which no edge of their component changes
        back. A component from which nothing goes is returned, if there is one."""
        component = self._order[self.source]
        gone = self._removable(component, bounded)
        untouched = np.bincount(component[gone], minlength=self.nodes + 1) == 0
        if untouched[component].any():
            return self._stuck(component, untouched)
        self._keep(~gone)
        self._shrink()
        return None

    def _shrink(self) -> None:
        """Numbers the nodes anew, without those at which no edge is left."""
        nodes = np.zeros(self.nodes, bool)
        for ends in (self.source, self.target, self.fan_source, self.fan_target):
            nodes[ends] = True
        number = np.cumsum(nodes, dtype=np.int32) - np.int32(1)
        self.cells = self.cells[nodes[: len(self.cells)]]
        self.source, self.target = number[self.source], number[self.target]
        self.fan_source, self.fan_target = number[self.fan_source], number[self.fan_target]
        self.nodes = int(np.count_nonzero(nodes))

    def _removable(self, component: NDArray[np.int32], bounded: int) -> Truth:
        gone = np.zeros(len(self.source), bool)
        falls = rises = 0
        for rule in self.rules:
            falls |= rule.falls
            rises |= rule.rises & bounded
        for strict, against, features in (
            ("falls", "may_rise", falls),
            ("rises", "may_fall", rises),
        ):
            for feature in members(features):
                moved = self._does(strict, feature)
                opposed = np.zeros(self.nodes + 1, bool)
                opposed[component[self._does(against, feature)]] = True
                gone |= moved & ~opposed[component]
        return gone

    def _does(self, change: str, feature: int) -> Truth:
        able = np.array([getattr(rule, change) >> feature & 1 for rule in self.rules], bool)
        does: Truth = able[self.by]
        return does

    def _stuck(self, component: NDArray[np.int32], untouched: Truth) -> tuple[Piece, ListedPiece]:
        """The smallest component from which nothing goes, as a piece of the sketch's graph."""
        space = self._space
        sizes = np.bincount(component[untouched[component]], minlength=self.nodes + 1)
        chosen = int(np.where(sizes > 0, sizes, sizes.max() + 1).argmin())
        inside = self._order == chosen
        number = np.cumsum(inside, dtype=np.int32) - np.int32(1)
        cells = self.cells[np.flatnonzero(inside[: len(self.cells)])]
        masks = space.all_expanded(self._valuations[cells])
        here, fans = component == chosen, inside[self.fan_source]
        used = np.unique(self.by[here])
        piece = Piece(
            space.expanded(space.count - 1), tuple(masks), tuple(self.rules[i] for i in used)
        )
        indices = np.array([rule.index for rule in self.rules])
        graph = ListedPiece(
            masks,
            (number[self.source[here]], indices[self.by[here]], number[self.target[here]]),
            (number[self.fan_source[fans]], number[self.fan_target[fans]]),
            self._budget,
        )
        return piece, graph


def _distinct(numbers: Any, marks: Truth) -> tuple[Any, Any]:
    """The numbers that occur, in order, and the place of each; `marks` is False everywhere."""
    if len(numbers) < FEW * len(marks):
        found, places = np.unique(numbers, return_inverse=True)
        return found, places.ravel()
    marks[numbers] = True
    found = np.flatnonzero(marks).astype(np.uint32)
    marks[found] = False
    place = np.empty(len(marks), np.int32)
    place[found] = np.arange(len(found), dtype=np.int32)
    return found, place[numbers]


def _joined(parts: Sequence[Any], columns: int) -> list[Any]:
    if not parts:
        return [np.zeros(0, np.int32) for _ in range(columns)]
    return [np.concatenate(part) for part in zip(*parts, strict=True)]
