"""Timing: limits hold, the path is followed, and nothing is slower than it has to be."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from runtime.motion import timing
from runtime.motion.motion import ArmMove, BaseMove, GripperMove
from runtime.robot.load import load_robot

ROBOT = load_robot("tiago")
JOINTS = len(ROBOT.joints)


def polylines(rng: np.random.Generator, points: int) -> NDArray[np.float64]:
    return rng.uniform(ROBOT.lower, ROBOT.upper, (points, JOINTS))


@pytest.mark.parametrize(
    ("distance", "seconds"), [(0.0, 0.0), (0.5, 2**0.5), (1.0, 2.0), (3.0, 4.0)]
)
def test_a_trapezoid_from_rest_to_rest(distance: float, seconds: float) -> None:
    assert timing.trapezoid(distance, 1.0, 1.0) == pytest.approx(seconds)


@given(st.integers(0, 10_000), st.integers(2, 7))
def test_velocities_and_accelerations_keep_their_limits(seed: int, points: int) -> None:
    path = polylines(np.random.default_rng(seed), points)
    way, times = timing.time_path(path, ROBOT.velocity, ROBOT.acceleration)
    steps = np.diff(times)
    assert (steps > 0).all()
    velocities = np.diff(way, axis=0) / steps[:, None]
    assert (np.abs(velocities) <= ROBOT.velocity * (1 + 1e-6)).all()
    # Velocity changes by no more than the acceleration allows between the middles of
    # neighbouring steps, and at a corner by what may change in its neighbourhood.
    change = np.abs(np.diff(velocities, axis=0))
    middle = (steps[1:] + steps[:-1]) / 2
    corner = np.sqrt(timing.BLEND * ROBOT.acceleration * 2) * 2
    slower = ROBOT.acceleration * middle[:, None] * (1 + 1e-6) + corner
    assert (change <= slower).all()


@given(st.integers(0, 10_000), st.integers(2, 7))
def test_every_way_point_is_on_the_path_and_the_corners_are_kept(seed: int, points: int) -> None:
    path = polylines(np.random.default_rng(seed), points)
    way, _ = timing.time_path(path, ROBOT.velocity, ROBOT.acceleration)
    for corner in path:
        assert np.abs(way - corner).max(axis=1).min() < 1e-9
    for point in way:
        assert min(_distance(point, a, b) for a, b in pairwise(path)) < 1e-9


def _distance(point: NDArray[np.float64], a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    along = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return float(np.linalg.norm(point - (a + along * (b - a))))


@given(st.integers(0, 10_000))
def test_one_line_takes_as_long_as_its_slowest_joint(seed: int) -> None:
    a, b = polylines(np.random.default_rng(seed), 2)
    _, times = timing.time_path(np.array([a, b]), ROBOT.velocity, ROBOT.acceleration)
    alone = [
        timing.trapezoid(distance, velocity, acceleration)
        for distance, velocity, acceleration in zip(
            np.abs(b - a), ROBOT.velocity, ROBOT.acceleration, strict=True
        )
    ]
    # The joints move together, so the line can take longer than each alone, never less, and
    # no longer than the tightest velocity and the tightest acceleration together.
    distance = np.abs(b - a)
    tightest = timing.trapezoid(
        1.0, (ROBOT.velocity / distance).min(), (ROBOT.acceleration / distance).min()
    )
    assert max(alone) - 1e-9 <= times[-1] == pytest.approx(tightest)


def test_a_needless_way_point_costs_no_time(rng: np.random.Generator) -> None:
    a, b = polylines(rng, 2)
    _, straight = timing.time_path(np.array([a, b]), ROBOT.velocity, ROBOT.acceleration)
    between = np.array([a, a + 0.3 * (b - a), a + 0.8 * (b - a), b])
    _, stopping = timing.time_path(between, ROBOT.velocity, ROBOT.acceleration)
    assert stopping[-1] == pytest.approx(straight[-1])


def test_a_path_that_goes_nowhere_takes_no_time() -> None:
    q = ROBOT.home
    way, times = timing.time_path(np.array([q, q, q]), ROBOT.velocity, ROBOT.acceleration)
    assert times.tolist() == [0.0, 0.0]
    assert (way == q).all()


def test_the_base_turns_and_drives_from_rest_to_rest() -> None:
    base = ROBOT.base
    poses = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 1.5]])
    piece, times = timing.timed(ROBOT, BaseMove(poses), 0.0)
    assert isinstance(piece, BaseMove)
    assert piece.poses is poses
    drive = timing.trapezoid(2.0, base.velocity, base.acceleration)
    turn = timing.trapezoid(1.5, base.angular_velocity, base.angular_acceleration)
    assert times == pytest.approx([0.0, drive, drive + turn])


def test_a_motion_lasts_as_long_as_its_pieces() -> None:
    lifted = ROBOT.home.copy()
    lifted[0] -= 0.1
    pieces = (ArmMove(np.array([ROBOT.home, lifted]), "lift"), GripperMove(0.05))
    lift = timing.trapezoid(0.1, float(ROBOT.velocity[0]), float(ROBOT.acceleration[0]))
    assert timing.duration(ROBOT, pieces) == pytest.approx(lift + ROBOT.gripper.time)
