"""Things that go over pegs: where they can be put, how they get there, and towers of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from domains.tabletop.actions.reach import grip_of
from domains.tabletop.features.functions import (
    arrangement,
    bars,
    bars_settling,
    goal_placements,
    next_to_settle,
    obstructions,
    settled,
)
from domains.tabletop.loads import load_of
from domains.tabletop.problem import TabletopProblem, load_problem
from domains.tabletop.sampling.samples import is_open
from domains.tabletop.state import TOP
from domains.tabletop.steps import beside_steps
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.domain import LoadOptions
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import write_scene

RADII = (0.026, 0.032, 0.038)
"""Of the rings, the uppermost first."""


def rings(folder, number: int, kept: bool = True) -> str:
    """The path of a scene with a tower of rings on the first of three pegs, wanted on the last."""
    text = (
        'robot_start = [-0.3, 0.0, 0.0]\n[[table]]\nname = "table"\nat = [0.6, 0.0]\n'
        "size = [0.7, 0.8]\ntop = 0.7\nthickness = 0.03\n"
    )
    for k, y in enumerate((0.16, 0.0, -0.16), 1):
        text += f'[[peg]]\nname = "p{k}"\nat = [0.75, {y}]\nradius = 0.008\nheight = 0.09\n'
    for n, radius in enumerate(RADII[:number], 1):
        trimesh.creation.annulus(0.013, radius, 0.025).export(folder / f"r{n}.stl")
        larger = [f"ring{m}" for m in range(n + 1, number + 1)]
        on, goal = (larger[0], larger[0]) if larger else ("p1", "p3")
        places = ", ".join(f'"{name}"' for name in ["p1", "p2", "p3", *larger])
        text += f'[[object]]\nname = "ring{n}"\nmesh = "r{n}.stl"\non = "{on}"\n'
        text += f"only_on = [{places}]\n" if kept else ""
        text += f'[[goal]]\nobject = "ring{n}"\non = "{goal}"\n'
    return str(write_scene(folder, text))


@pytest.fixture
def tower(tmp_path) -> TabletopProblem:
    return load_problem(rings(tmp_path, 3), LoadOptions())


def test_the_uppermost_can_be_taken_and_what_bears_it_cannot(tower) -> None:
    state = tower.initial
    assert [bars(state, i) for i in range(3)] == [0, 1, 3]
    assert obstructions(state, 0) == 0
    here = arrangement(state.world, state.placements)
    assert [here.can_be_taken(i) for i in range(3)] == [True, False, False]


def test_what_stands_around_a_hole_is_no_load(tower) -> None:
    state = tower.initial
    # Rings are flat: were they trays, the lowest one would be carried with all the others.
    assert [load_of(state.world, state.placements, i) for i in range(3)] == [(), (), ()]


def test_settled_is_what_is_in_place_with_all_below_it(tower) -> None:
    state, world = tower.initial, tower.world
    # The two upper ones are on what they are wanted on, but that is on the wrong peg.
    assert settled(state) == frozenset()
    assert next_to_settle(state) == {2}
    p3 = next(i for i, ground in enumerate(world.grounds) if ground.name == "p3")
    (there,) = goal_placements(state, 2)
    assert there.support == p3
    done = state.placed(2, there)
    assert settled(done) == {0, 1, 2}
    assert next_to_settle(done) == frozenset()
    apart = done.placed(0, there._replace(support=p3 - 1, y=0))
    assert settled(apart) == {1, 2}
    assert next_to_settle(apart) == {0}


def test_what_bars_the_next_to_settle_and_what_may_be_put_on_it(tower) -> None:
    state, world = tower.initial, tower.world
    assert world.may_bear == (0, 1, 2)
    assert [bars_settling(state, p, 2) for p in range(3)] == [True, True, False]
    # Only of the next one it is said.
    assert not any(bars_settling(state, p, o) for p in range(3) for o in (0, 1))
    support = {ground.name: i for i, ground in enumerate(world.grounds)}
    lowest = state.placements[2]
    at_goal = state.placed(0, lowest._replace(y=-16_000, support=support["p3"]))
    assert [bars_settling(at_goal, p, 2) for p in range(3)] == [True, True, False]
    free = at_goal.placed(1, lowest._replace(y=0, support=support["p2"]))
    free = free.placed(0, state.placements[0])
    assert not any(bars_settling(free, p, 2) for p in range(3))


def test_a_place_is_open_to_one_that_may_go_there(tower) -> None:
    state, world = tower.initial, tower.world
    support = {ground.name: i for i, ground in enumerate(world.grounds)}
    somewhere = state.placements[2]
    for name, index, wanted in (
        ("p2", 0, True),
        ("p1", 0, False),  # the tower is there
        ("ring2/ring", 0, False),  # it is there itself
        ("ring3/ring", 1, False),
        ("ring1/ring", 1, False),  # smaller
        ("table", 0, False),
    ):
        place = somewhere._replace(x=0, y=0, support=support[name])
        assert is_open(world, state, index, place) == wanted, name


def test_the_peg_that_comes_through_is_known_at_every_height(tower) -> None:
    world, state = tower.world, tower.initial
    for index, left in ((2, 0.088), (1, 0.061), (0, 0.034)):
        at = world.rests(state.placements, index)
        assert at is not None
        peg = world.peg_over(state.placements[index].support, at)
        assert peg is not None
        assert peg.height == pytest.approx(left, abs=1e-5)
    assert world.peg_over(state.placements[0].support, (0.5, 0.0, 0.7, 0.0)) is None


@pytest.mark.parametrize("seed", [0, 1])
def test_a_tower_is_moved_and_its_plan_certified(tmp_path, seed) -> None:
    path = rings(tmp_path, 2)
    task = open_task(load_sketch("towers").checked, path, seed)
    solution = task.solve(Limits(timeout=60))
    assert solution.solved
    assert solution.plan.validate().valid
    actions = solution.plan.plan.actions
    names = [a.arguments["support"] for a in actions if a.name == "place"]
    assert names[-1] == "ring2/ring"
    assert set(names) <= {"p1", "p2", "p3", "ring2/ring"}


def test_a_ring_goes_over_a_peg_with_the_usual_sketch(tmp_path) -> None:
    path = rings(tmp_path, 1, kept=False)
    solution = open_task(load_sketch("pick_and_place").checked, path, 0).solve(Limits(timeout=60))
    assert solution.solved
    assert solution.plan.validate().valid


def test_the_hand_draws_what_is_over_a_peg_off_it(tower) -> None:
    world, state = tower.world, tower.initial
    hold = world.items[0].holds(world.hand, TOP, np.zeros(1))
    assert hold is not None
    assert hold.fits[0]
    grasp = world.items[0].grasp(hold, 0, 0.0)
    grip = grip_of(world.items[0], world.hand, grasp)
    assert grip is not None
    peg = world.peg_over(state.placements[2].support, world.rests(state.placements, 2))
    for family in world.families:
        off = grip.off(peg, family)
        least = min(off.retreats) if family == TOP else 0.0
        assert off.lift + least > peg.height


def test_fingers_are_beside_a_step_where_there_is_one() -> None:
    def section(low: float, high: float):
        wide = 0.05 if low < 0.065 else 0.015
        turns = np.arange(24) * 2 * math.pi / 24
        return [wide * np.column_stack([np.cos(turns), np.sin(turns)])]

    for wanted in (0.06, 0.065, 0.07, 0.08):
        height = beside_steps(section, wanted, 0.01, 0.125)
        assert height + 0.01 <= 0.065 or height - 0.01 >= 0.065
        assert abs(height - wanted) <= abs(0.055 - wanted) + 0.002
        assert abs(height - wanted) <= abs(0.075 - wanted) + 0.002
    assert beside_steps(section, 0.1, 0.01, 0.125) == 0.1
