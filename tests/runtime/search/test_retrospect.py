"""What a failed search came near to, on random graphs, against every path of the graph."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from runtime.search.guide import Guide
from runtime.search.retrospect import ALIKE, look_back
from sketchlang.compile import CompiledSketch
from sketchlang.model import Effect, Feature, Kind, Rule, SketchModel
from tests.runtime.search.test_whole import GRAPHS, Graph

NEAR = 4
"""States from which on something is nearer."""


def sketch() -> CompiledSketch:
    """A rule that asks to come nearer, as half of the states do, and every state an atom."""
    rule = Rule("nearer", {0: True}, {0: Effect.DEC})
    model = SketchModel("graph", (Feature("far", Kind.NAT),), (rule,), None)
    return CompiledSketch(model, lambda s: (1 + (s < NEAR),), (lambda s: (s,),))


def shortest_paths(graph: Graph) -> dict[int, list[tuple[int, int]]]:
    """The edges to every state, breadth first."""
    paths: dict[int, list[tuple[int, int]]] = {0: []}
    queue = [0]
    for state in queue:
        for edge, after in graph.actions(state):
            if after not in paths:
                paths[after] = [*paths[state], edge]
                queue.append(after)
    return paths


@given(GRAPHS, st.randoms(use_true_random=False))
def test_a_subgoal_that_x_allows_is_told_before_those_that_it_refuses(edges, rng) -> None:
    """X refuses half of the edges."""
    all_edges = [(a, b) for a, targets in edges.items() for b in targets]
    refused = frozenset(edge for edge in all_edges if rng.random() < 0.5)
    graph = Graph(edges, refused)
    guide = Guide(sketch())
    found = look_back(guide, [graph], 0, guide.values(0)).subgoals
    paths = [path for state, path in shortest_paths(graph).items() if state >= NEAR]
    assert [one.rule for one in found] == ["nearer"] * bool(paths)
    for one in found:
        assert list(one.actions) in paths
        assert (one.refusal is None) == refused.isdisjoint(one.actions)
        alike = paths[:ALIKE]
        assert (one.refusal is None) == any(refused.isdisjoint(path) for path in alike)
