"""Robot files: what is read, and how mistakes are reported."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from runtime.robot.load import BUILT_IN, built_in_robots, load_robot
from runtime.robot.model import RobotModel
from sketchlang.errors import InputError
from tests.runtime.robot.robots import TOML, URDF, write_robot


def test_the_default_robot_is_built_in() -> None:
    assert built_in_robots()
    assert all(isinstance(load_robot(name), RobotModel) for name in built_in_robots())


def test_limits_and_names_are_those_of_the_files(tmp_path) -> None:
    robot = load_robot(write_robot(tmp_path))
    assert robot.name == "crane"
    assert robot.joints == ("lift", "swing")
    assert robot.lower.tolist() == [0.0, -2.0]
    assert robot.upper.tolist() == [0.5, 2.0]
    assert robot.velocity.tolist() == [0.1, 1.0]
    assert robot.acceleration.tolist() == [0.1, 2.0]


def test_the_tool_is_where_the_chain_leads(tmp_path) -> None:
    robot = load_robot(write_robot(tmp_path))
    straight = robot.tool_pose(np.array([0.2, 0.0]))
    assert straight[:, 3] == pytest.approx([0.46, 0.0, 1.0])
    turned = robot.tool_pose(np.array([0.2, np.pi / 2]))
    assert turned[:, 3] == pytest.approx([0.0, 0.46, 1.0])
    assert turned[:, 0] == pytest.approx([0.0, 1.0, 0.0])


def test_fingers_open_to_both_sides_by_half_each(tmp_path) -> None:
    robot = load_robot(write_robot(tmp_path))
    assert robot.gripper.max_opening == pytest.approx(0.08)
    body = robot.body(0.05)
    inner_faces = sorted(
        float(body.pose[i][1, 3] - side * body.half[i][1]) for i, side in robot.gripper.fingers
    )
    assert inner_faces == pytest.approx([-0.025, 0.025])


def test_a_held_box_is_fixed_to_the_tool_and_may_touch_the_gripper(tmp_path) -> None:
    from runtime.robot.urdf import Box

    robot = load_robot(write_robot(tmp_path))
    body = robot.body(0.04, Box("held", np.eye(3, 4), np.array([0.02, 0.02, 0.1])))
    held = len(body.frame) - 1
    assert body.frame[held] == len(robot.joints)
    assert body.pose[held][:, 3] == pytest.approx(robot.tool[:, 3])
    against = {robot.parts[i].link for i, j in body.pairs if j == held}
    assert against == {"foot", "mast", "boom"}


def test_links_beside_the_chain_move_with_it(tmp_path) -> None:
    urdf = URDF.replace(
        "</robot>",
        '<link name="lamp"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
        '</link><joint name="neck" type="revolute"><parent link="mast"/><child link="lamp"/>'
        '<origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>',
    )
    toml = TOML + "\n[fixed_joints]\nneck = 0.5\n"
    robot = load_robot(write_robot(tmp_path, toml, urdf))
    lamp = next(placed for placed in robot.parts if placed.link == "lamp")
    assert lamp.frame == 1
    assert lamp.shape.pose[:, 3] == pytest.approx([0.0, 0.0, 0.5])
    assert lamp.shape.pose[:, 0] == pytest.approx([np.cos(0.5), np.sin(0.5), 0.0])


def test_the_digest_follows_both_files(tmp_path) -> None:
    first = load_robot(write_robot(tmp_path)).digest
    assert load_robot(write_robot(tmp_path)).digest == first
    assert load_robot(write_robot(tmp_path, TOML + "\n# a remark\n")).digest != first
    assert load_robot(write_robot(tmp_path, TOML, URDF + "<!-- a remark -->")).digest != first


# -- mistakes ----------------------------------------------------------------------------------

CONE = URDF.replace('<box size="0.1 0.1 0.4"/>', '<cone radius="0.1" length="0.4"/>')
FLAT = URDF.replace('<box size="0.1 0.1 0.4"/>', '<cylinder radius="0.1"/>')
DOCTYPE = '<!DOCTYPE robot [<!ENTITY a "aaaa">]>' + URDF
CIRCLE = URDF.replace('<child link="left"/>', '<child link="left"/><mimic joint="left_finger"/>')
LOST = URDF.replace('<child link="left"/>', '<child link="left"/><mimic joint="thumb"/>')
MESH = URDF.replace('<box size="0.1 0.1 0.4"/>', '<mesh filename="mast.stl"/>')
CYCLE = URDF.replace('<parent link="foot"/>', '<parent link="grasp"/>')
ISLAND = URDF.replace("</robot>", '<link name="island"/></robot>')
MACRO = URDF.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', 1).replace(
    "</robot>", '<xacro:arm prefix="left_"/></robot>'
)
EXPRESSION = URDF.replace('size="0.1 0.1 0.4"', 'size="0.1 $(arg width) 0.4"')
TWICE = URDF.replace(
    "</robot>",
    '<joint name="again" type="fixed"><parent link="foot"/><child link="mast"/></joint></robot>',
)

MISTAKES = {
    "unknown joint": (TOML.replace('"swing"]', '"sving"]'), URDF, "joints", "swing"),
    "no joints": (TOML.replace('["lift", "swing"]', "[]"), URDF, "joints", "swing"),
    "home outside limits": (TOML.replace("[0.1, 0.0]", "[0.1, 3.0]"), URDF, "home", "swing"),
    "home too short": (TOML.replace("[0.1, 0.0]", "[0.1]"), URDF, "home", "1 values"),
    "missing key": (TOML.replace('tool_link = "grasp"\n', ""), URDF, "tool_link", "missing"),
    "misspelt key": (TOML.replace("clearance", "clearence"), URDF, "clearance", "clearence"),
    "unknown tool": (TOML.replace('"grasp"', '"grisp"'), URDF, "tool_link", "grisp"),
    "unknown base": (TOML.replace('"foot"\n', '"feet"\n'), URDF, "base_link", "feet"),
    "base is not the root": (
        TOML.replace('base_link = "foot"', 'base_link = "mast"').replace('"lift", ', ""),
        URDF,
        "acceleration",
        "1 joints",
    ),
    "unknown finger": (TOML.replace('"left_finger"', '"thumb"'), URDF, "finger_joints", "thumb"),
    "unknown gripper link": (TOML.replace('"palm"', '"plam"'), URDF, "links", "plam"),
    "unknown fixed joint": (TOML + "\n[fixed_joints]\nneck = 0.5\n", URDF, "fixed_joints", "neck"),
    "unknown link ignored": (
        TOML.replace('["foot", "mast"]', '["foot", "mist"]'),
        URDF,
        "ignored_collisions",
        "mist",
    ),
    "no acceleration": (TOML.replace("[0.1, 2.0]", "[0.1, 0.0]"), URDF, "acceleration", "positive"),
    "no speed": (TOML.replace("velocity = 0.8", "velocity = 0.0"), URDF, "velocity", "positive"),
    "missing urdf": (TOML.replace("crane.urdf", "crone.urdf"), URDF, "crone.urdf", "no such file"),
    "urdf is not xml": (TOML, "<robot", "crane.urdf", "XML"),
    "urdf with a cone": (TOML, CONE, "mast", "cone"),
    "cylinder without a length": (TOML, FLAT, "mast", "length"),
    "urdf with a mesh that is not there": (TOML, MESH, "mast", "mast.stl"),
    "urdf with macros": (TOML, MACRO, "crane.urdf", "macros of xacro"),
    "urdf with an expression": (TOML, EXPRESSION, "mast", "xacro has not expanded"),
    "urdf with entities": (TOML, DOCTYPE, "crane.urdf", "document type"),
    "joint that mimics itself": (TOML, CIRCLE, "left_finger", "itself"),
    "joint that mimics nothing": (TOML, LOST, "left_finger", "thumb"),
    "no gripper": (
        TOML.replace("[gripper]", "[gripper_]").replace(
            'finger_joints = ["left_finger", "right_finger"]', ""
        ),
        URDF,
        "gripper",
        "gripper",
    ),
    "a base of no kind": (TOML.replace("[base]", '[base]\ntype = "legs"'), URDF, "legs", "fixed"),
    "urdf with a cycle": (TOML, CYCLE, "foot", "grasp"),
    "urdf in two parts": (TOML, ISLAND, "island", "foot"),
    "urdf with two parents": (TOML, TWICE, "mast", "again"),
    "joint without velocity": (
        TOML,
        URDF.replace('velocity="1" effort', "effort"),
        "swing",
        "velocity",
    ),
    "joint without limits": (
        TOML,
        URDF.replace('<limit lower="-2" upper="2" velocity="1" effort="1"/>', ""),
        "swing",
        "limit",
    ),
    "limits the wrong way round": (TOML, URDF.replace('upper="2"', 'upper="-3"'), "swing", "lower"),
    "limit is not a number": (TOML, URDF.replace('upper="2"', 'upper="two"'), "swing", "two"),
    "limit is nan": (TOML, URDF.replace('upper="2"', 'upper="nan"'), "swing", "limit"),
    "joint type is not supported": (
        TOML,
        URDF.replace('"swing" type="revolute"', '"swing" type="planer"'),
        "swing",
        "planer",
    ),
    "unknown link": (
        TOML,
        URDF.replace('<child link="palm"/>', '<child link="plam"/>'),
        "wrist",
        "plam",
    ),
    "box without size": (TOML, URDF.replace('size="0.1 0.1 0.4"', ""), "mast", "size"),
    "box of negative size": (
        TOML,
        URDF.replace('"0.1 0.1 0.4"', '"0.1 -0.1 0.4"'),
        "mast",
        "positive",
    ),
    "box of two numbers": (TOML, URDF.replace('"0.1 0.1 0.4"', '"0.1 0.1"'), "mast", "3 numbers"),
}


@pytest.mark.parametrize(("toml", "urdf", "place", "word"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes_are_named(tmp_path, toml, urdf, place, word) -> None:
    path = write_robot(tmp_path, toml, urdf)
    with pytest.raises(InputError) as caught:
        load_robot(path)
    text = str(caught.value)
    assert str(tmp_path) in text
    assert place in text
    assert word in text


def test_an_unknown_robot_is_answered_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="unknown robot 'tigao'") as caught:
        load_robot("tigao")
    assert caught.value.hint is not None
    assert all(name in caught.value.hint for name in built_in_robots())


@pytest.mark.parametrize("name", ["a" * 300, "", ".", "..", "nul\0name", "a/b"])
def test_strange_robot_names_are_unknown_robots(name) -> None:
    with pytest.raises(InputError, match="unknown robot"):
        load_robot(name)


def test_a_missing_robot_file_is_named(tmp_path) -> None:
    with pytest.raises(InputError, match="no such file") as caught:
        load_robot(tmp_path / "missing.toml")
    assert caught.value.place == str(tmp_path / "missing.toml")


def test_a_missing_key_comes_with_the_one_that_was_probably_meant(tmp_path) -> None:
    path = write_robot(tmp_path, TOML.replace("tool_link", "tool_lnk"))
    with pytest.raises(InputError) as caught:
        load_robot(path)
    assert "tool_lnk" in (caught.value.hint or "")


LINES = TOML.splitlines()
XML_WORDS = sorted(set(re.findall(r'"[^"]*"|<[^>]*>', URDF)))


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_change_gives_a_robot_or_an_input_error(tmp_path: Path, data: st.DataObject) -> None:
    toml, urdf = TOML, URDF
    if data.draw(st.booleans()):
        line = data.draw(st.sampled_from(LINES))
        toml = toml.replace(line, data.draw(st.sampled_from(["", line * 2, line[:-1], line[::-1]])))
    else:
        word = data.draw(st.sampled_from(XML_WORDS))
        values = ['"0"', '"-1 -1 -1"', '"foot"', '"grasp"', '"nan"', "", "<link/>"]
        urdf = urdf.replace(word, data.draw(st.sampled_from(values)), 1)
    said = None
    try:
        robot = load_robot(write_robot(tmp_path, toml, urdf))
    except InputError as error:
        said = str(error)
    assert np.isfinite(robot.tool).all() if said is None else str(tmp_path) in said


def test_files_of_the_default_robot_are_read_from_the_package() -> None:
    assert all((BUILT_IN / name / f"{name}.toml").is_file() for name in built_in_robots())
