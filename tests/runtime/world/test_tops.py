"""Where things can rest on objects."""

from __future__ import annotations

import math

import numpy as np
import pytest

from runtime.world.making import open_box, standing
from runtime.world.poses import compose
from runtime.world.snap import resting_pose
from runtime.world.solids import Box, Capsule, Cylinder, Sphere
from runtime.world.stable import stable_poses
from runtime.world.tops import top_of
from tests.runtime.reference import corners
from tests.runtime.solids import hull_of

AIR = 0.002


def test_a_cube_bears_on_whichever_side_is_up(rng) -> None:
    body = standing(Box((0.06, 0.08, 0.1)))
    for stable in stable_poses(body):
        top = top_of("cube", body, stable, AIR)
        assert top is not None
        there = compose(resting_pose(stable, 0.4, 0.1, 0.7, 0.3), top.pose)
        assert there[:, 3] == pytest.approx([0.4, 0.1, 0.7 + stable.height + AIR])
        assert there[2, :3] == pytest.approx([0.0, 0.0, 1.0])
        assert sorted(top.half) == pytest.approx(sorted(stable.half))


def test_a_can_bears_what_is_inside_of_its_circle_and_not_when_it_lies() -> None:
    body = standing(Cylinder(0.04, 0.1))
    up, _, lying = stable_poses(body)
    top = top_of("can", body, up, AIR)
    assert top is not None
    assert math.hypot(*top.half) == pytest.approx(0.04)
    assert top_of("can", body, lying, AIR) is None


def test_in_a_tray_things_rest_on_the_floor_between_the_walls() -> None:
    body = open_box((0.3, 0.2, 0.05), 0.01)
    top = top_of("tray", body, stable_poses(body)[0], AIR)
    assert top is not None
    assert top.pose[:, 3] == pytest.approx([0.0, 0.0, 0.012])
    assert sorted(top.half) == pytest.approx([0.09, 0.14])


@pytest.mark.parametrize(
    "body",
    [
        standing(Box((0.04, 0.04, 0.2))),
        standing(Box((0.02, 0.2, 0.02))),
        standing(Sphere(0.1)),
        standing(Capsule(0.1, 0.2)),
    ],
    ids=["stick", "narrow", "ball", "pill"],
)
def test_nothing_rests_on_what_is_slender_narrow_or_round(body) -> None:
    assert top_of("it", body, stable_poses(body)[0], AIR) is None


def test_the_rectangle_on_a_hull_is_inside_of_its_top(rng) -> None:
    angles = np.arange(7) * 2 * np.pi / 7
    ring = np.column_stack([0.1 * np.cos(angles), 0.07 * np.sin(angles)])
    prism = np.vstack([np.column_stack([ring, np.full(7, z)]) for z in (0.0, 0.06)])
    body = standing(hull_of(prism))
    top = top_of("prism", body, stable_poses(body)[0], AIR)
    assert top is not None
    from scipy.spatial import ConvexHull

    outline = ConvexHull(body.parts[0].solid.points[:, :2]).equations
    rectangle = corners(top.pose, np.array([*top.half, 0.0]))[:, :2]
    assert np.all(outline[:, :2] @ rectangle.T + outline[:, 2:] <= 1e-9)
