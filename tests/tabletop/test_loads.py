"""Trays: how they are taken by their rim, and when what stands on them is carried along."""

from __future__ import annotations

import math

import numpy as np
import pytest

from domains.tabletop.features.functions import arrangement, obstructions
from domains.tabletop.loads import load_of, tall
from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import TOP, Grasp
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import write_scene

SIZE, WALL = (0.3, 0.22, 0.04), 0.006

TABLES = """robot_start = [0.0, 0.0, 0.0]
[[table]]
name = "table"
at = [1.2, 0.0]
size = [0.8, 1.2]
top = 0.7
[[table]]
name = "other"
at = [-1.3, 0.3]
size = [0.8, 1.2]
top = 0.75
[[object]]
name = "tray"
shape = "tray"
size = [0.3, 0.22, 0.04]
wall = 0.006
at = [1.15, 0.1]
yaw = 20
on = "table"
[[goal]]
object = "tray"
on = "other"
"""


def on_tray(name: str, size: str, x: float) -> str:
    c, s = math.cos(math.radians(20)), math.sin(math.radians(20))
    place = f"[{1.15 + c * x:.4f}, {0.1 + s * x:.4f}]"
    return f'[[object]]\nname = "{name}"\nsize = {size}\nat = {place}\non = "tray"\nyaw = 20\n'


CUBES = "".join(
    on_tray(n, "[0.05, 0.05, 0.05]", x) for n, x in zip("abc", (-0.09, 0.0, 0.09), strict=True)
)


@pytest.fixture(scope="module")
def robot():
    return load_robot("franka_mobile")


def made(tmp_path, robot, more: str) -> TabletopWorld:
    return TabletopWorld.of(load_scene(write_scene(tmp_path, TABLES + more)), robot)


def test_a_tray_is_taken_by_the_middle_of_a_wall(tmp_path, robot) -> None:
    world = made(tmp_path, robot, "")
    item, hand = world.items[0], world.hand
    hold = item.holds(hand, TOP, np.array([0.0, math.pi / 2, math.pi, 0.4]))
    assert hold is not None
    assert hold.fits.tolist() == [True, True, True, False]
    assert np.allclose(hold.width[:3], WALL)
    assert np.allclose(hold.aside[:3], [(SIZE[k] - WALL) / 2 for k in (1, 0, 1)])
    assert np.allclose(hold.along[:3], 0.0)
    # The tips are above its floor, the palm above its walls.
    assert hold.height - hand.tip >= WALL
    assert hold.height + hand.back >= SIZE[2]
    grasp = item.grasp(hold, 1, math.pi / 2)
    assert item.width(hand, grasp) == pytest.approx(WALL, abs=1e-4)


def test_what_stands_in_it_is_carried_along(tmp_path, robot) -> None:
    world = made(tmp_path, robot, CUBES)
    state = world.initial
    assert load_of(world, state.placements, 0) == (1, 2, 3)
    assert tall(world, state.placements, 0) == pytest.approx(WALL + 0.002 + 0.05)
    here = arrangement(world, state.placements)
    assert here.can_be_taken(0)
    assert obstructions(state, 0) == 0


def test_what_could_fall_over_has_to_be_taken_off_first(tmp_path, robot) -> None:
    world = made(tmp_path, robot, on_tray("stick", "[0.04, 0.04, 0.15]", 0.0))
    state = world.initial
    assert load_of(world, state.placements, 0) == ()
    assert not arrangement(world, state.placements).can_be_taken(0)
    assert obstructions(state, 0) == 1


def test_a_cube_in_the_way_of_the_fingers_bars_that_wall_only(tmp_path, robot) -> None:
    near = made(tmp_path, robot, on_tray("a", "[0.05, 0.05, 0.05]", 0.115))
    picks = arrangement(near, near.initial.placements).picks[TOP]
    free = [k for k in range(24) if picks.counts[0, k] == 0]
    bare = made(tmp_path, robot, "")
    all_ways = arrangement(bare, bare.initial.placements).picks[TOP]
    before = [k for k in range(24) if all_ways.counts[0, k] == 0]
    assert free
    assert set(free) < set(before)


def test_a_cube_in_the_hand_is_no_load(tmp_path, robot) -> None:
    world = made(tmp_path, robot, CUBES)
    held = world.initial.picked(1, Grasp.of(0.0, 0.03))
    assert load_of(world, held.placements, 0) == (2, 3)


@pytest.mark.parametrize("name", ["tiago", "franka_mobile"])
def test_a_tray_is_moved_with_all_that_is_on_it(tmp_path, name) -> None:
    """Certified, with each cube where it stood on the tray."""
    path = write_scene(tmp_path, TABLES + CUBES)
    task = open_task(load_sketch("pick_and_place").checked, str(path), 0, name)
    solution = task.solve(Limits(timeout=60))
    assert solution.solved
    assert len(solution.plan.plan.actions) <= 5
    assert solution.plan.validate().valid
    before, after = task.problem.initial.placements, solution.outcome.state.placements
    assert before[1:] == after[1:]  # in the tray's own frame
    assert after[0].support != before[0].support
