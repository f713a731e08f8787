"""The judge's own kinematics: independent of the planner's, equal to it."""

from __future__ import annotations

import numpy as np

from runtime.judge.skeleton import Skeleton
from tests.runtime.reference import placed_boxes, turn_z


def test_boxes_are_where_the_planner_has_them(robot, rng) -> None:
    skeleton = Skeleton(robot)
    for opening in (0.0, 0.05):
        body = robot.body(opening)
        q = rng.uniform(robot.lower, robot.upper)
        x, y, yaw = rng.uniform(-1, 1, 3)
        links = skeleton.transforms(np.array([[x, y, yaw]]), q[None], opening)
        base = np.eye(4)
        base[:3, :3], base[:2, 3] = turn_z(yaw), (x, y)
        expected = [
            (placed.link, base[:3] @ np.vstack([pose, [0, 0, 0, 1]]))
            for placed, pose in zip(robot.parts, placed_boxes(robot.chain, body, q), strict=True)
        ]
        found = skeleton.tracks(links)
        assert len(found) == len(expected)
        for track in found:
            near = [pose for link, pose in expected if link == track.owner]
            assert any(np.allclose(track.poses[0, :3], pose, atol=1e-9) for pose in near)


def test_many_configurations_at_once_are_each_one_alone(robot, rng) -> None:
    skeleton = Skeleton(robot)
    base = rng.uniform(-1, 1, (5, 3))
    q = rng.uniform(robot.lower, robot.upper, (5, len(robot.joints)))
    openings = rng.uniform(0, 0.09, 5)
    together = skeleton.transforms(base, q, openings)
    for i in range(5):
        alone = skeleton.transforms(base[i : i + 1], q[i : i + 1], float(openings[i]))
        for link, poses in alone.items():
            assert np.allclose(np.broadcast_to(together[link], (5, 4, 4))[i], poses[0])


def test_links_that_never_move_against_each_other_may_touch(robot) -> None:
    skeleton = Skeleton(robot)
    assert skeleton.may_touch("base_link", "torso_fixed_link")
    assert skeleton.may_touch("arm_3_link", "arm_4_link")
    assert not skeleton.may_touch("arm_4_link", "torso_lift_link")
    assert not skeleton.may_touch("gripper_left_finger_link", "base_link")
