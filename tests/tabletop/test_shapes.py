"""What the shape of an object says about grasping it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from domains.tabletop.shapes import GRASP_HEIGHT, box_shape
from tests.runtime.reference import turn_z


@pytest.mark.parametrize("size", [(0.04, 0.04, 0.2), (0.05, 0.08, 0.12), (0.02, 0.06, 0.05)])
def test_width_is_that_of_the_box_seen_along_the_approach(size) -> None:
    shape = box_shape(size)
    outline = np.array([[sx * size[0] / 2, sy * size[1] / 2] for sx in (-1, 1) for sy in (-1, 1)])
    for angle in np.linspace(-math.pi, math.pi, 37):
        across = (outline @ turn_z(angle)[:2, :2])[:, 1]
        assert shape.width(angle) == pytest.approx(across.max() - across.min())


def test_low_objects_are_gripped_lower() -> None:
    assert box_shape((0.04, 0.04, 0.3)).grasp_height == GRASP_HEIGHT
    low = box_shape((0.04, 0.04, 0.06))
    assert 0.0 < low.grasp_height < 0.06


def test_square_boxes_look_the_same_after_a_quarter_turn() -> None:
    assert box_shape((0.04, 0.04, 0.2)).symmetry == 4
    assert box_shape((0.04, 0.05, 0.2)).symmetry == 2


def test_radii_are_inside_and_around() -> None:
    shape = box_shape((0.03, 0.04, 0.2))
    assert shape.inner_radius == pytest.approx(0.015)
    assert shape.outer_radius == pytest.approx(0.025)


@pytest.mark.parametrize("size", [(1e-6, 0.04, 0.2), (0.04, 0.04, 1e-6), (19.0, 0.001, 3.0)])
def test_extreme_boxes_have_a_shape(size) -> None:
    shape = box_shape(size)
    assert 0.0 < shape.grasp_height < size[2]
