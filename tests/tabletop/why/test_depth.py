"""Bins that are too deep for the arm, and headings of the start below zero."""

from __future__ import annotations

import pytest

from domains.tabletop.why import depth
from runtime.search.limits import Limits
from runtime.search.siw_r import End
from runtime.solve import open_task
from runtime.trace.make import trace_of_plan
from runtime.trace.sketch import load_trace_sketch
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import TABLE, write_scene

SCENE = f"""
robot_start = [0.0, 0.0, {{heading}}]
{TABLE}[[table]]
name = "low"
at = [0.2, -1.5]
size = [0.6, 0.6]
top = 0.3
[[bin]]
name = "well"
at = [0.2, -1.5]
size = [{{width}}, {{width}}]
height = {{height}}
wall = 0.01
on = "low"
[[wall]]
name = "back"
at = [1.65, 0.0]
size = [0.02, 1.2, 2.0]
[[object]]
name = "cube"
size = [0.05, 0.05, 0.05]
at = [1.05, 0.1]
on = "table"
[[goal]]
object = "cube"
on = "well"
"""


def opened(tmp_path, robot: str, height: float, width: float = 0.2, heading: float = -100.0):
    path = write_scene(tmp_path, SCENE.format(height=height, width=width, heading=heading))
    return open_task(load_sketch("pick_and_place").checked, str(path), 0, robot)


@pytest.mark.parametrize("robot", ["tiago", "franka_mobile"])
def test_a_bin_that_is_too_deep_is_named_before_any_search(tmp_path, robot) -> None:
    result = opened(tmp_path, robot, 0.62).solve(Limits(timeout=60))
    assert result.outcome.end is End.HOPELESS
    (found,) = result.outcome.why
    assert (found["object"], found["cause"]) == ("cube", "goal out of reach")
    assert "well" in found["text"]


def test_only_what_rises_on_all_sides_is_deep(tmp_path) -> None:
    world = opened(tmp_path, "tiago", 0.12).problem.world
    grounds = {ground.name: ground for ground in world.grounds}
    assert depth.depth_of(world, grounds["well"]) == pytest.approx(0.12 - 0.01, abs=0.003)
    assert depth.depth_of(world, grounds["table"]) == 0.0
    assert not depth.is_beyond_the_estimate(world, 0, grounds["well"])


def test_a_plan_from_a_heading_below_zero_can_be_carried_out(tmp_path) -> None:
    result = opened(tmp_path, "tiago", 0.12).solve(Limits(timeout=60))
    assert result.solved
    world = result.task.problem.world
    sketch = load_trace_sketch("pick_and_place")
    trace = trace_of_plan(result.plan.plan, world.scene.world, world.robot, sketch)
    assert trace.base.values[0, 2] == pytest.approx(world.scene.robot_start[2], abs=1e-4)
