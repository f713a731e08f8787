"""Lazy IW on random graphs in which some edges turn out not to be executable."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable
from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from runtime.search.iw import iw
from runtime.search.lazy_iw import Edge, LazyIW
from runtime.search.limits import Limits
from runtime.search.query import Query

GOALS = "subgoal"


class Graph:
    """States 0..n-1; some edges cannot be executed; every state has atoms of its own."""

    def __init__(self, seed: int, size: int, atoms_each: int) -> None:
        rng = np.random.default_rng(seed)
        self.size = size
        self.edges = {
            a: [int(b) for b in rng.permutation(size)[: rng.integers(1, 5)]] for a in range(size)
        }
        self.barred = {
            (a, b) for a, targets in self.edges.items() for b in targets if rng.random() < 0.4
        }
        self.goals = {int(g) for g in rng.permutation(size)[:2]} - {0}
        self.labels = {
            a: tuple(int(x) for x in rng.integers(0, size, atoms_each)) for a in range(size)
        }
        self.asked: list[tuple[int, int]] = []

    # The subproblem.

    def actions(self, state: int) -> list[tuple[int, int]]:
        return [(target, target) for target in self.edges[state]]

    def execute(self, state: int, action: int) -> Any:
        self.asked.append((state, action))
        return None if (state, action) in self.barred else ("motion", state, action)

    def reachable(self) -> set[int]:
        """States that executable edges lead to."""
        seen, queue = {0}, deque([0])
        while queue:
            a = queue.popleft()
            for b in self.edges[a]:
                if (a, b) not in self.barred and b not in seen:
                    seen.add(b)
                    queue.append(b)
        return seen


class Guide:
    """Stands for a sketch: the goals of the graph are the subgoals."""

    def __init__(self, graph: Graph, own_atoms: bool) -> None:
        self.graph = graph
        self.own_atoms = own_atoms
        self.hopeful = False

    def atoms(self, state: int) -> tuple[Hashable, ...]:
        if self.own_atoms:
            return (("at", state),)
        return tuple(enumerate(self.graph.labels[state]))

    def values(self, state: int) -> tuple[int, ...]:
        return (int(state in self.graph.goals),)

    def fired(self, before: tuple[int, ...], after: tuple[int, ...], state: object) -> str | None:
        return GOALS if after[0] else None


def lazy(graph: Graph, own_atoms: bool, k: int = 1) -> Any:
    guide: Any = Guide(graph, own_atoms)
    return LazyIW(Query(guide, graph, 0, (0,), k, Limits())).run()


@settings(max_examples=300)
@given(st.integers(0, 10**6), st.integers(3, 25))
def test_a_path_is_found_exactly_if_executable_edges_lead_to_a_subgoal(seed, size) -> None:
    graph = Graph(seed, size, 2)
    found = lazy(graph, own_atoms=True)
    assert (found is not None) == bool(graph.reachable() & graph.goals)
    guide: Any = Guide(graph, True)
    eager = iw(Query(guide, graph, 0, (0,), 1, Limits()))
    assert (eager is not None) == (found is not None)


@settings(max_examples=300)
@given(st.integers(0, 10**6), st.integers(3, 25), st.booleans(), st.integers(1, 2))
def test_paths_are_connected_and_executable(seed, size, own_atoms, k) -> None:
    graph = Graph(seed, size, 2)
    found = lazy(graph, own_atoms, k)
    if found is None:
        return
    edges, rule = found
    assert rule == GOALS
    state = 0
    for edge in edges:
        assert edge.parent.state == state
        assert (state, edge.action) not in graph.barred
        assert edge.motion == ("motion", state, edge.action)
        state = edge.child.state
    assert state in graph.goals


@settings(max_examples=200)
@given(st.integers(0, 10**6), st.integers(3, 25), st.booleans())
def test_no_edge_is_validated_twice(seed, size, own_atoms) -> None:
    graph = Graph(seed, size, 2)
    lazy(graph, own_atoms)
    assert len(graph.asked) == len(set(graph.asked))


def test_a_pruned_node_is_recovered_when_its_atom_loses_its_supporter() -> None:
    """1 and 2 make the same atom true; 1 comes first, turns out unreachable, and only 2
    leads on to the subgoal."""
    graph = Graph(0, 4, 1)
    graph.edges = {0: [1, 2], 1: [3], 2: [3], 3: []}
    graph.labels = {0: (0,), 1: (7,), 2: (7,), 3: (9,)}
    graph.barred = {(0, 1)}
    graph.goals = {3}
    found = lazy(graph, own_atoms=False)
    assert found is not None
    assert [edge.child.state for edge in found[0]] == [2, 3]


class Checked(LazyIW):
    """Compares what is kept up to date with a plain breadth-first search after every cut."""

    cuts = 0

    def _cut(self, edge: Edge) -> None:
        super()._cut(edge)
        Checked.cuts += 1
        depth, queue = {self.root: 0}, deque([self.root])
        while queue:
            node = queue.popleft()
            for onwards in node.children:
                if onwards.child not in depth:
                    depth[onwards.child] = depth[node] + 1
                    queue.append(onwards.child)
        for node in self.nodes.values():
            assert node.connected == (node in depth)
            if node.connected and node is not self.root:
                assert node.depth == depth[node]
                assert node.tree in node.parents
                assert node.tree is not None
                assert node.tree.parent.depth == node.depth - 1
            supports = any(self._main(item) is node for item in node.tuples)
            if node.connected and supports:
                assert node.expanded or node.queued


@settings(max_examples=300)
@given(st.integers(0, 10**6), st.integers(3, 25), st.booleans())
def test_after_every_cut_the_graph_is_as_if_searched_anew(seed, size, own_atoms) -> None:
    graph = Graph(seed, size, 2)
    graph.barred |= {(a, b) for a in range(size) for b in graph.edges[a] if (a + b) % 3 == 0}
    guide: Any = Guide(graph, own_atoms)
    Checked(Query(guide, graph, 0, (0,), 1, Limits())).run()


def test_the_check_has_seen_cuts() -> None:
    before = Checked.cuts
    test_after_every_cut_the_graph_is_as_if_searched_anew()
    assert Checked.cuts > before + 100
