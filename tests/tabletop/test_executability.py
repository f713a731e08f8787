"""X answers a question once, and again as soon as something in reach has moved."""

from __future__ import annotations

import math

import numpy as np
import pytest

from domains.tabletop.actions.actions import Pick, Place
from domains.tabletop.actions.reach import Reach
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.state import BasePose, Grasp, Placement, State
from tests.tabletop.tasks import ON_RIGHT, stick, task

HERE = BasePose.of(-0.05, 0.6, 0.0)
PICK = Pick(0, Grasp.of(0.0, 0.12))


@pytest.fixture
def problem(tmp_path) -> TabletopProblem:
    sticks = [stick("a", 0.65, 0.6), stick("b", 0.8, 0.75), stick("far", 0.8, -1.0)]
    return TabletopProblem(task(tmp_path, *sticks, ON_RIGHT.format("a")), 0)


def standing(problem: TabletopProblem, index: int, x: float, y: float, surface: int) -> State:
    """The initial state seen from HERE, with one object elsewhere."""
    placements = list(problem.initial.placements)
    placements[index] = Placement.of(x, y, 0.0, surface)
    return State(HERE, tuple(placements), task=problem.world)


def asked(problem: TabletopProblem, monkeypatch) -> list[int]:
    """Grows by one with each inverse kinematics that is really computed."""
    computed: list[int] = []
    solve = problem.executor.solver.solve

    def counting(*arguments) -> Reach | None:
        computed.append(1)
        return solve(*arguments)

    monkeypatch.setattr(problem.executor.solver, "solve", counting)
    return computed


def test_the_same_question_is_computed_once(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    state = standing(problem, 1, 0.8, 0.75, 0)
    reach = problem.executor.inverse_kinematics(state, PICK, 12)
    assert reach is not None
    motion = problem.executor.motion_plan(state, PICK, reach)
    assert motion is not None
    again = standing(problem, 1, 0.8, 0.75, 0)
    assert problem.executor.inverse_kinematics(again, PICK, 12) is reach
    assert problem.executor.motion_plan(again, PICK, reach) is motion
    assert len(computed) == 1


def test_what_is_out_of_reach_does_not_matter(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    for x in (0.75, 0.85):
        problem.executor.inverse_kinematics(standing(problem, 2, x, -1.0, 1), PICK, 12)
    assert len(computed) == 1


def test_something_that_moves_within_reach_asks_anew(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    beside = problem.executor.inverse_kinematics(standing(problem, 1, 0.8, 0.75, 0), PICK, 12)
    barring = problem.executor.inverse_kinematics(standing(problem, 1, 0.6, 0.6, 0), PICK, 12)
    assert len(computed) == 2
    assert beside is not None
    assert barring is None


def test_picking_up_and_putting_back_are_different_motions(problem) -> None:
    state = standing(problem, 1, 0.8, 0.75, 0)
    placement = state.placements[0]
    assert placement is not None
    reach = problem.executor.inverse_kinematics(state, PICK, 12)
    assert reach is not None
    pick = problem.executor.motion_plan(state, PICK, reach)
    held = state.after(PICK)
    back = Place(0, placement)
    assert problem.executor.inverse_kinematics(held, back, 12) is reach
    place = problem.executor.motion_plan(held, back, reach)
    assert pick is not None
    assert place is not None
    assert len(pick) != len(place)


def test_forgotten_answers_are_computed_again(problem, monkeypatch) -> None:
    monkeypatch.setattr("domains.tabletop.actions.executability.REMEMBERED", 2)
    computed = asked(problem, monkeypatch)
    state = standing(problem, 1, 0.8, 0.75, 0)
    grasps = [Pick(0, Grasp.of(math.pi / 2 * k, 0.12)) for k in range(3)]
    first = [problem.executor.inverse_kinematics(state, pick, 12) for pick in grasps]
    second = [problem.executor.inverse_kinematics(state, pick, 12) for pick in grasps]
    assert len(computed) == 6
    for one, other in zip(first, second, strict=True):
        assert (one is None) == (other is None)
        if one is not None and other is not None:
            assert np.array_equal(one.approach, other.approach)
