"""Exact contacts along motions."""

from __future__ import annotations

import numpy as np

from runtime.judge.contacts import Exact, Track, close_pairs
from tests.runtime.reference import Floats, homogeneous, random_pose, solid_box


def track(name: str, half: float, *positions: tuple[float, float, float]) -> Track:
    poses = np.tile(np.eye(4), (len(positions), 1, 1))
    poses[:, :3, 3] = positions
    return Track(name, solid_box(np.full(3, half)), poses)


def passing(count: int) -> Track:
    """A small box that flies from x = -1 to x = 1."""
    return track("ball", 0.05, *[(x, 0.0, 0.0) for x in np.linspace(-1, 1, count)])


def test_the_earliest_contact_is_found() -> None:
    late, early = track("late", 0.1, (0.5, 0.0, 0.0)), track("early", 0.1, (-0.5, 0.0, 0.0))
    ball = passing(201)
    hit = Exact().first_hit([(ball, late), (ball, early)])
    assert hit is not None
    assert (hit.first, hit.second) == ("ball", "early")
    assert -0.66 < ball.poses[hit.sample, 0, 3] < -0.64


def test_boxes_that_pass_by_do_not_touch() -> None:
    beside = track("beside", 0.1, (0.0, 0.16, 0.0))
    assert Exact().first_hit([(passing(201), beside)]) is None


def test_boxes_of_one_size_are_told_apart() -> None:
    """Shapes are shared between boxes of a size: both poses must count."""
    a, b = track("a", 0.05, (0.0, 0.0, 0.0)), track("b", 0.05, (1.0, 0.0, 0.0))
    assert Exact().first_hit([(a, b)]) is None
    assert Exact().first_hit([(a, track("b", 0.05, (0.09, 0.0, 0.0)))]) is not None


def test_bounds_hold_every_corner(rng) -> None:
    half = np.array([0.1, 0.2, 0.3])
    poses = np.array([homogeneous(random_pose(rng, 1.0)) for _ in range(50)])
    centre, extent = Track("box", solid_box(half), poses).bounds
    corner: Floats
    for sx in (-1, 1):
        for sy in (-1, 1):
            for sz in (-1, 1):
                corner = (poses @ [sx * 0.1, sy * 0.2, sz * 0.3, 1.0])[:, :3]
                assert np.all(np.abs(corner - centre) <= extent + 1e-12)


def test_pairs_that_touch_are_close(rng) -> None:
    """Sorting out by bounds loses no contact."""

    def random_track(samples: int) -> Track:
        poses = np.array([homogeneous(random_pose(rng, 0.5)) for _ in range(samples)])
        return Track("x", solid_box(rng.uniform(0.02, 0.15, 3)), poses)

    exact, dropped = Exact(), 0
    for _ in range(20):
        moving = [random_track(3) for _ in range(4)]
        standing = [random_track(1) for _ in range(6)]
        close = close_pairs(moving, standing)
        for pair in ((a, b) for a in moving for b in standing):
            if pair not in close:
                dropped += 1
                assert exact.first_hit([pair]) is None
    assert dropped
    assert close_pairs(moving, []) == []
