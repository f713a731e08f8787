"""X answers a question once, and again as soon as something in reach has moved."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from domains.tabletop.actions.actions import Pick, Place
from domains.tabletop.actions.executability import FURTHER, SEARCHED, seeds_at
from domains.tabletop.actions.reach import ANOTHER, Reach
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.state import BasePose, Grasp, Placement, State
from runtime.motion import rrt
from runtime.motion.motion import Motion
from runtime.search.problem import Rejection
from tests.tabletop.tasks import ON_RIGHT, stick, task

HERE = BasePose.of(-0.1, 0.6, 0.0)
PICK = Pick(0, Grasp.of(0.0, 0.12))
SEEDS = 12


@pytest.fixture
def problem(tmp_path) -> TabletopProblem:
    sticks = [stick("a", 0.65, 0.6), stick("b", 0.8, 0.75), stick("far", 0.8, -1.0)]
    return TabletopProblem(task(tmp_path, *sticks, ON_RIGHT.format("a")), 5)


def standing(problem: TabletopProblem, index: int, x: float, y: float, support: int) -> State:
    """The initial state seen from HERE, with one object elsewhere."""
    placements = list(problem.initial.placements)
    placements[index] = Placement.of(x, y, 0.0, support)
    return State(HERE, tuple(placements), world=problem.world)


def asked(problem: TabletopProblem, monkeypatch) -> list[int]:
    """Grows by one with each inverse kinematics that is really computed."""
    computed: list[int] = []
    reaches = problem.executor.solver.reaches

    def counting(*arguments) -> Iterator[Reach]:
        computed.append(1)
        return reaches(*arguments)

    monkeypatch.setattr(problem.executor.solver, "reaches", counting)
    return computed


def motion_of(problem: TabletopProblem, state: State, action: Pick | Place) -> Motion | Rejection:
    return action.motion(problem.executor, state, SEEDS)


def test_the_same_question_is_computed_once(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    motion = motion_of(problem, standing(problem, 1, 0.8, 0.75, 0), PICK)
    assert not isinstance(motion, Rejection)
    assert motion_of(problem, standing(problem, 1, 0.8, 0.75, 0), PICK) is motion
    assert len(computed) == 1


def test_what_is_out_of_reach_does_not_matter(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    for x in (0.75, 0.85):
        motion_of(problem, standing(problem, 2, x, -1.0, 1), PICK)
    assert len(computed) == 1


def test_something_that_moves_within_reach_asks_anew(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    beside = motion_of(problem, standing(problem, 1, 0.8, 0.75, 0), PICK)
    barring = motion_of(problem, standing(problem, 1, 0.6, 0.6, 0), PICK)
    assert len(computed) == 2
    assert not isinstance(beside, Rejection)
    assert barring == Rejection("inverse_kinematics", "a")


def test_something_that_turns_within_reach_asks_anew(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    for yaw in (0.0, 0.4):
        placements = list(problem.initial.placements)
        placements[1] = Placement.of(0.8, 0.75, yaw, 0)
        motion_of(problem, State(HERE, tuple(placements), world=problem.world), PICK)
    assert len(computed) == 2


def test_picking_up_and_putting_back_are_different_motions(problem, monkeypatch) -> None:
    computed = asked(problem, monkeypatch)
    state = standing(problem, 1, 0.8, 0.75, 0)
    placement = state.placements[0]
    assert placement is not None
    pick = motion_of(problem, state, PICK)
    place = motion_of(problem, PICK.after(state), Place(0, placement))
    assert len(computed) == 1, "both are along the same lines"
    assert not isinstance(pick, Rejection)
    assert not isinstance(place, Rejection)
    assert len(pick) != len(place)


def test_forgotten_answers_are_computed_again(problem, monkeypatch) -> None:
    monkeypatch.setattr("domains.tabletop.actions.executability.REMEMBERED", 2)
    computed = asked(problem, monkeypatch)
    state = standing(problem, 1, 0.8, 0.75, 0)
    grasps = [Pick(0, Grasp.of(math.pi / 2 * k, 0.12)) for k in range(3)]
    first = [motion_of(problem, state, pick) for pick in grasps]
    second = [motion_of(problem, state, pick) for pick in grasps]
    assert len(computed) == 6
    for one, other in zip(first, second, strict=True):
        assert isinstance(one, Rejection) == isinstance(other, Rejection)
        if isinstance(one, Rejection):
            assert one == other
        else:
            assert [type(piece) for piece in one] == [type(piece) for piece in other]
            assert np.array_equal(one[2].path, other[2].path)


# -- further postures --------------------------------------------------------------------------


def barred(problem: TabletopProblem, monkeypatch, number: int) -> list[np.ndarray]:
    """Bars the way from home to the first few postures; grows by each posture at a grasp to which
    a way is asked for."""
    asked_for: list[np.ndarray] = []
    motion = problem.executor._motion

    def barring(asked, reach, picks, checks):
        asked_for.append(reach.approach[-1])
        if len(asked_for) <= number:
            return Rejection("motion_plan", "a")
        return motion(asked, reach, picks, checks)

    monkeypatch.setattr(problem.executor, "_motion", barring)
    return asked_for


@pytest.mark.parametrize("number", [1, 2])
def test_where_a_posture_has_no_free_way_home_another_is_tried(
    problem, monkeypatch, number
) -> None:
    tried = barred(problem, monkeypatch, number)
    state = standing(problem, 1, 0.8, 0.75, 0)
    motion = problem.executor.manipulate(state, 0, state.placements[0], PICK.grasp, True, 60)
    assert not isinstance(motion, Rejection)
    assert number < len(tried) <= 1 + FURTHER
    for i, one in enumerate(tried):
        assert all(np.abs(one - other).max() >= ANOTHER for other in tried[:i])
    assert np.array_equal(motion[2].path[-1], tried[-1])


def test_the_tries_end_and_are_remembered(problem, monkeypatch) -> None:
    tried = barred(problem, monkeypatch, 1000)
    state = standing(problem, 1, 0.8, 0.75, 0)
    for _ in range(2):
        motion = problem.executor.manipulate(state, 0, state.placements[0], PICK.grasp, True, 60)
        assert motion == Rejection("motion_plan", "a")
        assert len(tried) == 1 + FURTHER + SEARCHED


def test_a_first_attempt_searches_for_no_way(problem, monkeypatch) -> None:
    """Where no posture has a simple way; later attempts do search."""
    searches: list[int] = []

    def searched(*arguments) -> None:
        searches.append(arguments[5])

    monkeypatch.setattr(rrt, "simple", lambda *arguments: None)
    monkeypatch.setattr(rrt, "rrt_connect", searched)
    state = standing(problem, 1, 0.8, 0.75, 0)
    assert isinstance(PICK.motion(problem.executor, state, seeds_at(0)), Rejection)
    assert not searches
    assert isinstance(PICK.motion(problem.executor, state, seeds_at(1)), Rejection)
    assert searches
    assert min(searches) > 0
