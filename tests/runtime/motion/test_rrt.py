"""Free arm motions: no contact in exact geometry, and the same path for the same question."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from runtime.kernels import advance
from runtime.kernels.staged import HARDLY
from runtime.motion import rrt
from runtime.motion.arm_context import FREE_MARGIN, ArmContext
from runtime.robot.model import RobotModel
from tests.runtime.reference import Floats, along, arm_touches, upright_row


@pytest.fixture
def cluttered(robot: RobotModel) -> ArmContext:
    """A table in front of the robot with a row of sticks."""
    rows = [upright_row(np.array([0.9, 0.0, 0.4]), np.array([0.3, 0.6, 0.4]), 0.0)]
    rows += [
        upright_row(np.array([0.75, y, 0.92]), np.array([0.02, 0.02, 0.11]), 0.0)
        for y in np.linspace(-0.4, 0.4, 5)
    ]
    return ArmContext(robot, robot.body(0.06), np.array(rows))


def free_postures(context: ArmContext, rng: np.random.Generator, count: int) -> list[Floats]:
    """Collision-free configurations with the hand above or over the table."""
    robot = context.robot
    found: list[Floats] = []
    while len(found) < count:
        q = rng.uniform(robot.lower, robot.upper)
        tool = robot.tool_pose(q)[:, 3]
        if tool[0] > 0.5 and 0.6 < tool[2] < 1.3 and not context.collides(q):
            found.append(q)
    return found


def test_paths_touch_nothing_in_exact_geometry(cluttered, rng) -> None:
    robot = cluttered.robot
    bent = 0
    for goal in free_postures(cluttered, rng, 5):
        path = rrt.plan(cluttered, robot.home, goal, seed=3)
        if path is None:
            continue
        bent += len(path) > 2
        assert np.array_equal(path[0], robot.home)
        assert np.array_equal(path[-1], goal)
        assert np.all(path >= robot.lower - 1e-9)
        assert np.all(path <= robot.upper + 1e-9)
        for q in along(path, 15):
            assert not arm_touches(robot.chain, cluttered.body, cluttered.around, q)
    assert bent


def test_the_same_seed_gives_the_same_path_whatever_was_planned_before(cluttered, rng) -> None:
    home = cluttered.robot.home
    goals = free_postures(cluttered, rng, 3)
    first = [rrt.plan(cluttered, home, goal, seed=11) for goal in goals]
    for number, goal in reversed(list(enumerate(goals))):
        rrt.plan(cluttered, goal, home, seed=99)
        again = rrt.plan(cluttered, home, goal, seed=11)
        expected = first[number]
        assert (again is None) == (expected is None)
        if expected is not None:
            assert np.array_equal(again, expected)


def test_the_search_itself_follows_its_seed(cluttered, rng) -> None:
    home, goal = cluttered.robot.home, free_postures(cluttered, rng, 1)[0]
    paths = [rrt.rrt_connect(cluttered, home, goal, seed, 0.08) for seed in (5, 5, 6)]
    assert paths[0] is not None
    assert paths[1] is not None
    assert np.array_equal(paths[0], paths[1])
    assert paths[2] is None or not np.array_equal(paths[0], paths[2])


def test_a_straight_line_is_taken_where_it_is_free(robot) -> None:
    context = ArmContext(robot, robot.body(0.06), np.empty((0, 8)))
    goal = robot.home.copy()
    goal[0] -= 0.1
    path = rrt.plan(context, robot.home, goal, seed=0)
    assert path is not None
    assert path.tolist() == [robot.home.tolist(), goal.tolist()]


def test_joints_of_a_whole_motion_are_tested_by_the_kernel_for_others(robot) -> None:
    context = ArmContext(robot, robot.body(0.05), np.zeros((0, 8)))
    joints = np.linspace(robot.home, robot.home * 0.99, 4)
    assert context.path_is_free(joints)
    known = set(advance.dense._functions)
    whole = np.hstack([np.zeros((4, 3)), joints])
    assert context.path_is_free(whole[:, 3:])
    assert context.path_is_free(np.asfortranarray(joints))
    assert set(advance.dense._functions) == known


def test_of_the_ways_in_two_stages_the_quickest_free_one_is_taken(cluttered, rng) -> None:
    """Against all ways, tested one by one."""
    robot, home = cluttered.robot, cluttered.robot.home
    barred = found = 0
    for goal in free_postures(cluttered, rng, 40):
        free = []
        hardly = np.abs(goal - home) * cluttered.sweep[-1] <= HARDLY
        own = np.flatnonzero(~hardly)
        for chosen in itertools.product((False, True), repeat=len(own)):
            corner = np.where(hardly, (home + goal) / 2, home)
            corner[own[list(chosen)]] = goal[own[list(chosen)]]
            if any(chosen) and not all(chosen) and not cluttered.collides(corner):
                stages = np.abs(corner - home), np.abs(goal - corner)
                needed = sum((stage / robot.velocity).max() for stage in stages)
                if cluttered.path_is_free(np.array([home, corner, goal])):
                    free.append(needed)
        path = rrt.staged(cluttered, home, goal)
        assert (path is None) == (not free)
        barred += path is None
        if path is not None:
            found += 1
            corner = rrt.quickest(cluttered, home, goal)
            stages = np.abs(corner - home), np.abs(goal - corner)
            taken = sum((stage / robot.velocity).max() for stage in stages)
            assert taken == pytest.approx(min(free))
            assert np.array_equal(path[[0, -1]], [home, goal])
            assert cluttered.path_is_free(path)
    assert barred
    assert found


def test_ends_in_collision_have_no_path(cluttered, rng) -> None:
    robot = cluttered.robot
    hit = robot.home
    while not cluttered.collides(hit):
        hit = rng.uniform(robot.lower, robot.upper)
    assert rrt.plan(cluttered, robot.home, hit, seed=0) is None
    assert rrt.plan(cluttered, hit, robot.home, seed=0) is None


def test_ends_beyond_the_joint_limits_have_no_path(robot) -> None:
    """Not even where the straight line is free."""
    context = ArmContext(robot, robot.body(0.06), np.empty((0, 8)))
    beyond = robot.home.copy()
    beyond[0] = robot.upper[0] + 0.05
    assert context.path_is_free(np.array([robot.home, beyond]))
    assert rrt.plan(context, robot.home, beyond, seed=0) is None


def test_an_unreachable_goal_is_given_up(robot) -> None:
    """The hand is in a box from which no way leads out."""
    tool = robot.tool_pose(robot.home)[:, 3]
    walls = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            centre, half = tool.copy(), np.full(3, 0.5)
            centre[axis] += side * 0.6
            half[axis] = 0.02
            walls.append(upright_row(centre, half, 0.0))
    goal = robot.home.copy()
    goal[1] += 1.5
    context = ArmContext(robot, robot.body(0.06), np.array(walls))
    assert rrt.plan(context, robot.home, goal, seed=0) is None


def test_shortening_keeps_the_ends_and_stays_free(cluttered, rng) -> None:
    home = cluttered.robot.home
    checked = 0
    for goal in free_postures(cluttered, rng, 4):
        path = rrt.rrt_connect(cluttered, home, goal, 7, 0.04)
        if path is None or not cluttered.path_is_free(path):
            continue
        checked += 1
        short = rrt.shorten(cluttered, path, np.random.default_rng(0))
        assert np.array_equal(short[[0, -1]], path[[0, -1]])
        assert cluttered.path_is_free(short, FREE_MARGIN)
        assert length(short) <= length(path) + 1e-9
    assert checked


def length(path: Floats) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
