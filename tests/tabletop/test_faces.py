"""Faces: the same grasp seen from each side of an object, and when an object is turned."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from domains.tabletop.faces import faces_at, grasp_at, turned, turns
from domains.tabletop.features.functions import arrangement, goal_placements, obstructions
from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import FAMILIES, PINCH, SIDE, SLANT, TOP, Grasp
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from runtime.search.limits import Limits
from runtime.solve import open_task
from runtime.world.poses import compose, invert
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import TABLE, write_scene

TABLES = f"""{TABLE}[[table]]
name = "side"
at = [0.0, -1.5]
size = [0.8, 0.6]
top = 0.5
[[bin]]
name = "bin"
at = [0.0, -1.5]
size = [0.5, 0.4]
height = 0.12
wall = 0.01
on = "side"
"""


def scene(size: str, x: float, on: str = "bin", more: str = "") -> str:
    return f"""robot_start = [0.0, 0.0, 0.0]
{TABLES}
[[object]]
name = "box"
size = {size}
at = [{x}, 0.0]
on = "table"
mass = 0.4
{more}
[[goal]]
object = "box"
on = "{on}"
"""


@pytest.fixture(scope="module")
def robot():
    return load_robot("tiago")


def made(tmp_path, robot, text: str) -> TabletopWorld:
    return TabletopWorld.of(load_scene(write_scene(tmp_path, text)), robot)


@settings(deadline=None, max_examples=60)
@given(
    st.floats(0.0, 6.28), st.floats(0.01, 0.3), st.booleans(),
    st.sampled_from((SIDE, TOP, PINCH, SLANT)),
    st.floats(-0.2, 0.2), st.floats(-0.2, 0.2),
)  # fmt: skip
def test_a_grasp_is_read_off_its_tool(angle, height, flipped, family, along, aside) -> None:
    grasp = Grasp.of(angle, height, flipped, family, along, aside)
    found = grasp_at(grasp.tool, 3)
    assert found is not None
    assert (found.family, found.face) == (family, 3)
    assert np.allclose(found.tool, grasp.tool, atol=3e-5)


def test_a_hand_that_is_not_level_is_no_grasp() -> None:
    tool = Grasp.of(0.4, 0.1).tool
    c, s = math.cos(0.1), math.sin(0.1)
    leaning = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    assert grasp_at(np.column_stack([leaning @ tool[:, :3], tool[:, 3]]), 0) is None


def test_turning_leaves_the_hand_where_it_is_on_the_object(tmp_path, robot) -> None:
    """The tool's pose in the body's own frame is the same on every face, and back again."""
    world = made(tmp_path, robot, scene("[0.3, 0.2, 0.05]", 0.87))
    count = 0
    for face in range(len(world.faces[0])):
        for to in range(len(world.faces[0])):
            for turn in turns(world, 0, face, to):
                here, there = world.item(0, face), world.item(0, to)
                hold = here.holds(world.hand, turn.family, np.array([turn.angle]))
                grasp = here.grasp(hold, 0, turn.angle)
                mine = compose(invert(here.standing), grasp.tool)
                theirs = compose(invert(there.standing), turn.there.tool)
                assert np.allclose(mine, theirs, atol=5e-5)
                back = turned(world, 0, turn.there, face)
                assert back is not None
                assert np.allclose(back.tool, grasp.tool, atol=5e-5)
                count += 1
    assert count > 20


def test_every_face_of_a_box_is_an_upright_box(tmp_path, robot) -> None:
    world = made(tmp_path, robot, scene("[0.3, 0.2, 0.05]", 0.87))
    sizes = [tuple(round(v, 6) for v in item.size) for item in world.faces[0]]
    assert sizes[0] == (0.3, 0.2, 0.05)
    assert sorted(size[2] for size in sizes) == [0.05, 0.2, 0.2, 0.3, 0.3]
    assert world.packed is None  # the fast path of the kernels
    for item in world.faces[0]:
        assert abs(item.centre[2] - item.size[2] / 2) < 1e-9


def test_what_can_be_put_down_as_it_stands_is_not_turned(tmp_path, robot) -> None:
    world = made(tmp_path, robot, scene("[0.05, 0.05, 0.05]", 1.1))
    here = arrangement(world, world.initial.placements)
    assert faces_at(world, 0, world.goal_sites(0, here)) == (0,)
    assert faces_at(world, 0, None) == (0,)


def test_a_flat_box_over_the_edge_is_stood_up_in_a_bin(tmp_path, robot) -> None:
    world = made(tmp_path, robot, scene("[0.3, 0.2, 0.05]", 0.87))
    state = world.initial
    faces = faces_at(world, 0, world.goal_sites(0, arrangement(world, state.placements)))
    assert 0 not in faces
    assert all(world.item(0, face).size[2] > 0.1 for face in faces)
    assert obstructions(state, 0) == 0
    assert {p.face for p in goal_placements(state, 0)} == set(faces)


def test_what_bears_others_or_has_to_have_a_heading_is_not_turned(tmp_path, robot) -> None:
    rider = '[[object]]\nname = "cube"\nsize = [0.05, 0.05, 0.05]\nat = [1.2, 0.3]\non = "table"\n'
    rider += '[[goal]]\nobject = "cube"\non = "box"\n'
    world = made(tmp_path, robot, scene("[0.3, 0.2, 0.05]", 0.87, more=rider))
    here = arrangement(world, world.initial.placements)
    assert faces_at(world, 0, world.goal_sites(0, here)) == (0,)


def test_a_scene_in_which_hands_come_from_the_side_only_knows_one_face(tmp_path, robot) -> None:
    text = scene("[0.3, 0.2, 0.05]", 0.87).replace(
        "robot_start", f'approaches = ["{FAMILIES[0]}"]\nrobot_start'
    )
    assert len(made(tmp_path, robot, text).faces[0]) == 1


@pytest.mark.parametrize("name", ["tiago", "franka_mobile"])
@pytest.mark.parametrize("size", ["[0.3, 0.2, 0.05]", "[0.26, 0.15, 0.035]"])
def test_a_flat_box_over_the_edge_goes_into_a_bin(tmp_path, name, size) -> None:
    """Certified, and on another side than before; the plan file says which."""
    path = write_scene(tmp_path, scene(size, 0.8 + float(size[1:].split(",")[0]) / 2 - 0.08))
    task = open_task(load_sketch("pick_and_place").checked, str(path), 0, name)
    solution = task.solve(Limits(timeout=60))
    assert solution.solved
    assert solution.plan.validate().valid
    placed = solution.outcome.state.placements[0]
    assert placed.face
    assert solution.plan.plan.actions[-1].arguments["face"] == placed.face
