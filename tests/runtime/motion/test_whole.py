"""Base and arm as one chain: where they are, and what they touch, as for the arm alone."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from runtime.kernels import arm
from runtime.kernels.convex import boxes_only, seen_from
from runtime.motion.arm_context import FREE_MARGIN, ArmContext
from runtime.motion.whole import Whole, whole_chain, whole_sweep
from runtime.robot.load import load_robot
from tests.runtime.reference import random_uprights


@pytest.fixture(params=["tiago", "franka_mobile"])
def driver(request):
    return load_robot(request.param)


def rows_of(robot, rng, count: int) -> np.ndarray:
    """A random motion: a walk of base and arm in small steps."""
    step = np.concatenate([[0.02, 0.02, 0.03], np.full(len(robot.joints), 0.03)])
    first = np.concatenate([rng.uniform(-1.0, 1.0, 2), [rng.uniform(-3, 3)], robot.home])
    speed = rng.normal(size=len(step)) * step
    rows = first + np.arange(count)[:, None] * speed
    rows[:, 3:] = np.clip(rows[:, 3:], robot.lower, robot.upper)
    return rows


def test_frames_are_those_of_the_arm_at_its_base(driver, rng) -> None:
    chain = whole_chain(driver)
    for row in rows_of(driver, rng, 10):
        frames = np.empty((len(chain.prismatic) + 1, 3, 4))
        arm.forward(chain.origins, chain.prismatic, row, frames)
        c, s = math.cos(row[2]), math.sin(row[2])
        base = np.array([[c, -s, 0.0, row[0]], [s, c, 0.0, row[1]], [0.0, 0.0, 1.0, 0.0]])
        for own, found in zip(driver.frames(row[3:]), frames[3:], strict=True):
            wanted = np.hstack([base[:, :3] @ own[:, :3], base[:, :3] @ own[:, 3:] + base[:, 3:]])
            assert found == pytest.approx(wanted, abs=1e-9)


def test_no_part_moves_further_than_its_bound(driver, rng) -> None:
    chain, sweep = whole_chain(driver), whole_sweep(driver)
    body = driver.body(driver.gripper.max_opening)
    frames = np.empty((2, len(chain.prismatic) + 1, 3, 4))
    placed = np.empty((2, len(body.frame), 3, 4))
    for a, b in zip(rows_of(driver, rng, 12), rows_of(driver, rng, 12), strict=True):
        for i, row in enumerate((a, a + 0.01 * (b - a))):
            arm.forward(chain.origins, chain.prismatic, row, frames[i])
            arm.place_boxes(frames[i], body.frame + 3, body.pose, placed[i])
        moved = np.linalg.norm(placed[1, :, :, 3] - placed[0, :, :, 3], axis=1)
        bound = sweep[body.frame + 3] @ np.abs(0.01 * (b - a))
        assert (moved <= bound + 1e-9).all()


def test_motions_are_free_as_they_are_for_a_dense_look_at_each_sample(driver, rng) -> None:
    """The reference tests the arm in the frame of the base, sample by sample."""
    verdicts = []
    for _ in range(25):
        boxes = random_uprights(rng, 4, 1.5)
        boxes[:, 2] += 1.0  # off the floor
        obstacles = boxes_only(boxes)
        body = driver.body(driver.gripper.max_opening)
        rows = rows_of(driver, rng, 40)
        hit = Whole(driver, body, obstacles).first_hit(rows)
        touches = False
        for a, b in pairwise(rows):
            for share in (0.0, 0.5):
                row = a + share * (b - a)
                near = seen_from(obstacles, *row[:3].tolist(), np.inf)
                touches |= ArmContext(driver, body, near).collides(row[3:], FREE_MARGIN / 2)
        verdicts.append(hit is not None)
        if touches:
            assert hit is not None
    assert any(verdicts)


def test_the_floor_is_in_the_way_of_the_arm_but_not_of_the_base(driver) -> None:
    whole = Whole(driver, driver.body(0.02), boxes_only(np.empty((0, 8))))
    row = np.concatenate([np.zeros(3), driver.home])
    assert whole.first_hit(np.array([row, row])) is None
