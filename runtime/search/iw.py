"""IW(k): breadth-first search that drops states with nothing new (paper, Width).

A newly generated state is pruned if no tuple of at most k of its atoms is true for the first
time in the search. A subgoal that is found is a closest one among the states kept.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable
from dataclasses import dataclass

from runtime.search.novelty import NoveltyTable
from runtime.search.problem import Action, Motion, State
from runtime.search.query import Query


@dataclass(eq=False)
class Node:
    """A state in the search tree and how it was reached."""

    state: State
    parent: Node | None = None
    action: Action = None
    motion: Motion = None

    def path(self) -> list[Node]:
        """The nodes from the root to this one, the root left out."""
        nodes: list[Node] = []
        node: Node | None = self
        while node is not None and node.parent is not None:
            nodes.append(node)
            node = node.parent
        return nodes[::-1]


def iw(query: Query) -> tuple[Node, str] | None:
    """A node whose state is a subgoal of the start, and the rule it satisfies, or None.

    Every edge of the tree is executable: its motion is planned before the child is kept.
    Children that would be subgoals are tried first, since one of them ends the search.

    Raises:
        OutOfTimeError: when the limits say so.
    """
    guide, subproblem, limits, effort = query.guide, query.subproblem, query.limits, query.effort
    root = Node(query.start)
    table = NoveltyTable(query.k)
    table.add(guide.atoms(query.start))
    queue = deque([root])
    while queue:
        node = queue.popleft()
        effort.expanded += 1
        candidates: list[tuple[bool, int, Action, State, tuple[Hashable, ...], str | None]] = []
        for action, state in subproblem.actions(node.state):
            query.generate()
            atoms = guide.atoms(state)
            if table.is_novel(atoms):
                rule = guide.fired(query.before, guide.values(state), state)
                candidates.append((rule is None, len(candidates), action, state, atoms, rule))
        candidates.sort(key=lambda candidate: candidate[:2])
        for _, _, action, state, atoms, rule in candidates:
            limits.check()
            # A sibling may have made the same atoms true meanwhile.
            if not table.is_novel(atoms):
                continue
            motion = query.execute(node.state, action)
            if motion is None:
                continue
            child = Node(state, node, action, motion)
            if rule is not None:
                return child, rule
            table.add(atoms)
            queue.append(child)
    return None
