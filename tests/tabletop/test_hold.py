"""The sketch `hold`: something is to be in the gripper at the end, whatever stands around it."""

from __future__ import annotations

import math

from domains.tabletop import Object, bars, wanted_held
from domains.tabletop.scene.load import load_scene
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from runtime.search.limits import Limits
from runtime.solve import Result, open_task
from sketchlang.analysis.coverage import find_coverage
from sketchlang.analysis.termination import Terminating, decide_termination
from sketchlang.loader import load_sketch
from tests.runtime.robot.robots import write_robot
from tests.tabletop.scene.texts import TABLES
from tests.tabletop.tasks import stick

HEAD = f'robot_start = [-0.5, 0.0, 0.0]\napproaches = ["side"]\n{TABLES}'
HELD = '[[goal]]\nobject = "a"\nheld = true\n'


def solved(folder, *entries: str) -> Result:
    path = folder / "scene.toml"
    path.write_text("\n".join([HEAD, *entries, HELD]))
    return open_task(load_sketch("hold").checked, str(path), 0).solve(Limits(timeout=30))


def test_it_terminates_and_leaves_nothing_out() -> None:
    model = load_sketch("hold").checked.model
    assert isinstance(decide_termination(model), Terminating)
    assert not find_coverage(model).gaps


def test_what_stands_free_is_taken_at_once(tmp_path) -> None:
    result = solved(tmp_path, stick("a", 0.8, 0.6), stick("b", 0.8, -0.9))
    assert [subgoal.rule for subgoal in result.outcome.subgoals] == ["take"]
    assert result.plan.validate().valid


def test_what_is_in_the_way_is_put_aside_first(tmp_path) -> None:
    ring = [
        stick(f"r{k}", 0.8 + 0.07 * math.cos(k), 0.6 + 0.07 * math.sin(k))
        for k in (0.0, math.pi / 3, 2 * math.pi / 3, math.pi, -2 * math.pi / 3, -math.pi / 3)
    ]
    result = solved(tmp_path, stick("a", 0.8, 0.6), *ring)
    rules = [subgoal.rule for subgoal in result.outcome.subgoals]
    assert rules[0] == "clear_way"
    assert rules[-1] == "take"
    assert result.plan.validate().valid
    start = result.task.problem.initial
    a = Object(0)
    assert wanted_held(start, a)
    assert not wanted_held(start, Object(1))
    assert bars(start, a) > 0
    assert bars(result.outcome.state, a) == 0


def test_of_nothing_that_is_wanted_there_is_no_plan(tmp_path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        "\n".join([HEAD, stick("a", 0.8, 0.6), '[[goal]]\nobject = "a"\non = "right"\n'])
    )
    task = open_task(load_sketch("hold").checked, str(path), 0)
    assert not task.solve(Limits(timeout=10)).solved


def test_a_robot_without_room_to_turn_gets_to_what_is_behind_it(tmp_path) -> None:
    """Its base is a square of 40 cm, between two walls that are open behind."""
    walls = "\n".join(
        f'[[wall]]\nname = "w{y}"\nat = [0.0, {y}]\nsize = [0.5, 0.05, 0.5]' for y in (-0.27, 0.27)
    )
    path = tmp_path / "scene.toml"
    text = HEAD.replace("[-0.5, 0.0, 0.0]", "[0.0, 0.0, 0.0]")
    path.write_text("\n".join([text, walls, stick("a", 0.8, 0.6), HELD]))
    world = TabletopWorld.of(load_scene(path), load_robot(write_robot(tmp_path)))
    assert not world.roads.can_turn(0.0, 0.0)
    behind = world.roads.lane((0.0, 0.0, 0.0))
    assert behind is not None
    assert world.room.contains(*behind)
    assert world.room.contains(-1.0, 1.0)
