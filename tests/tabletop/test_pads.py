"""What the planner holds for a grasp, against the judge, which sees contacts with code of its own;
and corners of things that are too large for the gripper."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from domains.tabletop.hand import Hand, hand_of
from domains.tabletop.items import Item, why_not
from domains.tabletop.state import PINCH, SIDE, SLANT, TOP
from runtime.judge.extents import homogeneous
from runtime.judge.grip import grip_fault
from runtime.judge.skeleton import Skeleton
from runtime.robot.load import load_robot
from runtime.search.limits import Limits
from runtime.search.siw_r import End
from runtime.solve import open_task
from runtime.world.body import Body, Part
from runtime.world.poses import Floats, Pose, invert, upright
from runtime.world.quaternions import matrix
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from runtime.world.world import Movable
from sketchlang.loader import load_sketch
from tests.tabletop.scene.texts import TABLES

FAMILIES = (SIDE, TOP, PINCH, SLANT)
ROBOTS = ("tiago", "franka_mobile")
EVERYWHERE: Floats = np.arange(360.0) * math.pi / 180


@lru_cache(maxsize=2)
def hand(name: str) -> Hand:
    return hand_of(load_robot(name))


@lru_cache(maxsize=2)
def skeleton(name: str) -> Skeleton:
    return Skeleton(load_robot(name))


def lengths(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda value: round(value, 4))


@st.composite
def frustums(draw: st.DrawFn) -> Hull:
    """Pyramids without their tips, upside down or not."""
    sides, height = draw(st.integers(3, 8)), draw(lengths(0.02, 0.12))
    radii = draw(lengths(0.01, 0.05)), draw(lengths(0.01, 0.05))
    return Hull(
        tuple(
            (r * math.cos(2 * math.pi * k / sides), r * math.sin(2 * math.pi * k / sides), z)
            for r, z in zip(radii, (-height / 2, height / 2), strict=True)
            for k in range(sides)
        )
    )


SOLIDS: st.SearchStrategy[Solid] = st.one_of(
    st.builds(lambda a, b, c: Box((a, b, c)), *[lengths(0.02, 0.14)] * 3),
    st.builds(Cylinder, lengths(0.01, 0.05), lengths(0.02, 0.15)),
    st.builds(Sphere, lengths(0.015, 0.05)),
    st.builds(Capsule, lengths(0.01, 0.04), lengths(0.01, 0.1)),
    frustums(),
)


@st.composite
def poses(draw: st.DrawFn) -> Pose:
    """Upright, or any."""
    if draw(st.booleans()):
        return upright(0.0, 0.0, 0.0, draw(st.floats(0.0, 6.28)))
    turn = np.array([draw(st.floats(-1.0, 1.0)) for _ in range(3)] + [1.0])
    found: Pose = matrix(np.array([0.0, 0.0, 0.0, *turn / np.linalg.norm(turn)]))[:3]
    return found


@st.composite
def items(draw: st.DrawFn) -> Item:
    """Things of up to three solids in one another."""
    parts = []
    for number in range(draw(st.integers(1, 3))):
        pose = draw(poses()).copy()
        if number:
            pose[:, 3] = [draw(lengths(-0.04, 0.04)) for _ in range(3)]
        parts.append(Part(draw(SOLIDS), pose))
    thing = Movable("it", Body(tuple(parts), 0.1, (0.0, 0.0, 0.0)), upright(0.0, 0.0, 0.0, 0.0))
    return Item.of(thing, 0.0, 1)[0]


@given(items(), st.sampled_from(ROBOTS), st.sampled_from(FAMILIES), st.floats(0.0, 6.28))
@settings(max_examples=80, deadline=None)
def test_what_a_hand_is_said_to_hold_does_not_slip(item, robot, family, angle) -> None:
    angles = np.array([*item.sides[:2], angle])
    hold = item.holds(hand(robot), family, angles)
    if hold is None:
        return
    body = Body(item.parts, 0.1, (0.0, 0.0, 0.0))
    for k in np.flatnonzero(hold.fits):
        tool = item.grasp(hold, int(k), float(angles[k])).tool
        in_tool = homogeneous(invert(tool))
        fault = grip_fault(skeleton(robot), float(hold.width[k]), body, "it", in_tool)
        assert fault is None, (fault, angles[k], item.parts)


@given(
    st.tuples(*[st.floats(0.09, 0.3)] * 3), st.floats(0.0, 6.28), st.sampled_from(ROBOTS)
)  # fmt: skip
@settings(max_examples=60, deadline=None)
def test_no_hand_holds_a_box_that_is_too_large_on_all_sides(size, heading, robot) -> None:
    """Not at its corners either, however they are turned to the hand."""
    pose = upright(0.0, 0.0, 0.0, heading)
    body = Body((Part(Box(size), upright(0.0, 0.0, size[2] / 2, 0.0)),), 0.1, (0.0, 0.0, 0.0))
    item = Item.of(Movable("it", body, pose), heading, 1)[0]
    for family in FAMILIES:
        hold = item.holds(hand(robot), family, EVERYWHERE)
        assert hold is None or not hold.fits.any()
    assert "mm across at its narrowest" in str(why_not(item, hand(robot), FAMILIES))


@pytest.mark.parametrize("approaches", ["", 'approaches = ["side", "top", "pinch", "slant"]\n'])
@pytest.mark.parametrize("yaw", [0.0, 45.0, 70.0])
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_cube_that_is_too_large_is_named_before_the_search(
    tmp_path, robot, yaw, approaches
) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        f"robot_start = [-0.5, 0.0, 0.0]\n{approaches}{TABLES}"
        f'[[object]]\nname = "cube"\nsize = [0.1, 0.1, 0.1]\nat = [0.8, 0.6]\nyaw = {yaw}\n'
        '[[goal]]\nobject = "cube"\non = "right"\n'
    )
    task = open_task(load_sketch("pick_and_place").checked, str(path), 0, robot)
    outcome = task.solve(Limits(timeout=30)).outcome
    assert outcome.end == End.HOPELESS
    assert "cube" in str(outcome.reason)
    assert "is 100 mm across at its narrowest" in str(outcome.reason)
