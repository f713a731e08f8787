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
from typing import TYPE_CHECKING

import numpy as np

from sketchlang.analysis.bits import RuleBits, bounded_mask, members
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.piece import Piece, WalkedGraph
from sketchlang.analysis.proof import Ranks
from sketchlang.analysis.region import feature_mask
from sketchlang.analysis.valuations import Valuations
from sketchlang.model import SketchModel

if TYPE_CHECKING:
    from numpy.typing import NDArray


MOST_FEATURES = 25
"""Features up to which an array over all valuations is made."""

PAYS = 0.1
"""Layers are peeled while each takes this part of what is left."""

OUT = 0xFFFFFFFF
"""The rank of valuations that no infinite run passes."""


@dataclass(frozen=True)
class Listed:
    """A step that takes away all rules, or a component that Sieve cannot take apart, and its
    graph."""

    step: Ranks | None
    stuck: Piece | None = None
    graph: WalkedGraph | None = None


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
        from sketchlang.analysis.listed_graph import ListedGraph

        self._peel()
        graph = ListedGraph(self.space, self.alive, self.rules, self.budget)
        tables: list[bytes] = []
        while True:
            self.budget.check()
            graph.find_components()
            tables.append(self.table(graph.ranks))
            if graph.is_acyclic:
                indices = tuple(rule.index for rule in self.rules)
                return Listed(Ranks(self.space.features, tuple(tables), indices))
            stuck = graph.take_apart(self.bounded)
            if stuck is not None:
                return Listed(None, *stuck)

    def _peel(self) -> None:
        """Takes away layers from both ends of the graph and ranks them."""
        high: list[NDArray[np.bool_]] = []
        while True:
            left = np.count_nonzero(self.alive)
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
            gone = left - np.count_nonzero(self.alive)
            if gone <= PAYS * left:
                break
        # What was peeled off first from the far end comes last. Ranks in between follow.
        for layer in reversed(high):
            self.ranks[layer] = self.first + self.last
            self.last += 1
        ranks = self.ranks.ravel()
        self._cells = np.flatnonzero(self.alive.ravel())
        self._after = np.flatnonzero((ranks >= self.first) & (ranks != OUT))

    def table(self, middle: NDArray[np.int32]) -> bytes:
        """The ranks of all valuations, with those of the graph's cells given."""
        count = int(middle.max()) + 1 if len(middle) else 0
        ranks = self.ranks.astype("<u4").ravel()
        ranks[self._after] += np.uint32(count)
        ranks[self._cells] = middle + self.first
        return ranks.tobytes()
