"""Drives: from pose to pose, within limits, along the heading, clear of boxes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.angles import wrap
from runtime.judge.together import together_fault
from runtime.motion.course import TICK
from runtime.motion.drives import drives
from runtime.robot.load import load_robot

TIAGO, FRANKA = load_robot("tiago"), load_robot("franka_mobile")
NOTHING = np.zeros((0, 8)), np.zeros(0)

place = st.floats(-2.5, 2.5)
yaw = st.floats(-3.1, 3.1)
stand = st.tuples(place, place, yaw)


def fault(robot, rows: np.ndarray) -> str | None:
    count = len(rows)
    found = together_fault(
        robot,
        np.arange(count) * TICK,
        rows,
        np.tile(robot.home, (count, 1)),
        np.full(count, robot.gripper.max_opening),
    )
    return None if found is None else found[1]


@pytest.mark.parametrize("robot", [TIAGO, FRANKA], ids=["tiago", "franka_mobile"])
@given(start=stand, goal=stand)
def test_every_drive_ends_where_it_should_within_the_limits(robot, start, goal) -> None:
    found = drives(robot, start, goal, np.array([start, goal]), True, *NOTHING)
    for rows in found:
        assert rows[0] == pytest.approx(start)
        assert rows[-1, :2] == pytest.approx(goal[:2], abs=1e-9)
        assert abs(wrap(rows[-1, 2] - goal[2])) < 1e-3
        assert fault(robot, rows) is None
    assert len(found[0]) == min(map(len, found))


def test_turning_around_is_quicker_along_a_curve() -> None:
    """From a table to the one behind: not turn, drive and turn."""
    start, goal = (0.0, 0.0, 0.0), (-1.5, 0.4, math.pi)
    found = drives(TIAGO, start, goal, np.array([start, goal]), True, *NOTHING)
    assert len(found[0]) < 0.95 * len(found[-1])


def test_lines_are_driven_backwards_where_that_saves_turning() -> None:
    start, goal = (0.0, 0.0, 0.0), (-3.0, 0.0, 0.0)
    rows = drives(TIAGO, start, goal, np.array([start, goal]), True, *NOTHING)[-1]
    assert np.abs(rows[:, 2]).max() < 1e-9


@given(stand, stand)
def test_curves_keep_clear_of_boxes(start, goal) -> None:
    box = np.array([[0.0, 0.0, 0.5, 0.4, 0.3, 0.5, 1.0, 0.0]])
    found = drives(TIAGO, start, goal, np.array([start, goal]), True, box, np.array([0.5]))
    for rows in found[:-1]:
        out = np.maximum(np.abs(rows[:, :2]) - box[0, 3:5], 0.0)
        assert np.hypot(*out.T).min() > 0.5 - 0.03  # poses of a curve are tested, not all rows


def test_on_a_lane_the_known_way_is_kept() -> None:
    """Where the base cannot turn, it does not, whatever that would save."""
    known = np.array([[0.0, 0, 0], [-1, 0, 0], [-1, 0, 1.5], [-1, 1, 1.5]])
    (rows,) = drives(TIAGO, (0, 0, 0), (-1, 1, 1.5), known, False, *NOTHING)
    turning = np.abs(np.diff(rows[:, 2])) > 1e-9
    assert np.abs(rows[:-1][turning, 0] + 1).max() < 1e-9
