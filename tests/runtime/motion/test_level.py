"""Level motions: nothing leans on the way, and home is left only where it has to be."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runtime.motion import level
from runtime.motion.arm_context import ArmContext
from runtime.motion.carry import carrying, lean_of
from runtime.robot.load import load_robot
from runtime.world.body import Part
from runtime.world.poses import upright
from runtime.world.solids import Box

DOWN = np.array([-1.0, 0.0, 0.0])
"""What points up where the hand points down."""


@pytest.fixture(scope="module", params=["tiago", "franka_mobile", "ur5e_desk"])
def robot(request):
    return load_robot(request.param)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6))
def test_what_leans_is_straightened_the_shortest_way(numbers) -> None:
    up, axis = np.array(numbers[:3]), np.array(numbers[3:])
    if np.linalg.norm(up) < 0.1 or np.linalg.norm(axis) < 0.1:
        return
    up = up / np.linalg.norm(up)
    pose = np.column_stack([level.level_rotation(axis / np.linalg.norm(axis), 0.3), [1, 2, 3]])
    straight = level.straightened(pose, up)
    assert np.allclose(straight[:, :3] @ straight[:, :3].T, np.eye(3))
    before = lean_of(pose, up)
    if before < np.pi - 1e-3:
        assert lean_of(straight, up) < 1e-6
        turn = straight[:, :3] @ pose[:, :3].T
        assert np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)) == pytest.approx(
            before, abs=1e-5
        )


def test_postures_to_carry_in_are_level_and_free(robot) -> None:
    found = level.postures(robot, DOWN)
    assert found
    context = ArmContext(robot, robot.body(0.0), np.empty((0, 8)))
    for q in found:
        assert lean_of(robot.tool_pose(q), DOWN) < level.LEAN
        assert not context.collides(q)
        assert np.all((q >= robot.lower) & (q <= robot.upper))


def test_a_level_path_is_level_all_the_way(robot) -> None:
    start, *others = level.postures(robot, DOWN)
    context = ArmContext(robot, robot.body(0.0), np.empty((0, 8)))
    count = 0
    for goal in others:
        path = level.plan(context, start, goal, DOWN, 0)
        if path is None:
            continue
        count += 1
        assert np.allclose(path[0], start)
        assert np.allclose(path[-1], goal)
        assert context.path_is_free(path)
        for a, b in pairwise(path):
            for share in (0.25, 0.5, 0.75):
                assert lean_of(robot.tool_pose(a + share * (b - a)), DOWN) < 2 * level.LEAN
    assert count


def test_home_is_kept_where_what_is_held_is_clear_of_the_robot(robot) -> None:
    small = robot.body(0.04, [Part(Box((0.04, 0.04, 0.04)), upright(0, 0, 0, 0))])
    assert carrying(robot, small, 0) is robot.home


def test_another_posture_is_found_for_what_does_not_go_with_home(robot) -> None:
    for size in (0.4, 0.6, 0.9):
        long = robot.body(0.04, [Part(Box((size, 0.3, 0.02)), upright(size / 2, 0, 0, 0))])
        context = ArmContext(robot, long, np.empty((0, 8)))
        found = carrying(robot, long, 0)
        if context.collides(robot.home):
            assert found is None or not context.collides(found)
            assert found is None or not np.array_equal(found, robot.home)
        else:
            assert found is robot.home
