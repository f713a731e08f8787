"""Hands that come halfway between the level and the vertical, where a scene asks for them."""

from __future__ import annotations

import pytest

from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import SIDE, SLANT, TOP, USUAL
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import RACK, TABLES

THINGS = """
[[object]]
name = "box"
size = [0.05, 0.04, 0.06]
at = [0.75, 0.5]
yaw = 20.0
[[object]]
name = "can"
shape = "cylinder"
radius = 0.03
height = 0.1
at = [0.8, 0.75]
[[goal]]
object = "box"
at = [0.8, -0.9]
yaw = 50.0
[[goal]]
object = "can"
on = "right"
"""

BAY = """
[[shelf]]
name = "shelf"
at = [0.8, 0.0]
yaw = -90.0
size = [0.8, 0.4]
boards = [0.6, {top}]
[[object]]
name = "brick"
size = [0.16, 0.05, 0.05]
at = [0.7, 0.0]
on = "shelf/1"
[[goal]]
object = "brick"
at = [0.72, 0.1]
on = "shelf/1"
"""


def scene(approaches: str, *parts: str) -> str:
    return "\n".join([f"robot_start = [-0.5, 0.0, 0.0]\napproaches = {approaches}", *parts])


@pytest.mark.parametrize("robot", ["tiago", "franka_mobile"])
def test_things_are_carried_aslant_and_the_plan_is_certified(tmp_path, robot) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(scene('["slant"]', TABLES, THINGS))
    task = open_task(load_sketch("pick_and_place").checked, str(path), 0, robot)
    result = task.solve(Limits(timeout=60))
    assert result.solved, result.outcome.reason
    picks = [a for s in result.outcome.subgoals for a in s.actions if hasattr(a, "grasp")]
    assert picks
    assert {pick.grasp.family for pick in picks} == {SLANT}
    verdict = result.plan.validate()
    assert verdict.valid, [finding.message for finding in verdict.findings]


def test_they_are_not_thought_of_where_the_others_do(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("robot_start = [-0.5, 0.0, 0.0]\n" + TABLES + THINGS)
    assert load_scene(path).families == USUAL
    world = TabletopWorld.of(load_scene(path), load_robot("tiago"))
    world.reachable_at(0, SIDE, world.starts[0])
    assert SLANT not in world.hand.sweeps


@pytest.mark.parametrize(("top", "reached"), [(0.95, True), (0.70, False)])
def test_boards_bar_a_hand_from_above_before_one_aslant(tmp_path, top, reached) -> None:
    """Between two boards: too low for a hand from above, and room enough for one aslant, or
    not even for that."""
    path = tmp_path / "scene.toml"
    path.write_text(scene('["top", "slant"]', BAY.format(top=top)))
    world = TabletopWorld.of(load_scene(path), load_robot("tiago"))
    at = world.starts[0]
    assert world.reachable_at(0, TOP, at) == 0
    assert bool(world.reachable_at(0, SLANT, at)) == reached


def test_hands_that_would_be_in_the_floor_do_not_count(tmp_path) -> None:
    """What lies low on the floor is taken from above, not by a hand whose palm would be in it."""
    low = '[[object]]\nname = "low"\nsize = [0.05, 0.05, 0.05]\nat = [-1.2, 0.0]\non = "floor"\n'
    tall = low.replace("low", "tall").replace("0.05]", "0.3]").replace("-1.2", "-1.8")
    goals = "".join(f'[[goal]]\nobject = "{n}"\non = "right"\n' for n in ("low", "tall"))
    path = tmp_path / "scene.toml"
    path.write_text(scene('["side", "top"]', TABLES, low, tall, goals))
    world = TabletopWorld.of(load_scene(path), load_robot("tiago"))
    ways = [[world.reachable_at(i, f, world.starts[i]) for f in (SIDE, TOP)] for i in (0, 1)]
    assert ways[0][0] == 0
    assert ways[0][1] != 0
    assert ways[1][0] != 0


@pytest.mark.parametrize("robot", ["tiago", "franka_mobile"])
def test_they_join_where_something_hardly_gets_to_its_goal_otherwise(tmp_path, robot) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(RACK.format(approaches='approaches = ["side", "top", "pinch"]'))
    model = load_robot(robot)
    assert SLANT not in TabletopWorld.of(load_scene(path), model).families
    path.write_text(RACK.format(approaches=""))
    assert TabletopWorld.of(load_scene(path), model).families == (*USUAL, SLANT)
    task = open_task(load_sketch("pick_and_place").checked, str(path), 0, robot)
    result = task.solve(Limits(timeout=60))
    assert result.solved, result.outcome.reason
    assert result.plan.validate().valid
