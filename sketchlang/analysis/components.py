"""Strongly connected components of a piece of the policy graph."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from sketchlang.analysis.bits import RuleBits
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.piece import PieceGraph

CELL_MB = 0.0004
"""What a cell takes at least, with its edges, while components are found (measured)."""


@dataclass(frozen=True, slots=True)
class Component:
    """Cells that reach each other, and the rules with an edge among them.

    `rules` is empty for a cell that no rule leads back to. `level` is the length of the
    longest path of components that ends here, so edges between components go up.
    """

    cells: tuple[int, ...]
    rules: tuple[int, ...]
    level: int


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
