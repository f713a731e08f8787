"""The home that is proposed: free, folded, ahead, and the same way round whatever is drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.robot.load import load_robot
from runtime.robot.propose.home import propose_home
from runtime.robot.propose.pairs import touching
from runtime.world.poses import compose

ROBOTS = ("ur5e_desk", "franka_mobile", "tiago")


@pytest.fixture(scope="module", params=[(name, seed) for name in ROBOTS for seed in (0, 1)])
def proposed(request):
    """A robot, and what is proposed for it by a seed."""
    name, seed = request.param
    robot = load_robot(name)
    home = propose_home(robot, np.random.default_rng(seed))
    assert home is not None
    return robot, home


def first_turning(robot) -> int:
    return next(k for k, slides in enumerate(robot.chain.prismatic) if not slides)


def test_it_is_within_limits_and_free(proposed) -> None:
    robot, home = proposed
    assert (home > robot.lower).all()
    assert (home < robot.upper).all()
    assert not touching(robot, home[None])


def test_the_first_joint_hardly_turns(proposed) -> None:
    robot, home = proposed
    first = first_turning(robot)
    nearest = np.clip(0.0, robot.lower[first], robot.upper[first])
    assert abs(home[first] - nearest) < 0.35


def test_the_whole_arm_is_near_its_shoulder_and_the_hand_ahead(proposed) -> None:
    """No joint is further out or up than three fifths of the arm's length, links end to end."""
    robot, home = proposed
    frames, first = robot.frames(home), first_turning(robot)
    length = np.linalg.norm(robot.chain.origins[first + 1 :, :, 3], axis=1).sum()
    shoulder = frames[first + 1, :, 3]
    away = np.linalg.norm(frames[first + 1 :, :, 3] - shoulder, axis=1)
    assert away.max() < 0.6 * length
    tool = compose(frames[-1], robot.tool)
    assert tool[0, 3] > -0.05
    assert abs(math.atan2(tool[1, 3], tool[0, 3])) < math.pi / 3


def test_no_joint_is_near_its_limit(proposed) -> None:
    robot, home = proposed
    room = np.minimum(home - robot.lower, robot.upper - home) / (robot.upper - robot.lower)
    assert room.min() > 0.06


def test_a_wanted_posture_is_taken_where_it_is_free_only() -> None:
    robot = load_robot("ur5e_desk")
    rng = np.random.default_rng(0)
    blocked = next(
        q
        for q in rng.uniform(robot.lower, robot.upper, (400, len(robot.home)))
        if touching(robot, q[None])
    )
    taken = propose_home(robot, rng, [blocked, robot.home])
    assert taken is not None
    assert np.array_equal(taken, robot.home)
