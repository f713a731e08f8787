"""Every pose of a drive is free of contact, among what is fixed and what stands about."""

from __future__ import annotations

import itertools
import math

import numpy as np

from runtime.motion.roads import Roads
from runtime.robot.model import RobotModel
from tests.runtime.reference import (
    Floats,
    fcl_touch,
    homogeneous,
    placed_boxes,
    turn_z,
    upright_pose,
    upright_row,
)


def touches(robot: RobotModel, roads: Roads, boxes: Floats, pose: Floats) -> bool:
    """Whether FCL sees the robot, in its home posture at a base pose (3,), touch a box."""
    base = homogeneous(np.column_stack([turn_z(pose[2]), [pose[0], pose[1], 0.0]]))
    placed = [base @ homogeneous(p) for p in placed_boxes(robot.chain, roads.body, robot.home)]
    return any(
        fcl_touch(p[:3], half, upright_pose(row), row[3:6])
        for p, half in zip(placed, roads.body.half, strict=True)
        for row in boxes
        if math.dist(row[:2], pose[:2]) < 2.5
    )


def dense(poses: Floats) -> Floats:
    return np.vstack([np.linspace(a, b, 12) for a, b in itertools.pairwise(poses)])


def test_drives_and_lanes_are_free_of_contact(robot, rng) -> None:
    """In a corridor, around posts, in and out of a bay in which there is no room to turn."""
    walls = [([1.5, side, 0.5], [0.5, 0.02, 0.5]) for side in (0.31, -0.31)]
    walls.append(([2.05, 0.0, 0.5], [0.05, 0.47, 0.5]))
    fixed = np.array([upright_row(np.array(c), np.array(h), 0.0) for c, h in walls])
    posts = np.array(
        [
            upright_row(np.array([x, y, 0.3]), np.array([0.1, 0.1, 0.3]), rng.uniform(0, 3))
            for x, y in ((-1.0, 0.3), (-0.6, -0.6), (0.2, 0.9), (-1.4, -0.5))
        ]
    )
    body = robot.body(robot.gripper.max_opening)
    bare = Roads.of(robot, body, fixed)
    roads, lanes, narrowed = bare.among(posts, None), 0, 0
    stands = [(1.4, 0.0, 0.0), (-0.2, -1.6, 1.0), (1.3, 0.0, 0.0), (0.4, 1.8, 0.0)]
    stands += [(x, y, yaw) for x, y, yaw in rng.uniform((-2, -2, 0), (0.8, 2, 6), (16, 3))]
    everything = np.vstack([fixed, posts])
    for start, goal in itertools.pairwise(stands):
        poses = roads.route(start, goal)
        narrowed += bare.route(start, goal) is not None and poses is None
        if poses is None:
            continue
        assert np.allclose(poses[0][:2], start[:2])
        assert np.allclose(poses[-1][:2], goal[:2])
        lanes += not roads.can_turn(*start[:2])
        assert not any(touches(robot, roads, everything, pose) for pose in dense(poses))
    assert lanes, "one of them leaves along a lane"
    assert narrowed, "what stands about is in the way of some"
