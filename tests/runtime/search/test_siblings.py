"""IW(k) tests novelty again among siblings: the first that is executable takes the atom."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from runtime.search.iw import iw
from runtime.search.limits import Limits
from runtime.search.problem import Rejection
from runtime.search.query import Effort, Query
from runtime.search.siw_r import eager, find_subgoal


class Twins:
    """Two actions that make the same atom true, and a goal that is never reached."""

    def __init__(self) -> None:
        self.executed: list[str] = []

    def actions(self, state: str) -> list[tuple[str, str]]:
        return [("first", "one"), ("second", "two")] if state == "start" else []

    def execute(self, state: str, action: str) -> str:
        self.executed.append(action)
        return action


def test_a_sibling_with_nothing_new_is_not_even_executed() -> None:
    guide = SimpleNamespace(
        atoms=lambda state: ("start",) if state == "start" else ("same",),
        values=lambda state: (0,),
        fired=lambda *_: None,
        hopeful=False,
    )
    twins = Twins()
    query = Query(guide, twins, "start", (0,), 1, Limits())
    assert iw(query) is None
    assert twins.executed == ["first"]
    assert query.effort.expanded == 2


class Refusing(Twins):
    """Many actions that all seem to reach the goal, and X refuses each."""

    def actions(self, state: str) -> list[tuple[str, str]]:
        return [(f"try{i}", f"state{i}") for i in range(100)] if state == "start" else []

    def execute(self, state: str, action: str) -> Rejection:
        self.executed.append(action)
        return Rejection("step")


def drawing(drawn: list[Refusing], hopeful: bool) -> tuple[SimpleNamespace, SimpleNamespace]:
    """A guide to whom every other state is a subgoal, and a problem that is drawn anew."""

    def subproblem(state: str, attempt: int, rng: object) -> Refusing:
        drawn.append(Refusing())
        return drawn[-1]

    guide = SimpleNamespace(
        atoms=lambda state: (state,),
        values=lambda state: (int(state != "start"),),
        fired=lambda before, after, state: "rule" if after == (1,) else None,
        usable=lambda values: [0],
        model=SimpleNamespace(rules=("rule",)),
        hopeful=hopeful,
    )
    return guide, SimpleNamespace(subproblem=subproblem)


def test_an_attempt_ends_where_x_refuses_too_much_and_the_next_one_is_drawn_anew() -> None:
    drawn: list[Refusing] = []
    guide, problem = drawing(drawn, True)
    limits = Limits(attempts=3, k_max=1, refusals=7, rejections=1000)
    rejections: list[Rejection] = []
    rng = np.random.default_rng(0)
    found = find_subgoal(eager, guide, problem, "start", limits, rng, Effort(), rejections)
    assert found is None
    assert [len(one.executed) for one in drawn] == [7, 7, 7]
    limits = Limits(attempts=3, k_max=1, refusals=7, rejections=10)
    drawn.clear()
    assert find_subgoal(eager, guide, problem, "start", limits, rng, Effort(), []) is None
    assert [len(one.executed) for one in drawn] == [7, 3]


def test_what_attempts_generate_counts_together() -> None:
    """Each attempt could generate 100 nodes; fewer are borne where none was a subgoal."""
    for hopeful, most in ((True, 250), (False, 130)):
        drawn: list[Refusing] = []
        guide, problem = drawing(drawn, hopeful)
        limits = Limits(attempts=5, k_max=1, refusals=7, generated=250, blind=130)
        effort, rng = Effort(), np.random.default_rng(0)
        assert find_subgoal(eager, guide, problem, "start", limits, rng, effort, []) is None
        assert effort.generated == most + 1
        assert len(drawn) == most // 100 + 1
