"""Inverse kinematics: what it calls solved is solved, and within the joint limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.kernels import ik
from runtime.motion.arm_context import ArmContext
from runtime.robot.model import RobotModel
from tests.runtime.reference import Floats, forward, homogeneous, random_uprights, turn_z


def solve(robot: RobotModel, target: Floats, q: Floats, iterations: int = 60) -> bool:
    chain, limits = robot.chain, (robot.lower, robot.upper)
    return bool(ik.solve(*chain, *limits, robot.tool, target, q, iterations, robot.ease))


def tool_pose(robot: RobotModel, q: Floats) -> Floats:
    return (forward(robot.chain, q)[-1] @ homogeneous(robot.tool))[:3]


def angle_between(a: Floats, b: Floats) -> float:
    cosine = (np.trace(a[:, :3].T @ b[:, :3]) - 1) / 2
    return math.acos(min(1.0, max(-1.0, cosine)))


def test_solutions_reach_the_target(robot, rng) -> None:
    solved = 0
    for _ in range(200):
        target = tool_pose(robot, rng.uniform(robot.lower, robot.upper))
        q = rng.uniform(robot.lower, robot.upper)
        if solve(robot, target, q):
            solved += 1
            found = tool_pose(robot, q)
            assert np.linalg.norm(found[:, 3] - target[:, 3]) < 2e-5
            assert angle_between(found, target) < 2e-4
    assert solved > 20


def test_joint_limits_hold_whether_solved_or_not(robot, rng) -> None:
    answers = set()
    for _ in range(200):
        target = tool_pose(robot, rng.uniform(robot.lower, robot.upper))
        q = rng.uniform(robot.lower, robot.upper)
        answers.add(solve(robot, target, q))
        assert np.all(q >= robot.lower)
        assert np.all(q <= robot.upper)
    assert answers == {True, False}


def test_targets_out_of_reach_are_not_solved(robot, rng) -> None:
    target = tool_pose(robot, robot.home)
    target[0, 3] += 5.0
    assert not solve(robot, target, robot.home.copy(), 200)


def test_a_configuration_at_its_target_is_left_alone(robot) -> None:
    q = robot.home.copy()
    assert solve(robot, tool_pose(robot, robot.home), q)
    assert np.array_equal(q, robot.home)


def test_a_near_target_is_found_from_nearby(robot, rng) -> None:
    for _ in range(50):
        inside = 0.1 * (robot.upper - robot.lower)
        goal = rng.uniform(robot.lower + inside, robot.upper - inside)
        q = goal + rng.uniform(-0.02, 0.02, len(goal))
        assert solve(robot, tool_pose(robot, goal), q)


@pytest.mark.parametrize("angle", [0.0, 1e-7, 0.3, 2.0, math.pi - 1e-6, math.pi])
def test_pose_error_is_the_rotation_vector(angle) -> None:
    """A turn about z: its vector is `angle` along z, half turns may choose the axis."""
    frame = np.eye(3, 4)
    target = np.column_stack([turn_z(angle), [0.1, -0.2, 0.3]])
    out = np.empty(6)
    position, found = ik.pose_error(frame, np.eye(3, 4), target, out)
    assert position == pytest.approx(math.sqrt(0.14))
    assert found == pytest.approx(angle, abs=1e-6)
    assert out[:3] == pytest.approx([0.1, -0.2, 0.3])
    assert np.linalg.norm(out[3:]) == pytest.approx(angle, abs=1e-6)
    if angle < math.pi - 1e-3:
        assert out[3:] == pytest.approx([0.0, 0.0, angle], abs=1e-6)


def test_the_first_free_solution_is_that_of_trying_one_after_the_other(robot, rng) -> None:
    """Also when it goes on after one that did not serve."""
    body = robot.body(0.05)
    found = []
    for _ in range(30):
        world = random_uprights(rng, 3, 1.0)
        target = tool_pose(robot, rng.uniform(robot.lower, robot.upper))
        seeds = rng.uniform(robot.lower, robot.upper, (6, len(robot.home)))
        context = ArmContext(robot, body, world)
        expected = []
        for i, seed in enumerate(seeds):
            q = seed.copy()
            if solve(robot, target, q, 60) and not context.collides(q, 0.001):
                expected.append((i, q))
        number = -1
        for i, q in [*expected, (-1, None)]:
            number = ik.first_free(
                robot.chain, robot.lower, robot.upper, robot.tool, target, seeds, number + 1, 60,
                robot.ease, body, context.obstacles, 0.001,
            )  # fmt: skip
            assert number == i
            if q is not None:
                assert np.array_equal(seeds[number], q)
        found.append(len(expected))
    assert max(found) > 1
