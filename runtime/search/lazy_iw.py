"""Incremental IW(k) with lazy validation (paper, Optimizations).

Edges of the search graph are provisional: X is asked about an action only when it is part of
a potential subplan. An edge that fails is removed and the search goes on from where it was.
For this
 1. all discovered edges are kept, so a node can have several parents; the one nearest to the
    root acts as the parent,
 2. the atoms of every generated node are recorded, also those of pruned nodes,
 3. an atom is supported by one main node; later nodes with it are backup candidates,
 4. a node that is cut off from the root no longer supports its atoms; an atom without any
    supporter is new again, and
 5. a pruned node that is the next backup of such an atom is recovered.
"""

from __future__ import annotations

import heapq
from collections import defaultdict, deque
from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count

from runtime.search.novelty import new_tuples
from runtime.search.problem import Action, Motion, State
from runtime.search.query import Query


@dataclass(eq=False)
class Edge:
    """An action between two nodes; `motion` is None as long as it is provisional."""

    parent: LazyNode
    child: LazyNode
    action: Action
    motion: Motion = None


@dataclass(eq=False)
class LazyNode:
    """A state, the live edges that lead to it and away from it, and what became of it.

    `tree` is the last edge of a shortest known path from the root, `depth` its length.
    """

    state: State
    tuples: tuple[Hashable, ...]
    rule: str | None = None
    parents: list[Edge] = field(default_factory=list)
    children: list[Edge] = field(default_factory=list)
    tree: Edge | None = None
    depth: int = 0
    connected: bool = True
    queued: bool = False
    expanded: bool = False
    tried: set[Action] = field(default_factory=set)


class LazyIW:
    """One IW(k) search for a subgoal; `run` may find none."""

    def __init__(self, query: Query) -> None:
        self.guide = query.guide
        self.subproblem = query.subproblem
        self.execute = query.execute
        self.generate = query.generate
        self.before = query.before
        self.k = query.k
        self.limits = query.limits
        self.effort = query.effort
        start = query.start
        self.supporters: defaultdict[Hashable, list[LazyNode]] = defaultdict(list)
        self.queue: list[tuple[int, int, LazyNode]] = []
        # Subgoals that hang together with the root and have not been validated yet.
        self.candidates: deque[LazyNode] = deque()
        self.pushed = 0
        # What is true at the root is never new: the root cannot be cut off.
        self.first = self.guide.atoms(start)
        self.known = frozenset(self.first)
        self.root = LazyNode(start, ())
        self.nodes: dict[State, LazyNode] = {start: self.root}
        self._push(self.root)

    def run(self) -> tuple[list[Edge], str] | None:
        """A validated path of edges to a subgoal and the rule that it satisfies, or None.

        Raises:
            OutOfTimeError: when the limits say so.
        """
        while self.queue:
            _, _, node = heapq.heappop(self.queue)
            node.queued = False
            if not node.connected or node.expanded:
                continue
            node.expanded = True
            self.effort.expanded += 1
            for _ in self._expand(node):
                found = self._validate_candidates()
                if found is not None:
                    return found
                if self._is_cut_off(node):
                    # The rest of its children can wait until another edge leads to it.
                    node.expanded = False
                    break
        return None

    # -- the search graph ------------------------------------------------------------------

    def _expand(self, node: LazyNode) -> Iterator[None]:
        """Generate the children of a node; pauses whenever there are new candidates."""
        for action, state in self.subproblem.actions(node.state):
            if action in node.tried:
                continue
            node.tried.add(action)
            self.generate()
            child = self.nodes.get(state)
            known = child is not None
            if child is None:
                child = LazyNode(state, self._tuples(state), depth=node.depth + 1)
                child.rule = self.guide.fired(self.before, self.guide.values(state), state)
                self.nodes[state] = child
            edge = Edge(node, child, action)
            node.children.append(edge)
            child.parents.append(edge)
            if not known:
                child.tree = edge
                if self._support(child):
                    self._push(child)
                if child.rule is not None:
                    self.candidates.append(child)
            else:
                self._rejoin(edge)
            if self.candidates:
                yield

    def _push(self, node: LazyNode) -> None:
        if not node.queued and not node.expanded:
            node.queued = True
            self.pushed += 1
            heapq.heappush(self.queue, (node.depth, self.pushed, node))

    def _cut(self, edge: Edge) -> None:
        """Remove an edge whose action is not executable, and what hangs on it alone."""
        edge.parent.children.remove(edge)
        edge.child.parents.remove(edge)
        if edge.child.tree is not edge:
            return
        lost = self._subtree(edge.child)
        for node in lost:
            node.connected, node.tree = False, None
        self._attach(edge for node in lost for edge in node.parents)
        for node in lost:
            if not node.connected:
                for item in node.tuples:
                    self._recover(item)

    def _subtree(self, node: LazyNode) -> list[LazyNode]:
        """The nodes whose shortest known path from the root leads through a node."""
        found = [node]
        for known in found:
            found += [edge.child for edge in known.children if edge.child.tree is edge]
        return found

    def _attach(self, edges: Iterable[Edge]) -> list[LazyNode]:
        """Connect what some edges, and those that follow, connect to the root, by shortest
        paths (Dijkstra's algorithm; nodes that nothing changes for are not visited). Returns
        the nodes that were not connected before."""
        number = count()
        queue = [(e.parent.depth + 1, next(number), e) for e in edges if e.parent.connected]
        heapq.heapify(queue)
        joined = []
        while queue:
            depth, _, edge = heapq.heappop(queue)
            node = edge.child
            if node.connected and node.depth <= depth:
                continue
            if not node.connected:
                joined.append(node)
            node.connected, node.depth, node.tree = True, depth, edge
            for onwards in node.children:
                if not onwards.child.connected or onwards.child.depth > depth + 1:
                    heapq.heappush(queue, (depth + 1, next(number), onwards))
        return joined

    def _rejoin(self, edge: Edge) -> None:
        """Take a node that was cut off, and what hangs on it, into the search again."""
        for node in self._attach([edge]):
            if node.rule is not None:
                self.candidates.append(node)
            if self._is_main(node):
                self._push(node)

    # -- novelty -----------------------------------------------------------------------------

    def _tuples(self, state: State) -> tuple[Hashable, ...]:
        return new_tuples(self.guide.atoms(state), self.first, self.known, self.k)

    def _support(self, node: LazyNode) -> bool:
        """Record the atoms of a node; whether it is the main supporter of one of them."""
        novel = False
        for item in node.tuples:
            supporters = self.supporters[item]
            novel |= not any(other.connected for other in supporters)
            supporters.append(node)
        return novel

    @staticmethod
    def _is_cut_off(node: LazyNode) -> bool:
        return not node.connected

    def _is_main(self, node: LazyNode) -> bool:
        return any(self._main(item) is node for item in node.tuples)

    def _main(self, item: Hashable) -> LazyNode | None:
        return next((node for node in self.supporters[item] if node.connected), None)

    def _recover(self, item: Hashable) -> None:
        """Let the next backup candidate of an atom into the search."""
        backup = self._main(item)
        if backup is not None:
            self._push(backup)

    # -- validation ----------------------------------------------------------------------------

    def _validate_candidates(self) -> tuple[list[Edge], str] | None:
        while self.candidates:
            goal = self.candidates.popleft()
            path = self._validated_path(goal)
            if path is not None:
                assert goal.rule is not None
                return path, goal.rule
        return None

    def _validated_path(self, goal: LazyNode) -> list[Edge] | None:
        """Ask X about the actions on a shortest path to a node, again and again while some
        fail and there is another path."""
        while goal.connected:
            path = self._path(goal)
            for edge in path:
                if edge.motion is None:
                    self.limits.check()
                    edge.motion = self.execute(edge.parent.state, edge.action)
                    if edge.motion is None:
                        self._cut(edge)
                        break
            else:
                return path
        return None

    def _path(self, goal: LazyNode) -> list[Edge]:
        path: list[Edge] = []
        node = goal
        while node is not self.root:
            edge = min(
                (edge for edge in node.parents if edge.parent.connected),
                key=lambda edge: edge.parent.depth,
            )
            path.append(edge)
            node = edge.parent
        return path[::-1]
