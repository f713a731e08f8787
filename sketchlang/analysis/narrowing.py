"""The part of a stuck component that matters: few rules among which Sieve is stuck all the same.

The fewer rules a proposed walk has, the clearer it says which feature to track, and the better a
cycle reads. What is stuck stays stuck when rules are added, so rules that cannot be left out now
cannot be left out later either, and whole groups may be tried at once (Junker, QuickXplain,
AAAI 2004).
"""

from __future__ import annotations

from collections.abc import Sequence

from sketchlang.analysis.bits import RuleBits
from sketchlang.analysis.components import strongly_connected
from sketchlang.analysis.elimination import drop
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.piece import Arc, Piece, WalkedGraph


class Narrowing:
    """A piece that becomes smaller and smaller while Sieve stays stuck in it.

    `graph` is that of the piece at the start; only its arcs are looked at anew.
    """

    def __init__(self, graph: WalkedGraph, piece: Piece, budget: Budget) -> None:
        self._graph = graph
        self._rules = {rule.index: rule for rule in piece.rules}
        self._arcs: Sequence[Arc] = graph.arcs
        self._budget = budget
        self.piece = piece

    def to_stuck(self, bounded: int) -> bool:
        """To a component inside that is stuck even if these features are bounded, if any is."""
        return self._narrowed(self._arcs, bounded)

    def to_few_rules(self, bounded: int) -> None:
        """To a component from which no rule can be left out."""
        self._leave_out(tuple(self.piece.rules), bounded, needed=True)

    def _leave_out(self, group: Sequence[RuleBits], bounded: int, needed: bool) -> bool:
        """Leaves out as many rules of a group as it can; whether all of them went at once.

        `needed` says that one of them at least is known to be needed.
        """
        present = {rule.index for rule in self.piece.rules}
        group = [rule for rule in group if rule.index in present]
        if not group:
            return True
        if not needed:
            gone = {rule.index for rule in group}
            if self._narrowed([arc for arc in self._arcs if arc[1] not in gone], bounded):
                return True
        if len(group) > 1:
            half = len(group) // 2
            all_gone = self._leave_out(group[:half], bounded, needed=False)
            self._leave_out(group[half:], bounded, needed=all_gone)
        return False

    def _narrowed(self, arcs: Sequence[Arc], bounded: int) -> bool:
        found = self._stuck(arcs, bounded)
        if found is None:
            return False
        self._arcs = found
        rules, cells = {arc[1] for arc in found}, {arc[0] for arc in found}
        if len(rules) < len(self.piece.rules) or len(cells) < len(self.piece.cells):
            self.piece = Piece(
                self.piece.tracked,
                tuple(self._graph.cells[i] for i in sorted(cells)),
                tuple(rule for rule in self.piece.rules if rule.index in rules),
            )
        return True

    def _stuck(self, arcs: Sequence[Arc], bounded: int) -> list[Arc] | None:
        """The arcs of a component that Sieve cannot take apart, of those that arcs make."""
        todo = [arcs]
        while todo:
            self._budget.check()
            for inside in reversed(self._components(todo.pop())):
                rules = [self._rules[index] for index in sorted({arc[1] for arc in inside})]
                step = drop(rules, bounded)
                if step is None:
                    return inside
                rest = [arc for arc in inside if arc[1] not in step.rules]
                if rest:
                    todo.append(rest)
        return None

    def _components(self, arcs: Sequence[Arc]) -> list[list[Arc]]:
        """The arcs of each component, sinks first."""
        graph = self._graph
        count = len(graph.cells)
        self._budget.spend(count + len(arcs))
        if count == 1:
            return [list(arcs)] if arcs else []
        targets: list[list[int]] = [[] for _ in range(count)]
        targets += graph.targets[count:]
        for cell, _, node in arcs:
            targets[cell].append(node)
        owner, components = strongly_connected(targets)
        inside: list[list[Arc]] = [[] for _ in range(components)]
        for arc in arcs:
            if owner[arc[0]] == owner[arc[2]]:
                inside[owner[arc[0]]].append(arc)
        return [found for found in inside if found]
