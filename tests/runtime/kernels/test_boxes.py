"""The separating-axis kernels against FCL."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.kernels import boxes
from tests.runtime.reference import (
    Floats,
    boxes_overlap,
    corners,
    fcl_distance,
    fcl_touch,
    point_distance,
    random_pose,
    turn_z,
    upright_pose,
    upright_row,
)

PAIRS = 4000
EDGE = 1e-6
"""Metres by which FCL and the kernels may disagree on where contact begins."""


def random_pair(rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """A free box (pose, half extents) and an upright one near it."""
    half = rng.uniform(0.01, 0.3, 3)
    row = upright_row(
        rng.uniform(-0.3, 0.3, 3), rng.uniform(0.01, 0.3, 3), rng.uniform(-math.pi, math.pi)
    )
    return random_pose(rng, 0.3), half, row


def aligned_pair(rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Two boxes with parallel edges whose faces lie in one plane, or nearly so."""
    half, other = rng.uniform(0.01, 0.3, 3), rng.uniform(0.01, 0.3, 3)
    yaw = rng.uniform(-math.pi, math.pi)
    offset = rng.uniform(-1.0, 1.0, 3) * (half + other)
    axis = rng.integers(3)
    gap = rng.choice([-1e-4, -1e-5, 1e-5, 1e-4])
    offset[axis] = rng.choice([-1.0, 1.0]) * (half[axis] + other[axis] + gap)
    rotation = turn_z(yaw)
    centre = rng.uniform(-0.3, 0.3, 3)
    pose = np.column_stack([rotation, centre + rotation @ offset])
    return pose, half, upright_row(centre, other, yaw)


def upright_hit(pose: Floats, half: Floats, row: Floats, margin: float) -> bool:
    radius = float(np.linalg.norm(half))
    return bool(boxes.pose_vs_upright(pose, half, radius, row, margin))


def pose_hit(pose: Floats, half: Floats, row: Floats, margin: float) -> bool:
    return bool(boxes.pose_vs_pose(upright_pose(row), row[3:6], pose, half, margin))


KERNELS = pytest.mark.parametrize("hit", [upright_hit, pose_hit])
SHAPES = pytest.mark.parametrize("sample", [random_pair, aligned_pair])


@KERNELS
@SHAPES
def test_boxes_touch_where_fcl_says_so(hit, sample, rng) -> None:
    answers = set()
    for _ in range(PAIRS):
        pose, half, row = sample(rng)
        touch = fcl_touch(pose, half, upright_pose(row), row[3:6])
        found = hit(pose, half, row, 0.0)
        answers.add(touch)
        if found != touch:
            # Only where contact just begins: shrunk or grown a little, both agree.
            assert fcl_touch(pose, half + EDGE, upright_pose(row), row[3:6])
            assert not hit(pose, half - EDGE, row, 0.0)
    assert answers == {True, False}


@KERNELS
def test_faces_that_coincide_count_as_contact(hit) -> None:
    half = np.array([0.1, 0.2, 0.3])
    row = upright_row(np.zeros(3), half, 0.0)
    for axis in range(3):
        pose = np.eye(3, 4)
        pose[axis, 3] = 2 * half[axis]
        assert hit(pose, half, row, 0.0)
        pose[axis, 3] += 1e-6
        assert not hit(pose, half, row, 0.0)


@KERNELS
@SHAPES
@pytest.mark.parametrize("margin", [0.001, 0.02, 0.1])
def test_nothing_within_the_margin_is_missed(hit, sample, margin, rng) -> None:
    for _ in range(PAIRS // 4):
        pose, half, row = sample(rng)
        if not hit(pose, half, row, margin):
            assert fcl_distance(pose, half, upright_pose(row), row[3:6]) >= margin - 1e-5


@KERNELS
@pytest.mark.parametrize("margin", [0.001, 0.02, 0.1])
def test_nothing_beyond_the_corner_of_the_margin_counts(hit, margin, rng) -> None:
    for _ in range(PAIRS // 4):
        pose, half, row = random_pair(rng)
        if hit(pose, half, row, margin):
            distance = fcl_distance(pose, half, upright_pose(row), row[3:6])
            assert distance <= math.sqrt(3.0) * margin + 1e-5


@KERNELS
def test_kernels_agree_with_their_plain_twin(hit, rng) -> None:
    for _ in range(PAIRS // 4):
        pose, half, row = random_pair(rng)
        margin = float(rng.uniform(0.0, 0.1))
        grown = row[3:6] + margin
        assert hit(pose, half, row, margin) == boxes_overlap(pose, half, upright_pose(row), grown)


def upright_gap(pose: Floats, half: Floats, row: Floats, enough: float) -> float:
    radius = float(np.linalg.norm(half))
    return float(boxes.gap_to_upright(pose, half, radius, row, enough))


def pose_gap(pose: Floats, half: Floats, row: Floats, enough: float) -> float:
    return float(boxes.gap_to_pose(upright_pose(row), row[3:6], pose, half))


@pytest.mark.parametrize("gap", [upright_gap, pose_gap])
@SHAPES
def test_gap_never_exceeds_the_distance(gap, sample, rng) -> None:
    positive = 0
    for _ in range(PAIRS // 4):
        pose, half, row = sample(rng)
        found = gap(pose, half, row, 10.0)
        positive += found > 0.0
        distance = fcl_distance(pose, half, upright_pose(row), row[3:6])
        assert found <= distance + 1e-5
    assert positive


def test_gap_that_is_cut_short_is_a_bound_as_well(rng) -> None:
    for _ in range(PAIRS // 4):
        pose, half, row = random_pair(rng)
        enough = float(rng.uniform(0.0, 0.2))
        distance = fcl_distance(pose, half, upright_pose(row), row[3:6])
        assert upright_gap(pose, half, row, enough) <= distance + 1e-5


def test_base_frame_moves_boxes_rigidly(rng) -> None:
    world = np.array([random_pair(rng)[2] for _ in range(50)])
    x, y, yaw = 0.3, -0.2, 0.7
    inverse = turn_z(-yaw)
    moved = boxes.to_base_frame(world, x, y, yaw, math.inf)
    for before, after in zip(world, moved, strict=True):
        expected = (corners(upright_pose(before), before[3:6]) - [x, y, 0.0]) @ inverse.T
        assert corners(upright_pose(after), after[3:6]) == pytest.approx(expected)


def test_base_frame_keeps_exactly_the_boxes_within_reach(rng) -> None:
    world = np.array([random_pair(rng)[2] for _ in range(200)])
    for reach in (0.05, 0.2, 0.4):
        kept = boxes.to_base_frame(world, 0.1, 0.1, 0.5, reach)
        near = sum(point_distance(row, 0.1, 0.1) <= reach for row in world)
        assert len(kept) == near
