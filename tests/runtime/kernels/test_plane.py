"""Distances in the floor plane against brute-force sampling."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.kernels import plane
from runtime.motion.room import room_around
from tests.runtime import reference
from tests.runtime.reference import random_uprights


def test_point_distance_agrees_with_its_plain_twin(rng) -> None:
    for row in random_uprights(rng, 500, 0.5):
        x, y = rng.uniform(-1, 1, 2)
        expected = reference.point_distance(row, x, y)
        assert plane.point_distance(row, x, y) == pytest.approx(expected, abs=1e-12)


def test_segment_distance_agrees_with_points_on_the_segment(rng) -> None:
    kinds = set()
    for row in random_uprights(rng, 1000, 0.5):
        start, end = rng.uniform(-1, 1, 2), rng.uniform(-1, 1, 2)
        found = plane.segment_distance(row, *start, *end)
        sampled = reference.segment_distance(row, start, end)
        kinds.add(found == 0.0)
        step = np.linalg.norm(end - start) / 2000
        assert sampled - step <= found <= sampled + 1e-12
    assert kinds == {True, False}


@pytest.mark.parametrize("yaw", [0.0, math.pi / 2, 0.4])
def test_segments_along_the_sides_of_a_box(yaw) -> None:
    row = reference.upright_row(np.array([0.2, 0.1, 0.0]), np.array([0.3, 0.2, 0.1]), yaw)
    for side in (-0.25, -0.2, 0.0, 0.2, 0.25):
        ends = np.array([[-0.5, side, 0.0], [0.5, side, 0.0]]) @ reference.turn_z(yaw).T
        ends += row[:3]
        expected = max(0.0, abs(side) - 0.2)
        found = plane.segment_distance(row, *ends[0, :2], *ends[1, :2])
        assert found == pytest.approx(expected, abs=1e-12)


def test_a_segment_of_no_length_is_a_point(rng) -> None:
    for row in random_uprights(rng, 200, 0.5):
        x, y = rng.uniform(-1, 1, 2)
        expected = plane.point_distance(row, x, y)
        assert plane.segment_distance(row, x, y, x, y) == pytest.approx(expected, abs=1e-12)


def test_clearance_zero_lets_the_robot_pass(rng) -> None:
    boxes = random_uprights(rng, 1, 0.0)
    x, y = boxes[0, :2]
    assert plane.point_is_clear(boxes, np.zeros(1), x, y)
    assert plane.segment_is_clear(boxes, np.zeros(1), x - 1, y, x + 1, y)
    assert not plane.point_is_clear(boxes, np.full(1, 0.1), x, y)
    assert not plane.segment_is_clear(boxes, np.full(1, 0.1), x - 1, y, x + 1, y)


def test_clear_means_every_clearance_is_kept(rng) -> None:
    for _ in range(300):
        boxes = random_uprights(rng, 4, 0.8)
        clearance = rng.uniform(0.0, 0.2, 4) * rng.integers(0, 2, 4)
        ends = rng.uniform(-1, 1, (2, 2))
        point = all(
            need == 0 or reference.point_distance(row, *ends[0]) >= need
            for row, need in zip(boxes, clearance, strict=True)
        )
        assert plane.point_is_clear(boxes, clearance, *ends[0]) == point
        line = [
            reference.segment_distance(row, *ends) - need
            for row, need in zip(boxes, clearance, strict=True)
            if need > 0
        ]
        slack = min(line, default=1.0)
        if abs(slack) > 0.002:  # sampling cannot tell closer than that
            assert plane.segment_is_clear(boxes, clearance, *ends.ravel()) == (slack > 0)


def test_a_room_is_what_hangs_together_with_its_start(rng) -> None:
    boxes = random_uprights(rng, 6, 1.0)
    clearance = np.full(6, 0.2)
    start = np.array([2.0, 2.0])
    room = room_around(boxes, clearance, *start)
    answers = set()
    for point in rng.uniform(-2, 2, (400, 2)):
        expected = reference.in_room(room, point)
        answers.add(expected)
        assert plane.in_room(*room.floor, *point) == expected
    assert answers == {True, False}


def test_cells_of_a_grid_are_clear_where_their_centres_are(rng) -> None:
    boxes = random_uprights(rng, 4, 0.5)
    clearance = np.full(4, 0.1)
    kinds: set[int] = set()
    grid = plane.grid(boxes, clearance, -1.0, -0.8, 0.1, 20, 16)
    for i in range(20):
        for j in range(16):
            centre = -1.0 + (i + 0.5) * 0.1, -0.8 + (j + 0.5) * 0.1
            clear = all(reference.point_distance(row, *centre) >= 0.1 for row in boxes)
            assert (grid[i, j] != plane.BLOCKED) == clear
            around = centre + 0.05 * rng.uniform(-1, 1, (9, 2))
            all_clear = all(
                reference.point_distance(row, *point) >= 0.1 for row in boxes for point in around
            )
            assert all_clear or grid[i, j] != plane.CLEAR
            kinds.add(int(grid[i, j]))
    assert len(kinds) == 3
