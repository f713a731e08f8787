"""How far solids reach, and rays through them, against their triangles."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from runtime.judge.contacts import Exact, Track
from runtime.judge.extents import along_y, lowest
from runtime.show.meshes import triangles
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from tests.runtime.reference import homogeneous, random_pose

SOLIDS: list[Solid] = [
    Box((0.1, 0.2, 0.3)),
    Cylinder(0.05, 0.2),
    Sphere(0.07),
    Capsule(0.04, 0.1),
    Hull(((0.1, 0, 0), (-0.1, 0.05, 0), (-0.1, -0.05, 0.02), (0, 0, 0.1), (0.02, 0.03, -0.1))),
]
SMOOTH = 2e-3
"""Metres by which triangles miss a round side."""


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda s: type(s).__name__)
def test_the_lowest_point_is_that_of_the_triangles(solid, rng) -> None:
    vertices, _ = triangles(solid)
    poses = np.array([homogeneous(random_pose(rng, 1.0)) for _ in range(30)])
    found = lowest(solid, poses)
    for pose, height in zip(poses, found, strict=True):
        expected = (vertices @ pose[:3, :3].T + pose[:3, 3])[:, 2].min()
        assert expected - SMOOTH <= height <= expected + 1e-9


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda s: type(s).__name__)
def test_triangles_enclose_the_volume(solid) -> None:
    mesh = trimesh.Trimesh(*triangles(solid))
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(solid.volume, rel=0.03)
    assert mesh.volume > 0


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda s: type(s).__name__)
def test_rays_enter_and_leave_where_points_are_inside(solid, rng) -> None:
    """FCL says which points, as tiny balls, touch the solid."""
    exact, ball = Exact(), Sphere(1e-4)
    pose = homogeneous(random_pose(rng, 0.05))
    x, z = rng.uniform(-0.2, 0.2, 200), rng.uniform(-0.2, 0.2, 200)
    low, high = along_y(solid, pose, x, z)
    assert np.isfinite(low).any()
    assert not np.isfinite(low).all()
    track = Track("solid", solid, pose[None])
    for i in range(len(x)):
        y = rng.uniform(-0.3, 0.3)
        gap = max(low[i] - y, y - high[i])
        if abs(gap) < 1e-3:
            continue
        place = np.eye(4)
        place[:3, 3] = x[i], y, z[i]
        touches = exact.first_hit([(track, Track("ball", ball, place[None]))]) is not None
        assert touches == (gap < 0)
