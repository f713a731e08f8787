"""Searches without a sketch's rules, on random graphs with an independent reference."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import networkx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.search.classical import ClassicalProblem
from runtime.search.guide import GOAL
from runtime.search.limits import Limits
from runtime.search.planners import PLANNERS
from runtime.search.problem import Rejection
from runtime.search.siw_r import End, Outcome
from sketchlang.compile import CompiledSketch
from sketchlang.model import Effect, Feature, Kind, Rule, SketchModel

BLIND = ("brfs", "bfws", "iw")
GRAPHS = st.dictionaries(st.integers(0, 12), st.lists(st.integers(0, 12), max_size=4))
END = 12


@dataclass
class Graph:
    """A problem whose states are numbers; X refuses some of its edges."""

    edges: dict[int, list[int]]
    refused: frozenset[tuple[int, int]] = frozenset()
    asked: list[tuple[int, int]] = field(default_factory=list)
    initial: int = 0

    def subproblem(self, state, attempt, rng) -> Graph:
        return self

    def actions(self, state: int) -> Iterator[tuple[tuple[int, int], int]]:
        return (((state, after), after) for after in self.edges.get(state, []))

    def execute(self, state: int, action: tuple[int, int]):
        assert action[0] == state
        self.asked.append(action)
        return Rejection("edge") if action in self.refused else ()


def sketch() -> CompiledSketch:
    """The goal is END, and every state is an atom of its own."""
    model = SketchModel("graph", (Feature("far", Kind.NAT),), (), {0: False})
    return CompiledSketch(model, lambda s: (END - s,), (lambda s: (s,),))


def solved(planner: str, problem: Graph, k_max: int = 1) -> Outcome:
    return PLANNERS[planner](sketch(), problem, Limits(k_max=k_max), np.random.default_rng(0))


@pytest.mark.parametrize("planner", BLIND)
@given(edges=GRAPHS, data=st.data())
def test_a_plan_is_found_exactly_where_there_is_a_way_that_x_allows(planner, edges, data) -> None:
    every = sorted({(a, b) for a, after in edges.items() for b in after})
    refused = frozenset(data.draw(st.sets(st.sampled_from(every)))) if every else frozenset()
    graph = networkx.DiGraph()
    graph.add_nodes_from(range(END + 1))
    graph.add_edges_from(set(every) - refused)
    problem = Graph(edges, refused)
    outcome = solved(planner, problem)
    assert outcome.solved == networkx.has_path(graph, 0, END)
    if not outcome.solved:
        assert outcome.end is End.NO_SUBGOAL
        return
    (subgoal,) = outcome.subgoals
    assert subgoal.rule == GOAL
    assert subgoal.states[-1] == END
    assert all(graph.has_edge(*action) for action in subgoal.actions)
    if planner != "bfws":  # those are breadth-first, and every state is an atom
        assert len(subgoal.actions) == networkx.shortest_path_length(graph, 0, END)


@pytest.mark.parametrize("planner", BLIND)
def test_what_x_refuses_once_is_reached_by_another_way(planner) -> None:
    problem = Graph({0: [END, 1], 1: [END]}, frozenset({(0, END)}))
    outcome = solved(planner, problem)
    assert [s.actions for s in outcome.subgoals] == [((0, 1), (1, END))]


class Grid:
    """Two numbers go up to `size`, one at a time; (size, size) is the goal."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.initial = (0, 0)

    def successors(self, state):
        for i in (0, 1):
            if state[i] < self.size:
                after = list(state)
                after[i] += 1
                yield i, tuple(after)


def on_grid(planner: str, size: int, k_max: int) -> Outcome:
    features = (Feature("open", Kind.NAT),)
    model = SketchModel("grid", features, (), {0: False})
    atoms = (lambda s: (("x", s[0]), ("y", s[1])),)
    of = CompiledSketch(model, lambda s: (2 * size - s[0] - s[1],), atoms)
    problem = ClassicalProblem(Grid(size))
    return PLANNERS[planner](of, problem, Limits(k_max=k_max), np.random.default_rng(0))


def test_iw_solves_what_its_width_allows_and_nothing_else() -> None:
    assert not on_grid("iw", 4, k_max=1).solved
    assert on_grid("iw", 4, k_max=2).solved


def test_best_first_search_goes_straight_where_every_step_closes_a_goal() -> None:
    size = 20
    best, blind = (on_grid(planner, size, k_max=2) for planner in ("bfws", "brfs"))
    assert best.solved
    assert blind.solved
    assert best.effort.expanded == 2 * size
    assert blind.effort.expanded > math.comb(size, 2)


@pytest.mark.parametrize("planner", BLIND)
def test_rules_of_the_sketch_make_no_difference(planner) -> None:
    plain = sketch()
    down = replace(plain, model=replace(plain.model, rules=(Rule("down", {}, {0: Effect.DEC}),)))
    edges = {0: [3, 4], 3: [5], 4: [END], 5: [END]}
    found = [
        PLANNERS[planner](of, Graph(edges), Limits(), np.random.default_rng(0)).subgoals
        for of in (plain, down)
    ]
    assert [[s.actions for s in subgoals] for subgoals in found] == [[((0, 4), (4, END))]] * 2


def test_what_has_lost_its_novelty_while_it_waited_comes_after_what_is_new() -> None:
    """1 and 2 have the same atom: once 1 is reached, 3 is new and 2 is not."""
    atom = {1: "a", 2: "a", 3: "b"}
    model = SketchModel("graph", (Feature("far", Kind.NAT),), (), {0: False})
    of = CompiledSketch(model, lambda s: (int(s != END),), (lambda s: (atom.get(s, s),),))
    problem = Graph({0: [1, 2, 3], 2: [END]})
    outcome = PLANNERS["bfws"](of, problem, Limits(k_max=1), np.random.default_rng(0))
    assert outcome.solved
    assert problem.asked == [(0, 1), (0, 3), (0, 2), (2, END)]


@pytest.mark.parametrize("planner", BLIND)
def test_no_number_of_refusals_ends_a_search(planner) -> None:
    refused = range(100, 400)
    problem = Graph({0: [*refused, 1], 1: [END]}, frozenset((0, state) for state in refused))
    assert solved(planner, problem).solved
    assert set(problem.asked) >= {(0, state) for state in refused}
