"""Smooth motions: they end where they should, keep every limit, and are near the least time."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.motion.course import (
    TICK,
    Limits,
    add,
    arm_limits,
    course,
    join,
    least_time,
    line,
    stretches,
    with_stops,
)
from runtime.robot.load import load_robot

ROBOT = load_robot("tiago")
LIMITS = arm_limits(ROBOT)


def differences(rows: np.ndarray) -> list[np.ndarray]:
    """The largest first, second and third differences a tick, with rest before and after."""
    padded = np.vstack([np.repeat(rows[:1], 3, 0), rows, np.repeat(rows[-1:], 3, 0)])
    return [np.abs(np.diff(padded, n, axis=0)).max(axis=0) / TICK**n for n in (1, 2, 3)]


def keeps(rows: np.ndarray, limits: Limits = LIMITS) -> bool:
    found = differences(rows)
    most = (limits.velocity, limits.acceleration, limits.jerk)
    return all((a <= b * 1.001 + 1e-9).all() for a, b in zip(found, most, strict=True))


def polyline(seed: int, points: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.uniform(ROBOT.lower, ROBOT.upper, (points, len(ROBOT.joints)))


@given(st.integers(0, 10_000), st.integers(2, 6))
def test_a_path_is_followed_to_its_end_within_all_limits(seed: int, points: int) -> None:
    path = polyline(seed, points)
    for rows in (course(path, LIMITS), with_stops(path, LIMITS)):
        assert np.array_equal(rows[0], path[0])
        assert rows[-1] == pytest.approx(path[-1], abs=1e-12)
        assert keeps(rows)


@given(st.integers(0, 10_000))
def test_with_stops_a_motion_is_on_the_path(seed: int) -> None:
    path = polyline(seed, 4)
    for row in with_stops(path, LIMITS):
        off = []
        for a, b in pairwise(path):
            share = np.clip((row - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            off.append(np.abs(row - a - share * (b - a)).max())
        assert min(off) < 1e-9


@given(st.floats(0.01, 5.0), st.floats(0.05, 3.0), st.floats(0.05, 5.0), st.floats(2.0, 50.0))
def test_a_line_takes_little_longer_than_it_must(
    distance: float, velocity: float, acceleration: float, share: float
) -> None:
    limits = Limits(*(np.array([v]) for v in (velocity, acceleration, share * acceleration)))
    took = TICK * (len(line(np.array([distance]), limits)) - 1)
    least = least_time(distance, velocity, acceleration, share * acceleration)
    # Never less; the average is taken over 2 a / j, and times are whole ticks.
    assert least - 1e-9 <= took
    assert took <= least * 1.15 + 2 / share + 3 * TICK


def test_the_least_time_is_that_of_an_integration_of_the_jerk() -> None:
    """Seven phases, integrated step by step, for limits that are reached and that are not."""
    for distance, v, a, j in ((2.0, 0.5, 1.0, 4.0), (0.01, 0.5, 1.0, 4.0), (0.3, 5.0, 1.0, 4.0)):
        best = math.inf
        for peak in np.linspace(1e-3, v, 4000):
            ramp = peak / a + a / j if peak * j >= a * a else 2 * math.sqrt(peak / j)
            if peak * ramp <= distance:
                best = min(best, distance / peak + ramp)
        assert least_time(distance, v, a, j) == pytest.approx(best, rel=2e-3)


@given(st.integers(0, 10_000), st.integers(2, 4))
def test_joined_motions_keep_the_limits_and_are_not_longer(seed: int, points: int) -> None:
    path = polyline(seed, points + 1)
    parts = [line(b - a, LIMITS) for a, b in pairwise(path)]
    rows, starts = join(parts, LIMITS)
    assert keeps(rows)
    assert rows[-1] - rows[0] == pytest.approx(path[-1] - path[0], abs=1e-9)
    assert starts == sorted(starts)
    assert len(rows) <= sum(len(part) - 1 for part in parts) + 1


def test_motions_are_joined_without_overlap_where_that_is_not_free() -> None:
    path = polyline(3, 3)
    parts = [line(b - a, LIMITS) for a, b in pairwise(path)]
    rows, starts = join(parts, LIMITS, lambda rows: False)
    assert starts == [0, len(parts[0]) - 1]
    assert np.abs(rows + path[0] - path[1]).max(axis=1).min() < 1e-9, "it passes the corner"


def test_sums_start_where_they_are_told_to() -> None:
    one, other = np.arange(4.0)[:, None], np.array([[5.0], [7.0]])
    assert add(one, other, 3)[:, 0].tolist() == [0, 1, 2, 3, 5]
    assert add(one, other, -1)[:, 0].tolist() == [2, 3, 4, 5]


def test_a_path_is_cut_at_sharp_corners_only() -> None:
    bend = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.1], [2.0, 1.0], [2.0, 1.0]])
    assert [len(part) for part in stretches(bend)] == [3, 2]
    assert stretches(bend[:1]) == []
