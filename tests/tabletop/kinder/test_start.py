"""Where plans start: clear of what stands around, and not further away than it has to be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from domains.tabletop.kinder.problem import Problem, table
from domains.tabletop.kinder.start import STEP, free_start
from domains.tabletop.scene.load import load_scene
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot

TOP = table("table", name="top", at=[1.0, 0.0], size=[0.8, 0.8], top=0.7)


def cube(x: float, y: float) -> str:
    return table("object", name=f"cube{x}", size=[0.05, 0.05, 0.3], at=[x, y], on="floor")


@pytest.mark.parametrize("x", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("heading", [0.0, 0.5])
def test_starts_are_moved_off_tables_and_things(tmp_path, x, heading) -> None:
    robot = load_robot("tiago")
    goal = table("goal", object="cube-2.0", on="top")
    problem = Problem("pick_and_place", (TOP, cube(-2.0, 0.0), goal))
    given = (x, 0.0, heading)
    scene = load_scene(problem.write(tmp_path, (*given[:2], math.degrees(heading))))
    found = free_start(scene, robot)
    assert found[2] == pytest.approx(heading)
    moved = math.hypot(found[0] - x, found[1])
    scene = load_scene(problem.write(tmp_path, (*found[:2], math.degrees(heading))))
    world = TabletopWorld.of(scene, robot)  # raises where the robot cannot stand
    assert world.roads.can_leave(found)
    if moved > STEP:  # a step nearer, in the same direction, it could not
        nearer = np.array(found[:2]) + (np.array(given[:2]) - found[:2]) * (STEP / moved)
        assert not world.roads.can_leave((*nearer.tolist(), heading))
    elif moved == 0:
        assert world.roads.can_leave(given)
