"""Meshes that are stacks of prisms against the polygons that they are made of."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from runtime.world.body import Mesh
from runtime.world.decompose import decompose
from runtime.world.layers import ROUNDED, layers_of
from runtime.world.mesh import mesh_of
from runtime.world.poses import Floats
from runtime.world.solids import Box

CORNERS = 11


def star(rng: np.random.Generator, least: float, most: float) -> Floats:
    """A closed line around the origin, convex or not."""
    turns = (np.arange(CORNERS) + rng.uniform(-0.3, 0.3, CORNERS)) * 2 * np.pi / CORNERS
    radii = rng.uniform(least, most, CORNERS)
    return np.column_stack([radii * np.cos(turns), radii * np.sin(turns)])


def sides(loop: Floats, low: float, high: float) -> Mesh:
    """The upright sides between two heights; level faces say nothing that is not known."""
    n = len(loop)
    corners = np.vstack([np.column_stack([loop, np.full(n, z)]) for z in (low, high)])
    after = (np.arange(n) + 1) % n
    lower = np.column_stack([np.arange(n), after, after + n])
    upper = np.column_stack([np.arange(n), after + n, np.arange(n) + n])
    return Mesh(corners, np.vstack([lower, upper]))


def together(*meshes: Mesh) -> Mesh:
    shift = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [np.asarray(mesh.faces) + s for mesh, s in zip(meshes, shift, strict=False)]
    return Mesh(np.vstack([mesh.vertices for mesh in meshes]), np.vstack(faces))


def inside(points: Floats, loop: Floats) -> Floats:
    """Which points (n, 2) are inside of a closed line, by how often it winds around them."""
    to = loop[None] - points[:, None]
    angles = np.arctan2(to[..., 1], to[..., 0])
    turned = np.diff(np.column_stack([angles, angles[:, :1]]), axis=1)
    return np.abs(((turned + np.pi) % (2 * np.pi) - np.pi).sum(axis=1)) > np.pi


def within(points: Floats, pieces: list[Floats]) -> Floats:
    found = np.zeros(len(points), dtype=bool)
    for piece in pieces:
        hull = ConvexHull(piece).equations
        found |= (points @ hull[:, :3].T + hull[:, 3] < 1e-9).all(axis=1)
    return found


def away(points: Floats, loop: Floats, by: float) -> Floats:
    """Which points are so far from a closed line."""
    a, b = loop, np.roll(loop, -1, axis=0)
    share = ((points[:, None] - a) * (b - a)).sum(axis=2) / ((b - a) ** 2).sum(axis=1)
    nearest = a + np.clip(share, 0, 1)[..., None] * (b - a)
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1) > by


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_pieces_take_up_the_inside_and_leave_holes_but_for_their_corners(seed) -> None:
    rng = np.random.default_rng(seed)
    outer, hole, knob = star(rng, 0.06, 0.1), star(rng, 0.02, 0.05), star(rng, 0.01, 0.02)
    mesh = together(sides(outer, 0.0, 0.05), sides(hole, 0.0, 0.05), sides(knob, 0.05, 0.09))
    pieces = layers_of(mesh)
    assert pieces is not None
    filled = ROUNDED * np.ptp(mesh.vertices, axis=0).max()
    points = rng.uniform(-0.1, 0.1, (400, 2))
    plate = inside(points, outer) & ~inside(points, hole)
    for z, there in ((0.02, plate), (0.07, inside(points, knob))):
        found = within(np.column_stack([points, np.full(len(points), z)]), pieces)
        lines = [outer, hole] if z < 0.05 else [knob]
        clear = np.logical_and.reduce([away(points, line, filled + 1e-6) for line in lines])
        assert (found == there)[clear].all()
        beside = np.logical_and.reduce([away(points, line, 1e-5) for line in lines])
        assert found[there & beside].all()  # solid only ever grows
    assert not within(np.column_stack([points, np.full(len(points), 0.1)]), pieces).any()


def test_a_mesh_that_is_convex_is_one_piece() -> None:
    (piece,) = layers_of(mesh_of(Box((0.1, 0.2, 0.3)))) or ()
    assert np.ptp(piece, axis=0) == pytest.approx([0.1, 0.2, 0.3])


def test_what_leans_or_is_open_is_left_to_others() -> None:
    mesh = mesh_of(Box((0.1, 0.2, 0.3)))
    leaning = np.array(mesh.vertices)
    leaning[leaning[:, 2] > 0, 0] *= 0.5
    assert layers_of(Mesh(leaning, mesh.faces)) is None
    loop = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]])
    walls = sides(loop, 0.0, 0.1)
    assert layers_of(Mesh(walls.vertices, np.asarray(walls.faces)[:-1])) is None


def test_a_ring_stays_open() -> None:
    ring = trimesh.creation.annulus(0.02, 0.05, 0.03)
    parts = decompose(Mesh(np.array(ring.vertices), np.array(ring.faces)), watertight=True)
    corners = [part.solid.points + part.pose[:, 3] for part in parts]
    middle = np.array([[0.0, 0.0, 0.0], [0.015, 0.0, 0.0], [0.03, 0.0, 0.0]])
    assert within(middle, corners).tolist() == [False, False, True]
    assert sum(part.solid.volume for part in parts) == pytest.approx(ring.volume, rel=0.03)
