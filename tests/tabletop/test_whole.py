"""Samples for a whole problem: every object can be taken, places are free, plans are certified."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from domains.tabletop.problem import TabletopProblem
from domains.tabletop.sampling.whole import sample_whole, unoccupied
from domains.tabletop.state import Grasp, Placement
from runtime.search.limits import Limits
from runtime.search.planners import PLANNERS
from runtime.search.whole import Counting, Whole
from sketchlang.compile import compile_sketch
from sketchlang.loader import load_sketch
from tests.tabletop.tasks import AT, ON_RIGHT, problem, stick

BLIND = ("bfws", "brfs")


@pytest.fixture
def two(tmp_path: Path) -> TabletopProblem:
    """Two sticks, one behind the other; the far one goes to the other table."""
    return problem(
        tmp_path, stick("near", 0.7, 0.4), stick("far", 0.7, 0.75), ON_RIGHT.format("far")
    )


def test_every_object_has_grasps_and_every_goal_has_places(tmp_path) -> None:
    places = [(0.75, 0.55), (0.82, 0.62), (0.7, 0.7), (0.9, 0.5), (0.8, 0.75)]
    entries = [stick(f"o{i}", x, y) for i, (x, y) in enumerate(places)]
    the = problem(tmp_path, *entries, ON_RIGHT.format("o2"), AT.format("o1", 0.9, -0.8))
    samples = sample_whole(the.sampler, the.initial, 0, np.random.default_rng(0))
    assert [index for index, _ in samples.picks] == [0, 1, 2, 3, 4]
    right = {ground.name: i for i, ground in enumerate(the.world.grounds)}["right"]
    goal = Placement.of(0.9, -0.8, 0.0, right)[:2]
    assert any(p[:2] == goal for p in samples.places)
    assert {right} < {p.support for p in samples.places}
    more = sample_whole(the.sampler, the.initial, 2, np.random.default_rng(0))
    assert len(more.places) > len(samples.places)
    assert len(more.bases) > len(samples.bases)


def test_places_that_something_stands_on_are_left_out(two) -> None:
    state, world = two.initial, two.world
    taken, other = state.placements
    assert taken is not None
    assert other is not None
    x, y, _ = taken.pose
    free = Placement.of(x + 0.3, y, 0.0, taken.support)
    held = replace(state, placements=(None, other), held=0, grasp=None)
    assert unoccupied(world, held, 0, [other, free, taken]) == [free, taken]


def test_a_tabletop_problem_is_offered_as_a_whole(two) -> None:
    assert isinstance(two, Whole)
    assert isinstance(two, Counting)
    assert two.counters(two.initial)[0] == 1
    far = two.initial.placements[1]
    done = two.initial.placed(1, Placement.of(0.9, -0.9, 0.0, 1 - far.support))
    assert two.counters(done) == (0, 0)
    grasp = Grasp.of(0.0, 0.1)
    assert two.counters(two.initial.picked(1, grasp))[0] == 1
    assert two.counters(done.picked(0, grasp))[0] == 1


@pytest.mark.parametrize("planner", BLIND)
def test_blind_plans_are_one_subplan_and_certified(planner, two) -> None:
    checked = load_sketch("pick_and_place").checked
    outcome = PLANNERS[planner](
        compile_sketch(checked), two, Limits(timeout=60.0), np.random.default_rng(0)
    )
    assert outcome.solved
    assert [s.rule for s in outcome.subgoals] == ["goal"]
    plan = two.reporting.document(checked.model, outcome, planner, 0)
    verdict = plan.validate()
    assert verdict.valid, [finding.message for finding in verdict.findings]
