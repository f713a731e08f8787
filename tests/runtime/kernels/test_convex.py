"""Distances of solids against optimisation, contacts against FCL."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from runtime.kernels import convex
from runtime.kernels.convex import join, seen_from
from runtime.world.body import Body, Part
from runtime.world.packed import pack_bodies, pack_shapes, upright_row
from runtime.world.poses import Pose, compose, identity, upright
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from tests.runtime import reference
from tests.runtime.reference import random_pose
from tests.runtime.solids import KINDS, exact_distance, fcl_touch, hull_of, random_solid

PAIRS = list(itertools.combinations_with_replacement(KINDS, 2))
EXACTLY = 1e-6


def distance(
    a: Solid, pose_a: Pose, b: Solid, pose_b: Pose, near: float = 0.0, enough: float = math.inf
) -> float:
    shapes = pack_shapes([a, b])
    found: float = convex.gjk_distance(
        shapes.solids[0], shapes.vertices, pose_a, shapes.solids[1], shapes.vertices, pose_b,
        near, enough, convex.TOLERANCE,
    )  # fmt: skip
    return found


def near_pair(rng: np.random.Generator, a: Solid, b: Solid) -> tuple[Pose, Pose]:
    """Poses of two solids, from deep inside one another to well apart."""
    size = float(np.linalg.norm(a.half) + np.linalg.norm(b.half))
    return random_pose(rng, 0.0), random_pose(rng, size * rng.uniform(0.1, 1.2))


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_distances_are_those_of_an_optimisation(first, second, rng) -> None:
    apart = 0
    for _ in range(4 if "cylinder" in (first, second) else 12):
        a, b = random_solid(rng, first, corners=10), random_solid(rng, second, corners=10)
        pose_a, pose_b = near_pair(rng, a, b)
        expected = exact_distance(a, pose_a, b, pose_b)
        apart += expected > 0.001
        found = distance(a, pose_a, b, pose_b)
        assert found <= expected + EXACTLY
        assert found >= expected - EXACTLY or expected < 2 * EXACTLY
    assert apart


def never_free_where_fcl_sees_contact(rng: np.random.Generator, number: int) -> int:
    """How many of a number of random pairs touch; the kernel is asked about all of them."""
    touching = 0
    for _ in range(number):
        a, b = random_solid(rng), random_solid(rng)
        pose_a, pose_b = near_pair(rng, a, b)
        margin = 1e-5
        gap = distance(a, pose_a, b, pose_b, near=margin, enough=margin)
        if fcl_touch(a, pose_a, b, pose_b):
            touching += 1
            assert gap <= margin, (a, pose_a, b, pose_b)
    return touching


def test_what_touches_for_fcl_is_never_free(rng) -> None:
    assert never_free_where_fcl_sees_contact(rng, 3000) > 300


@pytest.mark.slow
def test_what_touches_for_fcl_is_never_free_a_million_times() -> None:
    rng = np.random.default_rng(5)
    assert never_free_where_fcl_sees_contact(rng, 1_000_000) > 100_000


@pytest.mark.parametrize("kind", KINDS)
def test_early_ends_stay_below_the_distance_and_say_what_was_asked(kind, rng) -> None:
    for _ in range(60):
        a, b = random_solid(rng, kind), random_solid(rng)
        poses = near_pair(rng, a, b)
        full = distance(a, poses[0], b, poses[1])
        limit = float(rng.uniform(0.0, 0.5))
        bound = distance(a, poses[0], b, poses[1], near=limit, enough=limit)
        assert bound <= full + EXACTLY
        assert (bound <= limit) == (full <= limit) or abs(full - limit) < EXACTLY


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_apart_is_free_without_a_margin(kind, rng) -> None:
    """A margin of nothing asks for contact itself; a first bound of 0 does not tell."""
    apart = 0
    for _ in range(40):
        a, b = random_solid(rng, kind), random_solid(rng)
        poses = near_pair(rng, a, b)
        full = distance(a, poses[0], b, poses[1])
        touches = distance(a, poses[0], b, poses[1], near=0.0, enough=0.0) <= 0.0
        assert touches == (full <= 0.0) or full < EXACTLY
        apart += full > 0.0
    assert apart


SMALL = Box((0.02, 0.02, 0.02))
KNOWN = [
    (Box((1.0, 1.0, 1.0)), (0.0, 0.0, 0.51 + 0.1), 0.1),
    (Cylinder(0.3, 1.0), (0.31 + 0.2, 0.0, 0.0), 0.2),
    (Cylinder(0.3, 1.0), (0.0, 0.0, 0.51 + 0.1), 0.1),
    (Cylinder(0.3, 1.0), (0.0, 0.3, 0.5), 0.0),
    (Sphere(0.3), (0.0, 0.31 + 0.4, 0.0), 0.4),
    (Capsule(0.1, 1.0), (0.0, 0.0, 0.61 + 0.05), 0.05),
    (Capsule(0.1, 1.0), (0.11 + 0.05, 0.0, 0.3), 0.05),
    (hull_of(np.vstack([np.eye(3), np.zeros((1, 3))])), (0.5, 0.5, 0.5), None),
]


@pytest.mark.parametrize(("solid", "at", "expected"), KNOWN)
def test_distances_that_are_known(solid, at, expected) -> None:
    pose = upright(*at, 0.0)
    if expected is None:
        expected = exact_distance(solid, identity(), SMALL, pose)
    assert distance(solid, identity(), SMALL, pose) == pytest.approx(expected, abs=EXACTLY)


def test_solids_that_share_a_middle_touch(rng) -> None:
    for a, b in itertools.product(KINDS, KINDS):
        pose = random_pose(rng, 0.5)
        assert distance(random_solid(rng, a), pose, random_solid(rng, b), pose) == 0.0


def test_rows_hold_their_solids(rng) -> None:
    for kind in KINDS:
        for _ in range(20):
            solid, pose = random_solid(rng, kind), random_pose(rng, 1.0)
            row = upright_row(solid, pose)
            grown = Box(tuple((2 * row[3:6] + 1e-9).tolist()))
            assert _inside(solid, pose, grown, reference.upright_pose(row))


def _inside(solid: Solid, pose: Pose, box: Box, box_pose: Pose) -> bool:
    """Whether no wall around a box is touched by the solid."""
    for axis, side in itertools.product(range(3), (-1.0, 1.0)):
        shift = np.zeros(3)
        shift[axis] = side * (box.half[axis] + 1.0)
        wall = box_pose.copy()
        wall[:, 3] += box_pose[:, :3] @ shift
        if distance(solid, pose, Box((9.0, 9.0, 9.0)), _thick(wall, axis, side)) == 0.0:
            return False
    return True


def _thick(wall: Pose, axis: int, side: float) -> Pose:
    moved = wall.copy()
    moved[:, 3] += wall[:, axis] * side * 3.5
    return moved


def test_boxes_on_their_sides_are_exactly_their_rows(rng) -> None:
    lying = np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.3]])
    bodies = pack_bodies([Body((Part(Box((0.1, 0.2, 0.3))), Part(Sphere(0.1))), 1.0, (0, 0, 0))])
    pose = compose(upright(1.0, 2.0, 0.0, 0.4), lying)
    found = bodies.at(0, pose)
    assert found.shape.tolist() == [convex.EXACT, 1]
    assert sorted(2 * found.rows[0, 3:6]) == pytest.approx([0.1, 0.2, 0.3])
    tilted = bodies.at(0, random_pose(rng, 1.0))
    assert tilted.shape.tolist() == [0, 1]


def test_obstacles_seen_from_a_base_keep_their_distances(rng) -> None:
    bodies = pack_bodies(
        [
            Body((Part(random_solid(rng, kind), random_pose(rng, 0.2)),), 1.0, (0, 0, 0))
            for kind in KINDS
        ]
    )
    around = join(*(bodies.at(i, random_pose(rng, 1.0)) for i in range(len(KINDS))))
    around = join(convex.boxes_only(reference.random_uprights(rng, 2, 1.0)), around)
    x, y, yaw = 0.3, -0.2, 0.7
    seen = seen_from(around, x, y, yaw, math.inf)
    back = upright(x, y, 0.0, yaw)
    for i in range(len(around.rows)):
        assert compose(back, reference.upright_pose(seen.rows[i])) == pytest.approx(
            reference.upright_pose(around.rows[i])
        )
        if around.shape[i] >= 0:
            assert compose(back, seen.pose[i]) == pytest.approx(around.pose[i])
    few = seen_from(around, 50.0, 50.0, 0.0, 1.0)
    assert len(few.rows) == len(few.shape) == 0


def test_hulls_keep_corners_only() -> None:
    hull = hull_of(np.vstack([reference.corners(identity(), np.full(3, 0.5)), np.zeros((1, 3))]))
    assert len(hull.corners) == 8
    assert isinstance(hull, Hull)
