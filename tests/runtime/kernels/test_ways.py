"""Shortest ways by way points, against Floyd and Warshall over all lines that are clear."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from runtime.kernels import plane
from runtime.kernels.ways import shortest_way
from tests.runtime.reference import random_uprights


def lengths(boxes, clearance, points) -> np.ndarray:
    """The length of the shortest way between any two points, infinite where there is none."""
    count = len(points)
    found = np.full((count, count), np.inf)
    for i, j in itertools.product(range(count), repeat=2):
        if i == j or plane.segment_is_clear(boxes, clearance, *points[i], *points[j]):
            found[i, j] = math.dist(points[i], points[j])
    for via in range(count):
        found = np.minimum(found, found[:, via, None] + found[None, via])
    return found


def test_ways_are_clear_and_no_longer_than_the_shortest(rng) -> None:
    kinds = set()
    for _ in range(60):
        boxes = random_uprights(rng, 8, 1.0)
        clearance = rng.uniform(0.02, 0.12, 8)
        points = rng.uniform(-1, 1, (14, 2))
        expected = lengths(boxes, clearance, points)[-2, -1]
        way = shortest_way(boxes, clearance, points)
        kinds.add(min(len(way), 4))
        if not len(way):
            assert math.isinf(expected)
            continue
        assert (way[0], way[-1]) == (12, 13)
        for i, j in itertools.pairwise(way):
            assert plane.segment_is_clear(boxes, clearance, *points[i], *points[j])
        length = sum(math.dist(points[i], points[j]) for i, j in itertools.pairwise(way))
        assert length == pytest.approx(expected)
    assert kinds == {0, 2, 3, 4}


def test_what_is_far_keeps_its_clearance(rng) -> None:
    seen = 0
    for _ in range(400):
        (box,) = random_uprights(rng, 1, 1.0)
        ends = rng.uniform(-1, 1, 4)
        if plane.is_far(box, 0.1, *ends):
            seen += 1
            assert plane.segment_distance(box, *ends) >= 0.1
    assert 50 < seen < 350
