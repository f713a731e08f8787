"""Kinematics against PyBullet, collision against FCL."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from runtime.kernels import arm, between
from runtime.kernels.convex import boxes_only
from runtime.motion.arm_context import ArmContext
from runtime.robot import load
from runtime.robot.model import RobotModel
from runtime.robot.urdf import Box
from tests.runtime import reference
from tests.runtime.reference import Floats, along, arm_distance, arm_touches, random_uprights

HELD = Box("held", np.column_stack([np.eye(3), [0.0, 0.0, 0.02]]), np.array([0.02, 0.02, 0.1]))
POLE = Box("held", np.column_stack([np.eye(3), [0.0, 0.0, 0.5]]), np.array([0.01, 0.01, 0.6]))
BODIES = pytest.mark.parametrize("held", [None, HELD], ids=["open", "holding"])


def random_q(robot: RobotModel, rng: np.random.Generator) -> Floats:
    return rng.uniform(robot.lower, robot.upper)


def frames_of(robot: RobotModel, q: Floats) -> Floats:
    frames = np.empty((len(q) + 1, 3, 4))
    arm.forward(*robot.chain, q, frames)
    return frames


@pytest.fixture(scope="module")
def bullet(robot: RobotModel) -> Iterator[Callable[[Floats], dict[str, Floats]]]:
    """Poses (3, 4) of all links, by PyBullet from the same URDF."""
    pybullet = pytest.importorskip("pybullet")
    client = pybullet.connect(pybullet.DIRECT)
    urdf = Path(load.BUILT_IN) / robot.name / f"{robot.name}.urdf"
    body = pybullet.loadURDF(str(urdf), useFixedBase=True, physicsClientId=client)
    infos = [
        pybullet.getJointInfo(body, i, physicsClientId=client)
        for i in range(pybullet.getNumJoints(body, physicsClientId=client))
    ]
    number = {info[1].decode(): i for i, info in enumerate(infos)}
    link = {info[12].decode(): i for i, info in enumerate(infos)}

    def poses(q: Floats) -> dict[str, Floats]:
        for name, value in zip(robot.joints, q, strict=True):
            pybullet.resetJointState(body, number[name], float(value), physicsClientId=client)
        found = {}
        for name, i in link.items():
            state = pybullet.getLinkState(
                body, i, computeForwardKinematics=True, physicsClientId=client
            )
            rotation = np.array(pybullet.getMatrixFromQuaternion(state[5])).reshape(3, 3)
            found[name] = np.column_stack([rotation, state[4]])
        return found

    yield poses
    pybullet.disconnect(client)


def test_forward_kinematics_agrees_with_pybullet(robot, bullet, rng) -> None:
    for _ in range(100):
        q = random_q(robot, rng)
        assert robot.tool_pose(q) == pytest.approx(bullet(q)[robot.urdf_tool], abs=1e-6)


def test_forward_kinematics_agrees_with_its_plain_twin(robot, rng) -> None:
    for _ in range(50):
        q = random_q(robot, rng)
        expected = np.array(reference.forward(robot.chain, q))[:, :3]
        assert frames_of(robot, q) == pytest.approx(expected, abs=1e-12)


@BODIES
def test_boxes_are_placed_as_by_the_plain_twin(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    q = random_q(robot, rng)
    placed = np.empty((len(body.frame), 3, 4))
    arm.place_boxes(frames_of(robot, q), body.frame, body.pose, placed)
    assert placed == pytest.approx(np.array(reference.placed_boxes(robot.chain, body, q)))


def test_jacobian_agrees_with_finite_differences(robot, rng) -> None:
    step = 1e-6
    for _ in range(30):
        q = random_q(robot, rng)
        tool = robot.tool_pose(q)
        found = np.empty((6, len(q)))
        arm.jacobian(frames_of(robot, q), robot.chain.prismatic, tool[:, 3].copy(), found)
        for k in range(len(q)):
            moved = q.copy()
            moved[k] += step
            after = robot.tool_pose(moved)
            velocity = (after[:, 3] - tool[:, 3]) / step
            spin = (after[:, :3] @ tool[:, :3].T - np.eye(3)) / step
            angular = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
            assert found[:, k] == pytest.approx([*velocity, *angular], abs=1e-5)


@BODIES
def test_every_contact_that_fcl_sees_is_a_collision(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    world = random_uprights(rng, 8, 1.2)
    context = ArmContext(robot, body, world)
    touching = 0
    for _ in range(150):
        q = random_q(robot, rng)
        if arm_touches(robot.chain, body, world, q):
            touching += 1
            assert context.collides(q, 0.0)
    assert touching


@BODIES
def test_a_collision_is_at_most_the_margin_away(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    context = ArmContext(robot, body, random_uprights(rng, 3, 1.2))
    margin = 0.01
    hits = 0
    for _ in range(150):
        q = random_q(robot, rng)
        if context.collides(q, margin):
            hits += 1
            gap = arm_distance(robot.chain, body, context.around, q)
            assert gap <= math.sqrt(3.0) * margin + 1e-5
    assert 0 < hits < 150


def test_the_robot_does_not_collide_in_its_home_posture(robot) -> None:
    for opening in (0.0, robot.gripper.max_opening):
        context = ArmContext(robot, robot.body(opening), np.empty((0, 8)))
        assert not context.collides(robot.home)
        assert not arm_touches(robot.chain, context.body, context.around, robot.home)


def test_boxes_of_the_base_meet_the_world_in_body_collides_only(robot) -> None:
    world = np.array([reference.upright_row(np.array([0.0, 0.0, 0.1]), np.full(3, 0.05), 0.0)])
    body = robot.body(0.05)
    placed = np.array(reference.placed_boxes(robot.chain, body, robot.home))
    assert arm.body_collides(body, placed, boxes_only(world), 0.0)
    assert not ArmContext(robot, body, world).collides(robot.home)


@BODIES
def test_paths_that_pass_keep_half_the_margin_in_between(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    margin = 0.01
    free = 0
    for _ in range(25):
        context = ArmContext(robot, body, random_uprights(rng, 4, 1.2))
        path = np.array([random_q(robot, rng) for _ in range(2)])
        path[1] = path[0] + (path[1] - path[0]) * rng.uniform(0.02, 0.4)
        if context.path_is_free(path, margin):
            free += 1
            for q in along(path, 25):
                gap = arm_distance(robot.chain, body, context.around, q)
                assert gap >= margin / 2 - 1e-5
    assert free


@BODIES
def test_paths_are_refused_for_something_within_reach_of_the_margin(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    margin = 0.01
    refused = 0
    for _ in range(12):
        context = ArmContext(robot, body, random_uprights(rng, 2, 1.0))
        path = np.array([random_q(robot, rng), random_q(robot, rng)])
        path[1] = path[0] + (path[1] - path[0]) * 0.2
        if not context.path_is_free(path, margin):
            refused += 1
            gaps = [arm_distance(robot.chain, body, context.around, q) for q in along(path, 200)]
            assert min(gaps) <= math.sqrt(3.0) * margin + 0.005
    assert refused


def test_the_segment_that_collides_is_named(robot) -> None:
    body = robot.body(0.05)
    nudge = np.zeros(len(robot.home))
    nudge[1] = 0.5
    tool = robot.tool_pose(robot.home + nudge)
    world = np.array([reference.upright_row(tool[:, 3], np.full(3, 0.02), 0.0)])
    free = robot.home - 0.2 * nudge
    path = np.array([free, robot.home - 0.1 * nudge, free, robot.home + nudge])
    context = ArmContext(robot, body, world)
    assert context.first_barred(path) == 2


@pytest.mark.parametrize("held", [None, HELD, POLE], ids=["open", "holding", "pole"])
def test_sweep_bounds_how_far_each_box_moves(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    sweep = ArmContext(robot, body, np.empty((0, 8))).sweep
    for _ in range(40):
        q = random_q(robot, rng)
        before = reference.placed_boxes(robot.chain, body, q)
        for joint in range(len(q)):
            moved = q.copy()
            moved[joint] = rng.uniform(robot.lower[joint], robot.upper[joint])
            after = reference.placed_boxes(robot.chain, body, moved)
            for b, frame in enumerate(body.frame):
                travel = np.linalg.norm(
                    reference.corners(after[b], body.half[b])
                    - reference.corners(before[b], body.half[b]),
                    axis=1,
                ).max()
                bound = sweep[frame, joint] * abs(moved[joint] - q[joint])
                assert travel <= bound + 1e-9


def test_paths_with_a_long_pole_keep_half_the_margin_in_between(robot, rng) -> None:
    """Its end moves further for a turn of a joint than that of what is usually held."""
    body = robot.body(0.05, POLE)
    margin = 0.01
    free = 0
    for _ in range(25):
        context = ArmContext(robot, body, random_uprights(rng, 5, 1.8))
        start = random_q(robot, rng)
        path = np.array([start, start + (random_q(robot, rng) - start) * 0.15])
        if context.path_is_free(path, margin):
            free += 1
            for q in along(path, 25):
                gap = arm_distance(robot.chain, body, context.around, q)
                assert gap >= margin / 2 - 1e-5
    assert free


@pytest.mark.parametrize("held", [None, POLE], ids=["open", "pole"])
def test_bend_bounds_how_far_corners_leave_the_straight_line(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    sweep = ArmContext(robot, body, np.empty((0, 8))).sweep
    largest = 0.0
    for _ in range(40):
        start = random_q(robot, rng)
        end = start + (random_q(robot, rng) - start) * rng.uniform(0.02, 0.6)
        ends = [reference.placed_boxes(robot.chain, body, q) for q in (start, end)]
        for share in (0.25, 0.5, 0.8):
            placed = reference.placed_boxes(robot.chain, body, start + share * (end - start))
            for b, frame in enumerate(body.frame):
                corners = [reference.corners(at[b], body.half[b]) for at in (*ends, placed)]
                straight = (1 - share) * corners[0] + share * corners[1]
                away = np.linalg.norm(corners[2] - straight, axis=1).max()
                bound = between.bend(robot.chain.prismatic, sweep, 0, frame, start, end)
                assert away <= bound + 1e-9
                largest = max(largest, away / max(bound, 1e-9))
    assert largest > 0.05  # the bound says something


def test_a_plane_that_is_clear_at_both_poses_is_a_gap_between_the_boxes(rng) -> None:
    said = 0
    for _ in range(200):
        half_a, half_b = rng.uniform(0.02, 0.3, 3), rng.uniform(0.02, 0.3, 3)
        before = reference.random_pose(rng, 0.8)
        after = before.copy()
        after[:, 3] += rng.normal(size=3) * 0.05
        found = between.clearance(before, after, half_a, half_b)
        if found <= 0.0:
            continue
        said += 1
        own = reference.corners(np.eye(4)[:3], half_a)
        for share in (0.0, 0.4, 1.0):
            pose = before.copy()
            pose[:, 3] += share * (after[:, 3] - before[:, 3])
            hull = reference.corners(pose, half_b)
            gaps = [np.linalg.norm(p - q) for p in own for q in hull]
            assert found <= min(gaps) + 1e-9
    assert said > 20


@BODIES
def test_something_tiny_that_is_passed_anywhere_on_the_way_is_found(robot, held, rng) -> None:
    body = robot.body(0.05, held)
    alone = ArmContext(robot, body, np.empty((0, 8)))
    moving = np.flatnonzero(body.frame > 0)
    thin = moving[np.argsort(body.half[moving].min(axis=1))[:3]]  # soon past it
    met = 0
    for _ in range(150):
        path = np.array([random_q(robot, rng), random_q(robot, rng)])
        if not alone.path_is_free(path):
            continue
        q = path[0] + rng.uniform() * (path[1] - path[0])
        placed = reference.placed_boxes(robot.chain, body, q)[rng.choice(thin)]
        speck = np.array([reference.upright_row(placed[:, 3], np.full(3, 0.001), 0.0)])
        met += 1
        assert not ArmContext(robot, body, speck).path_is_free(path)
    assert met > 20
