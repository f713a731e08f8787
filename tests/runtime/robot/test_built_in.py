"""The robots that come with the package: clean, and able to work at usual tables."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.kernels import arm, ik
from runtime.kernels.convex import boxes_only
from runtime.motion.arm_context import CONTACT_MARGIN, FREE_MARGIN, ArmContext
from runtime.motion.base import footprint
from runtime.robot.approach import Family
from runtime.robot.check import check_robot
from runtime.robot.load import built_in_robots, load_robot, robot_path
from runtime.robot.open_hand import tools
from runtime.robot.reachable import approach_frame
from runtime.world.poses import compose

NAMES = built_in_robots()
MOBILE = [name for name in NAMES if load_robot(name).base.type != "fixed"]
FIXED = [name for name in NAMES if load_robot(name).base.type == "fixed"]
ABOVE = {Family.SIDE: 0.065, Family.TOP: 0.04}
"""Metres of a grasp centre above the table."""


def reached(robot, family, x, y, z, heading, table, rng) -> bool:
    """Whether a grasp is reached by a posture free of collision with the robot and a table."""
    frame = approach_frame(family, x, y, z, heading)
    obstacles = boxes_only(np.array([table, [0, 0, -0.5, 9, 9, 0.5, 1, 0]], dtype=float))
    anywhere = rng.uniform(robot.lower, robot.upper, (40, len(robot.home)))
    for tool in tools(family, rng.uniform(-1.5, 1.5)):
        starts = np.vstack([robot.home, anywhere])
        found = ik.first_free(
            robot.chain, robot.lower, robot.upper, robot.tool, compose(frame, tool), starts, 0,
            60, robot.ease, robot.body(0.06), obstacles, CONTACT_MARGIN,
        )  # fmt: skip
        if found >= 0:
            assert np.allclose(robot.tool_pose(starts[found]), compose(frame, tool), atol=1e-3)
            return True
    return False


def test_there_are_an_arm_on_a_desk_and_two_that_drive() -> None:
    assert {"tiago", "ur5e_desk", "franka_mobile"} <= set(NAMES)
    assert FIXED
    assert len(MOBILE) >= 2


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_found_in_built_in_robots(name) -> None:
    found, robot = check_robot(robot_path(name))
    assert not found
    assert robot is not None
    context = ArmContext(robot, robot.body(robot.gripper.max_opening), np.empty((0, 8)))
    assert not context.collides(robot.home, FREE_MARGIN)


@pytest.mark.parametrize("top", [0.4, 0.65, 0.9])
@pytest.mark.parametrize("family", [Family.SIDE, Family.TOP])
@pytest.mark.parametrize("name", MOBILE)
def test_mobile_robots_reach_things_on_tables(name, family, top, rng) -> None:
    """10 cm behind the edge of a table, solid to the floor, from places where the base can turn,
    close to it or some way back."""
    robot = load_robot(name)
    half = (0.4, 0.8, top / 2)
    rows = np.array([[0.0, 0.0, top / 2, *half, 1.0, 0.0]])
    near = footprint(robot, robot.body(robot.gripper.max_opening)).clearances(rows)[0]
    hits = 0
    for _ in range(6):
        y, heading = rng.uniform(-0.1, 0.1), rng.uniform(-0.3, 0.3)
        for back in (0.0, 0.1, 0.2, 0.3, 0.4):
            x = near + back + 0.1
            table = [near + back + half[0], 0.0, top / 2, *half, 1.0, 0.0]
            if reached(robot, family, x, y, top + ABOVE[family], heading, table, rng):
                hits += 1
                break
    assert hits >= 5


@pytest.mark.parametrize("family", [Family.SIDE, Family.TOP])
@pytest.mark.parametrize("name", FIXED)
def test_fixed_robots_reach_the_desk_around_them(name, family, rng) -> None:
    robot = load_robot(name)
    top = 0.748
    desk = [0.0, 0.0, top / 2, 1.0, 1.0, top / 2, 1.0, 0.0]
    hits, count = 0, 0
    for bearing in np.arange(8) * math.pi / 4:
        for distance in (0.45, 0.55, 0.65):
            x, y = distance * math.cos(bearing), distance * math.sin(bearing)
            heading = bearing + rng.uniform(-0.3, 0.3)
            hits += reached(robot, family, x, y, top + ABOVE[family], heading, desk, rng)
            count += 1
    assert hits >= 0.9 * count


@pytest.mark.parametrize("name", NAMES)
def test_speeds_and_accelerations_are_those_of_such_arms(name) -> None:
    robot = load_robot(name)
    turning = ~robot.chain.prismatic
    assert (robot.velocity[turning] > 1.0).all()
    assert (robot.velocity[turning] < 5.0).all()
    seconds = robot.velocity / robot.acceleration  # from rest to full speed
    assert (seconds >= 0.25).all()
    assert (seconds <= 1.2).all()


@pytest.mark.parametrize("name", FIXED)
def test_fixed_robots_stay_clear_of_the_desk_they_stand_on(name) -> None:
    robot = load_robot(name)
    body = robot.body(robot.gripper.max_opening)
    placed = np.empty((len(body.frame), 3, 4))
    arm.place_boxes(robot.frames(robot.home), body.frame, body.pose, placed)
    desk = boxes_only(np.array([[0.0, 0.0, 0.375, 2.0, 2.0, 0.375, 1.0, 0.0]]))
    assert not arm.body_collides(body, placed, desk, CONTACT_MARGIN)
