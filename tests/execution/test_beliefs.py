"""Where the robot takes objects to be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from domains.tabletop.loop.beliefs import STEADY, TURNED, Beliefs
from domains.tabletop.loop.sensing import Seen
from runtime.trace.model import Trace


@pytest.fixture
def beliefs(trace: Trace) -> Beliefs:
    return Beliefs(trace.world, 0.0)


def seen(beliefs: Beliefs, pose: np.ndarray, held: int | None = None) -> np.ndarray:
    """What is believed of object 0 when it is seen at a pose."""
    poses = (pose, *beliefs.poses[1:])
    return beliefs.of(Seen(np.zeros(3), poses, held)).objects[0]


def aside(pose: np.ndarray, by: float, up: float = 0.0) -> np.ndarray:
    return pose + np.array([by, 0.0, up, 0.0, 0.0, 0.0, 0.0])


def turned(pose: np.ndarray, yaw: float) -> np.ndarray:
    return np.array([*pose[:3], 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)])


def test_what_is_seen_where_it_is_expected_is_exactly_there(beliefs) -> None:
    start = beliefs.poses[0].copy()
    for pose in (aside(start, 0.8 * STEADY, -0.002), turned(start, 0.8 * TURNED)):
        assert np.array_equal(seen(beliefs, pose), start)


def test_small_shifts_do_not_add_up_unseen(beliefs) -> None:
    start = beliefs.poses[0].copy()
    for step in range(1, 5):
        found = seen(beliefs, aside(start, 0.4 * STEADY * step))
    assert found[0] > start[0] + STEADY


@pytest.mark.parametrize(("by", "up"), [(2 * STEADY, 0.0), (0.0, 0.05)])
def test_what_is_seen_elsewhere_is_there_from_then_on(beliefs, by, up) -> None:
    moved = aside(beliefs.poses[0], by, up)
    assert np.array_equal(seen(beliefs, moved), moved)
    assert np.array_equal(seen(beliefs, aside(moved, 0.3 * STEADY)), moved)


def test_what_turned_or_leans_is_as_it_is_seen(beliefs) -> None:
    start = beliefs.poses[0].copy()
    leaning = np.array([*start[:3], math.sin(TURNED), 0.0, 0.0, math.cos(TURNED)])
    for pose in (turned(start, 2 * TURNED), leaning):
        assert np.array_equal(seen(beliefs, pose), pose)


def test_an_object_that_was_put_down_is_expected_where_it_was_to_be(beliefs) -> None:
    there = aside(beliefs.poses[0], 1.0)
    beliefs.expect(0, there)
    assert np.array_equal(seen(beliefs, aside(there, 0.5 * STEADY)), there)


def test_what_is_held_is_where_it_is_seen(beliefs) -> None:
    near = aside(beliefs.poses[0], 0.1 * STEADY)
    assert np.array_equal(seen(beliefs, near, held=0), near)
