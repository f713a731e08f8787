"""Sieve on the whole policy graph, with arrays: the last resort, where no feature can be ignored.

1. Valuations from which no rule leads on, and those to which none leads, are peeled off, layer
   after layer, as long as that pays.
2. What is left becomes a list of edges; cells from which a rule leads to the same cells
   share an intermediate node.
3. Strongly connected components; in each, the edges go that lower a nat which nothing in the
   component may raise; and again, until no edge is left, or a component stays as it is.

The evidence is one table a round: a rank for each valuation, by component. No rule that is
left leads to a lower rank, and those that keep a rank are seen in the next round.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sketchlang.analysis.bits import RuleBits, bounded_mask, members, subsets
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.proof import Ranks
from sketchlang.analysis.region import feature_mask
from sketchlang.analysis.valuations import Valuations
from sketchlang.analysis.walk import Piece
from sketchlang.model import SketchModel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]

MOST_FEATURES = 25
"""Features up to which an array over all valuations is made."""

MOST_EDGES = 60_000_000
"""Edges beyond which nothing is listed: a gigabyte."""

EDGE_MB = 40 / (1 << 20)
"""Memory of an edge at the worst moment (measured)."""

PAYS = 0.1
"""Layers are peeled while each takes this part of what is left."""

OUT = 0xFFFFFFFF
"""The rank of valuations that no infinite run passes."""


class TooManyEdgesError(Exception):
    """The policy graph is too large to be listed."""


@dataclass(frozen=True)
class Listed:
    """A step that takes away all rules, or a component that Sieve cannot take apart."""

    step: Ranks | None
    stuck: Piece | None


def relevant_features(model: SketchModel, rules: Sequence[RuleBits]) -> list[int]:
    """The features that the rules test or change, and those of goal and invariants."""
    mask = sum(1 << feature for feature in model.goal or {})
    for invariant in model.invariants:
        mask |= feature_mask(invariant.formula)
    for rule in rules:
        mask |= rule.needs | rule.touched
    return list(members(mask))


def applications(model: SketchModel, rules: Sequence[RuleBits]) -> int | None:
    """How often a rule applies to a valuation, None if there are too many features for a list."""
    count = len(relevant_features(model, rules))
    if count > MOST_FEATURES:
        return None
    return sum(1 << (count - rule.needs.bit_count()) for rule in rules)


class Listing:
    """The policy graph of some rules."""

    def __init__(self, model: SketchModel, rules: Sequence[RuleBits], budget: Budget) -> None:
        self.rules = list(rules)
        self.budget = budget
        self.bounded = bounded_mask(model)
        self.space = Valuations(model, relevant_features(model, rules))
        budget.reserve(self.space.count * 16 / (1 << 20))
        self.ranks = np.full(self.space.shape, OUT, np.uint32)
        self.alive = ~self.space.outside()
        self.first = self.last = 0  # how many layers were peeled off from either end

    def run(self) -> Listed:
        """Takes the graph apart, or finds a component that stays."""
        self._peel()
        return _Graph(self).run()

    def _peel(self) -> None:
        """Takes away layers from both ends of the graph and ranks them."""
        high: list[NDArray[np.bool_]] = []
        while True:
            left = int(self.alive.sum())
            forwards, backwards = (np.zeros(self.space.shape, bool) for _ in range(2))
            for rule in self.rules:
                self.budget.check()
                here = self.alive[self.space.before(rule)]
                forwards[self.space.before(rule)] |= here & self.space.leading_into(
                    rule, self.alive
                )
                backwards[self.space.after(rule)] |= self.space.led_to(rule, self.alive)
            sinks = self.alive & ~forwards
            sources = self.alive & forwards & ~backwards
            self.ranks[sources] = self.first
            self.first += bool(sources.any())
            if sinks.any():
                high.append(sinks)
            self.alive &= forwards & backwards
            gone = left - int(self.alive.sum())
            if gone <= PAYS * left:
                break
        # What was peeled off first from the far end comes last. Ranks in between follow.
        for layer in reversed(high):
            self.ranks[layer] = self.first + self.last
            self.last += 1

    def table(self, middle: Numbers) -> bytes:
        """The ranks of all valuations, with those of the graph's cells given."""
        count = int(middle.max()) + 1 if len(middle) else 0
        ranks = self.ranks.copy()
        ranks[(ranks >= self.first) & (ranks != OUT)] += np.uint32(count)
        ranks[self.alive] = (middle + self.first).astype(np.uint32)
        return ranks.astype("<u4").tobytes()


class _Graph:
    """Cells 0..n-1, the valuations that are left, and behind them intermediate nodes."""

    def __init__(self, listing: Listing) -> None:
        self.listing = listing
        self.budget = listing.budget
        self.rules = listing.rules
        self.cells = np.flatnonzero(listing.alive.ravel())
        self.number = np.full(listing.space.count, -1, np.int32)
        self.number[self.cells] = np.arange(len(self.cells), dtype=np.int32)
        self._numbers = np.arange(listing.space.count, dtype=np.uint32).reshape(listing.space.shape)
        self.nodes = len(self.cells)
        self.edges = 0
        arcs: list[Any] = []
        self.fans: list[Any] = []
        for position, rule in enumerate(self.rules):
            arcs += self._arcs(position, rule)
        self.source, self.target, self.by = _joined(arcs, 3)
        self.fan_source, self.fan_target = _joined(self.fans, 2)

    def _arcs(self, position: int, rule: RuleBits) -> list[Any]:
        """What a rule does to cells: (cells, nodes, number of the rule), each an array."""
        self.budget.check()
        space, listing = self.listing.space, self.listing
        where = space.before(rule)
        used = listing.alive[where] & space.leading_into(rule, listing.alive)
        cells = self._numbers[where][used]
        sinks, climbs, sets = (space.squeezed(m) for m in (rule.sinks, rule.climbs, rule.sets))
        free, clears = space.squeezed(rule.free), space.squeezed(rule.clears)
        ways = free | (cells & sinks) | (~cells & climbs)
        found: list[Any] = []
        for way in np.unique(ways):
            chosen = cells[ways == way]
            base = (chosen & ~np.uint32(clears | int(way))) | np.uint32(sets)
            if int(way).bit_count() <= 1:
                found += [
                    self._edges(chosen, base | np.uint32(choice), position)
                    for choice in subsets(int(way))
                ]
                continue
            bases, nodes = np.unique(base, return_inverse=True)
            self._reserve(len(chosen) + (len(bases) << int(way).bit_count()))
            fan = (self.nodes + np.arange(len(bases))).astype(np.int32)
            self.nodes += len(bases)
            for choice in subsets(int(way)):
                target = self.number[bases | np.uint32(choice)]
                self.fans.append((fan[target >= 0], target[target >= 0]))
            by = np.full(len(chosen), position, np.int32)
            found.append((self.number[chosen], fan[nodes.ravel()], by))
        return found

    def _edges(self, cells: Any, after: Any, position: int) -> Any:
        self._reserve(len(cells))
        target = self.number[after]
        kept = target >= 0
        by = np.full(int(kept.sum()), position, np.int32)
        return self.number[cells[kept]], target[kept], by

    def _reserve(self, edges: int) -> None:
        self.edges += edges
        self.budget.reserve(self.edges * EDGE_MB)
        if self.edges > MOST_EDGES:
            raise TooManyEdgesError

    def run(self) -> Listed:
        tables: list[bytes] = []
        ranks = np.zeros(len(self.cells), np.int64)
        while True:
            self.budget.check()
            order = self._components()
            # Later rounds refine earlier ones: first by the old rank, then by the new.
            both = ranks * (self.nodes + 1) + order[: len(self.cells)]
            ranks = np.unique(both, return_inverse=True)[1].ravel()
            tables.append(self.listing.table(ranks))
            self._keep(order[self.source] == order[self.target], order)
            if not len(self.source):
                indices = tuple(rule.index for rule in self.rules)
                return Listed(Ranks(self.listing.space.features, tuple(tables), indices), None)
            gone = self._removable(order)
            untouched = np.bincount(order[self.source[gone]], minlength=self.nodes + 1) == 0
            if untouched[order[self.source]].any():
                return Listed(None, self._stuck(order, untouched))
            self._keep(~gone, order)

    def _components(self) -> Numbers:
        """A number for each node by its component, such that edges never lead to lower ones."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components

        rows = np.concatenate([self.source, self.fan_source])
        columns = np.concatenate([self.target, self.fan_target])
        entries = np.ones(len(rows), np.int8)
        graph = csr_array((entries, (rows, columns)), (self.nodes, self.nodes))
        _, labels = connected_components(graph, directed=True, connection="strong")
        order: Numbers = labels.astype(np.int64)
        if (order[rows] > order[columns]).any():
            order = order.max() - order
        # Components come in the order in which the search leaves them: always one of the two.
        assert not (order[rows] > order[columns]).any()
        return order

    def _keep(self, kept: NDArray[np.bool_], order: Numbers) -> None:
        self.source, self.target, self.by = self.source[kept], self.target[kept], self.by[kept]
        inside = order[self.fan_source] == order[self.fan_target]
        self.fan_source, self.fan_target = self.fan_source[inside], self.fan_target[inside]

    def _removable(self, order: Numbers) -> NDArray[np.bool_]:
        """The edges that change a nat strictly which no edge of their component changes back."""
        component = order[self.source]
        gone = np.zeros(len(self.source), bool)
        falls = rises = 0
        for rule in self.rules:
            falls |= rule.falls
            rises |= rule.rises & self.listing.bounded
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

    def _does(self, change: str, feature: int) -> NDArray[np.bool_]:
        able = np.array([getattr(rule, change) >> feature & 1 for rule in self.rules], bool)
        does: NDArray[np.bool_] = able[self.by]
        return does

    def _stuck(self, order: Numbers, untouched: NDArray[np.bool_]) -> Piece:
        """The smallest component from which nothing goes, as a piece of the sketch's graph."""
        component = order[self.source]
        sizes = np.bincount(component[untouched[component]], minlength=self.nodes + 1)
        chosen = int(np.where(sizes > 0, sizes, sizes.max() + 1).argmin())
        space = self.listing.space
        cells = self.cells[np.flatnonzero(order[: len(self.cells)] == chosen)]
        rules = [self.rules[i] for i in np.unique(self.by[component == chosen])]
        tracked = space.expanded(space.count - 1)
        return Piece(tracked, tuple(space.all_expanded(cells)), tuple(rules))


def _joined(parts: Sequence[Any], columns: int) -> list[Any]:
    if not parts:
        return [np.zeros(0, np.int32) for _ in range(columns)]
    return [np.concatenate(part) for part in zip(*parts, strict=True)]
