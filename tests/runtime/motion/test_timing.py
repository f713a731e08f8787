"""When the robot is where: limits of speed and acceleration hold on every line."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from runtime.motion import timing
from runtime.motion.motion import ArmMove, BaseMove, GripperMove


@pytest.mark.parametrize(
    ("distance", "seconds"),
    [
        (0.0, 0.0),
        (0.25, 1.0),  # half way at full acceleration, half way braking
        (1.0, 2.0),  # just reaches full speed
        (3.0, 4.0),  # one second to speed up, two at full speed, one to brake
    ],
)
def test_trapezoid(distance, seconds) -> None:
    assert timing.trapezoid(distance, 1.0, 1.0) == pytest.approx(seconds)


def test_no_line_is_done_faster_than_any_joint_can(robot, rng) -> None:
    for _ in range(100):
        path = rng.uniform(robot.lower, robot.upper, (4, len(robot.joints)))
        times = timing.times(robot, ArmMove(path, "free"))
        assert times[0] == 0.0
        for a, b, seconds in zip(path[:-1], path[1:], np.diff(times), strict=True):
            alone = [
                timing.trapezoid(distance, velocity, acceleration)
                for distance, velocity, acceleration in zip(
                    np.abs(b - a), robot.velocity, robot.acceleration, strict=True
                )
            ]
            assert seconds >= max(alone) - 1e-9


def test_speed_and_acceleration_along_a_line_keep_the_limits(robot, rng) -> None:
    """Positions of the trapezoid, sampled; differences are speeds and accelerations."""
    for _ in range(20):
        a, b = rng.uniform(robot.lower, robot.upper, (2, len(robot.joints)))
        seconds = timing.times(robot, ArmMove(np.array([a, b]), "free"))[-1]
        velocity = (robot.velocity / np.abs(b - a)).min()
        acceleration = (robot.acceleration / np.abs(b - a)).min()
        t = np.linspace(0, seconds, 2001)
        up = np.minimum(acceleration * t, velocity)
        speed = np.minimum(up, np.maximum(acceleration * (seconds - t), 0.0))
        travelled = np.trapezoid(speed, t)
        assert travelled == pytest.approx(1.0, abs=1e-3)
        assert np.all(speed.max() * np.abs(b - a) <= robot.velocity * (1 + 1e-9))


def test_a_base_turns_and_drives_within_its_limits(robot) -> None:
    base = robot.base
    poses = np.array([[0, 0, 0], [2.0, 0, 0], [2.0, 0, 1.5], [2.0, 0, 1.5]])
    times = timing.times(robot, BaseMove(poses))
    drive, turn, rest = np.diff(times)
    assert drive == pytest.approx(timing.trapezoid(2.0, base.velocity, base.acceleration))
    assert turn == pytest.approx(
        timing.trapezoid(1.5, base.angular_velocity, base.angular_acceleration)
    )
    assert rest == 0.0


def test_a_way_point_that_is_repeated_takes_no_time(robot) -> None:
    path = np.array([robot.home, robot.home])
    assert timing.times(robot, ArmMove(path, "free")).tolist() == [0.0, 0.0]


def test_the_duration_of_a_motion_is_that_of_its_pieces(robot) -> None:
    moved = robot.home.copy()
    moved[0] -= 0.1
    motion = (
        ArmMove(np.array([robot.home, moved]), "free"),
        GripperMove(0.05),
        ArmMove(np.array([moved, robot.home]), "free"),
    )
    lift = timing.trapezoid(0.1, robot.velocity[0], robot.acceleration[0])
    expected = 2 * lift + robot.gripper.time
    assert timing.duration(robot, motion) == pytest.approx(expected)


def test_times_never_fall(robot, rng) -> None:
    path = rng.uniform(robot.lower, robot.upper, (20, len(robot.joints)))
    path[5] = path[4]
    times = timing.times(robot, ArmMove(path, "free"))
    assert all(a <= b for a, b in itertools.pairwise(times))
    assert math.isfinite(times[-1])
