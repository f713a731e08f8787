"""What the times of a plan promise: any timed motion keeps it, and faster ones do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runtime.judge.limits import arm_fault, base_fault, finger_fault, finger_time, least_time
from runtime.motion import timing
from runtime.motion.motion import ArmMove
from runtime.robot.load import load_robot

ROBOT = load_robot("tiago")


@settings(max_examples=80, deadline=None)
@given(
    seed=st.integers(0, 10**6), corners=st.integers(0, 8), size=st.sampled_from([0.01, 0.2, 2.0])
)
def test_timed_paths_keep_what_the_format_promises(seed, corners, size) -> None:
    """Any polyline, timed, rounded as in files, is accepted; played a tenth faster, refused."""
    rng = np.random.default_rng(seed)
    path = ROBOT.home + np.cumsum(rng.normal(size=(corners + 2, len(ROBOT.joints))) * size, axis=0)
    path = np.clip(path, ROBOT.lower, ROBOT.upper)
    piece, times = timing.timed(ROBOT, ArmMove(path, "free"), 0.0)
    assert isinstance(piece, ArmMove)
    way, marks = np.round(piece.path, 6), np.round(times, 6)
    assert arm_fault(ROBOT, way, marks) is None
    if marks[-1] > 0.1:
        assert arm_fault(ROBOT, way, np.round(marks * 0.9, 6)) is not None


def test_a_speed_that_jumps_within_a_straight_motion_is_told() -> None:
    """One joint speeds up as it may, to 0.4 rad/s, and doubles that in one step."""
    joint, hard, tick = 3, float(ROBOT.acceleration[3]), 0.05
    ramp = [hard * tick * (i + 0.5) for i in range(2)]
    for jump, word in ((0.0, None), (0.4, "changes its speed faster")):
        speeds = np.array([*ramp, 0.4, 0.4 + jump, 0.4 + jump, 0.4, *ramp[::-1]])
        path = np.tile(ROBOT.home, (len(speeds) + 1, 1))
        path[1:, joint] += np.cumsum(speeds) * tick
        found = arm_fault(ROBOT, path, tick * np.arange(len(path)))
        assert (found is None) if word is None else (word in str(found)), found


@pytest.mark.parametrize(
    ("kind", "poses", "word"),
    [
        ("differential", [[0, 0, 0], [1, 0, 0], [1, 0, 1]], None),
        ("differential", [[0, 0, 0], [1, 0, 1]], "drives and turns"),
        ("differential", [[0, 0, 0], [0, 0.001, 0]], "sideways"),
        ("holonomic", [[0, 0, 0], [0, 1, 1]], None),
        ("fixed", [[0, 0, 0], [0, 0, 0]], None),
        ("fixed", [[0, 0, 0], [0.01, 0, 0]], "fixed"),
    ],
)
def test_bases_move_as_their_kind_can(kind, poses, word) -> None:
    base, rows = replace(ROBOT.base, type=kind), np.array(poses, dtype=float)
    found = base_fault(base, rows, np.arange(len(rows)) * 20.0)
    assert (found is None) if word is None else (word in str(found))


def test_a_turn_at_mean_speed_is_too_fast() -> None:
    """The case that a mean speed alone lets through: 0.80 rad in 0.88 s."""
    turn = np.array([[0, 0, 0], [0, 0, 0.8]], dtype=float)
    least = least_time(0.8, ROBOT.base.angular_velocity, ROBOT.base.angular_acceleration)
    assert least == pytest.approx(1.46, abs=0.01)
    assert "faster" in str(base_fault(ROBOT.base, turn, np.array([0.0, 0.88])))
    assert base_fault(ROBOT.base, turn, np.array([0.0, least])) is None


@settings(max_examples=50, deadline=None)
@given(distance=st.floats(1e-3, 10), velocity=st.floats(0.05, 2), acceleration=st.floats(0.05, 5))
def test_the_least_time_is_that_of_the_fastest_ride(distance, velocity, acceleration) -> None:
    """Ridden in small steps, as fast as goes and braked as late as goes."""
    gone = speed = seconds = 0.0
    step = least_time(distance, velocity, acceleration) / 4000
    while gone < distance * (1 - 1e-3) and seconds < 1e4:
        brakes = speed * speed / (2 * acceleration) >= distance - gone
        speed += (-1 if brakes else 1) * acceleration * step
        speed = min(velocity, max(speed, 1e-6))
        gone += speed * step
        seconds += step
    assert seconds == pytest.approx(least_time(distance, velocity, acceleration), rel=0.06)


def test_fingers_take_their_time() -> None:
    assert finger_time(ROBOT, 0.09, 0.0) == pytest.approx(0.9)
    assert finger_fault(ROBOT, 0.09, 0.0, 0.9) is None
    assert "faster" in str(finger_fault(ROBOT, 0.09, 0.0, 0.85))
    assert "faster" in str(finger_fault(ROBOT, 0.05, 0.04, 0.0))
    assert "cannot open" in str(finger_fault(ROBOT, 0.05, 0.1, 5.0))
