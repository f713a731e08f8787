"""Approach directions: the kernels behind the features against direct twins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from domains.tabletop.features import swept
from runtime.motion.room import room_around
from tests.runtime import reference
from tests.runtime.reference import (
    Floats,
    bits_of,
    headings_of,
    random_uprights,
    turn_z,
    upright_row,
)

SHOULDER = np.array([0.093, 0.014])
SIDE_HAND = np.array(
    [
        [-0.063, 0.022, -0.012, 0.012, -0.012, 0.012, 1.0],
        [-0.4, -0.063, -0.068, 0.068, -0.05, 0.2, 0.0],
    ]
)
"""Fingers and what is behind them, of a hand that comes in horizontally."""

PINCH_HAND = np.array(
    [
        [-0.06, 0.02, -0.012, 0.012, -0.012, 0.012, 2.0],
        [-0.3, -0.06, -0.05, 0.05, -0.07, 0.07, 0.0],
        [-0.5, -0.3, -0.04, 0.06, 0.0, 0.25, 0.0],
    ]
)
HANDS = (SIDE_HAND, PINCH_HAND)
OWN = np.array([0.01, 0.2])


def random_headings(rng: np.random.Generator) -> set[int]:
    return set(np.flatnonzero(rng.random(swept.HEADINGS) < 0.4).tolist())


def random_hold(rng: np.random.Generator) -> Floats:
    """Half widths of an object, and where its grasp centre is, across every heading (K, 3)."""
    half = rng.uniform(0.01, 0.05, swept.HEADINGS)
    return np.column_stack([half, rng.uniform(-0.04, 0.04, (swept.HEADINGS, 2))])


def plain_hold(half: float) -> Floats:
    """Something round that is gripped in its middle."""
    return np.tile([half, 0.0, 0.0], (swept.HEADINGS, 1))


def random_neighbour(rng: np.random.Generator) -> Floats:
    """An object within half a metre, somewhat above or below (8,)."""
    centre = np.array([*rng.uniform(-0.35, 0.35, 2), rng.uniform(-0.3, 0.5)])
    half = np.array([*rng.uniform(0.01, 0.06, 2), rng.uniform(0.01, 0.15)])
    return upright_row(centre, half, rng.uniform(-math.pi, math.pi))


def barred(site: Floats, hold: Floats, height: float, row: Floats, hand: Floats) -> set[int]:
    """What the kernel says."""
    found = swept.barred_matrix(
        site[None], hold[None], np.array([height]), OWN[None], row[None], hand, 0.0
    )
    return headings_of(int(found[0, 0]))


def twin(site: Floats, hold: Floats, height: float, row: Floats, hand: Floats) -> set[int]:
    """What its plain twin says."""
    return reference.barred_headings(site, hold, height, OWN, row, hand, swept.PLAY, swept.LEVEL)


def moved(row: Floats, angle: float, shift: Floats) -> Floats:
    """A packed box turned about the origin, then shifted."""
    c, s = math.cos(angle), math.sin(angle)
    turned = row.copy()
    turned[:2] = turn_z(angle)[:2, :2] @ row[:2] + shift
    turned[6:] = c * row[6] - s * row[7], s * row[6] + c * row[7]
    return turned


@pytest.mark.parametrize("hand", HANDS)
def test_barred_headings_agree_with_the_plain_twin(hand, rng) -> None:
    sizes = set()
    for _ in range(1000):
        site, hold, row = rng.uniform(-0.3, 0.3, 3), random_hold(rng), random_neighbour(rng)
        height = rng.uniform(0.0, 0.2)
        found = barred(site, hold, height, row, hand)
        assert found == twin(site, hold, height, row, hand)
        sizes.add(len(found))
    assert {0, swept.HEADINGS} < sizes


@pytest.mark.parametrize("hand", HANDS)
def test_barred_headings_turn_with_the_scene(hand, rng) -> None:
    for _ in range(300):
        hold, row = random_hold(rng), random_neighbour(rng)
        steps = int(rng.integers(swept.HEADINGS))
        turned = moved(row, steps * swept.STEP, np.zeros(2))
        before = barred(np.zeros(3), hold, 0.1, row, hand)
        after = barred(np.zeros(3), np.roll(hold, steps, axis=0), 0.1, turned, hand)
        assert after == {(k + steps) % swept.HEADINGS for k in before}


def test_barred_headings_do_not_depend_on_where_the_scene_is(rng) -> None:
    for _ in range(300):
        hold, row, shift = random_hold(rng), random_neighbour(rng), rng.uniform(-3, 3, 3)
        here = barred(np.zeros(3), hold, 0.1, row, SIDE_HAND)
        there = moved(row, 0.0, shift[:2])
        there[2] += shift[2]
        assert barred(shift, hold, 0.1, there, SIDE_HAND) == here


def test_something_larger_bars_at_least_as_much(rng) -> None:
    for _ in range(300):
        hold, row = random_hold(rng), random_neighbour(rng)
        larger = row.copy()
        larger[3:6] += 0.02
        less = barred(np.zeros(3), hold, 0.1, row, SIDE_HAND)
        assert less <= barred(np.zeros(3), hold, 0.1, larger, SIDE_HAND)


def test_something_behind_the_object_does_not_bar_the_way_to_it() -> None:
    """The gripper comes from the west (heading 0); the other object stands east."""
    hold, site = plain_hold(0.02), np.array([0.0, 0.0, 0.75])
    east = upright_row(np.array([0.1, 0.0, 0.85]), np.array([0.02, 0.02, 0.1]), 0.0)
    west = moved(east, math.pi, np.zeros(2))
    assert 0 not in barred(site, hold, 0.1, east, SIDE_HAND)
    assert 0 in barred(site, hold, 0.1, west, SIDE_HAND)


def test_something_on_a_board_above_or_below_bars_nothing() -> None:
    site, half = np.array([0.0, 0.0, 0.75]), np.array([0.3, 0.3, 0.1])
    for z in (0.55, 1.25):
        row = upright_row(np.array([0.0, 0.0, z]), half, 0.0)
        assert barred(site, plain_hold(0.02), 0.1, row, SIDE_HAND) == set()


def test_matrix_is_every_pair_whatever_the_size_of_the_objects(rng) -> None:
    """From 2 cm to 3 m: no constant bounds from how far away something can bar the way."""
    seen = set()
    for hand in HANDS:
        for _ in range(10):
            sites = rng.uniform(-1.5, 1.5, (6, 3)) * [1, 1, 0.1]
            holds = np.array([random_hold(rng) for _ in range(6)])
            holds[:2, :, 1:] *= rng.uniform(1.0, 35.0)  # a long thing is taken far from its middle
            heights, owns = rng.uniform(0.0, 0.2, 6), rng.uniform(0.01, 0.2, (6, 2))
            rows = np.array([random_neighbour(rng) for _ in range(4)])
            rows[:2, 3] = rng.uniform(0.01, 1.5, 2)
            found = swept.barred_matrix(sites, holds, heights, owns, rows, hand, 0.0)
            for i in range(6):
                for j in range(4):
                    expected = reference.barred_headings(
                        sites[i], holds[i], heights[i], owns[i], rows[j], hand,
                        swept.PLAY, swept.LEVEL,
                    )  # fmt: skip
                    assert headings_of(int(found[i, j])) == expected
                    seen.add(bool(expected))
    assert seen == {True, False}


def test_counts_agree_with_the_plain_twin(rng) -> None:
    for _ in range(50):
        barred = [[random_headings(rng) for _ in range(5)] for _ in range(4)]
        present = (rng.random(5) < 0.7).tolist()
        reachable = [random_headings(rng) for _ in range(4)]
        found = swept.bar_counts(
            np.array([[bits_of(h) for h in row] for row in barred]),
            np.array(present),
            np.array([bits_of(h) for h in reachable]),
        )
        assert np.array_equal(found, reference.bar_counts(barred, present, reachable))


@pytest.mark.parametrize("modulus", [1, 6, 12, 24])
def test_residue_minima_agree_with_brute_force(modulus, rng) -> None:
    for _ in range(20):
        counts = rng.integers(0, 5, (3, swept.HEADINGS)).astype(np.int32)
        minus = [random_headings(rng) for _ in range(3)]
        plus = [random_headings(rng) for _ in range(3)]
        found = swept.residue_minima(
            counts,
            np.array([bits_of(h) for h in minus]),
            np.array([bits_of(h) for h in plus]),
            modulus,
        )
        expected = [
            min(
                counts[i, k] - (k in minus[i]) + (k in plus[i])
                for i in range(3)
                for k in range(r, swept.HEADINGS, modulus)
            )
            for r in range(modulus)
        ]
        assert found.tolist() == expected


def test_sites_are_occupied_where_something_round_would_touch(rng) -> None:
    sites = rng.uniform([-0.3, -0.3, 0.0], [0.3, 0.3, 0.3], (80, 3))
    rows = np.array([random_neighbour(rng) for _ in range(6)])
    radius, tall = own = np.array([0.03, 0.15])
    for skip in (-1, 2):
        expected = [
            any(
                reference.point_distance(row, x, y) < radius + swept.PLAY
                and row[2] - row[5] < z + tall - swept.LEVEL
                and row[2] + row[5] > z + swept.LEVEL
                for j, row in enumerate(rows)
                if j != skip
            )
            for x, y, z in sites
        ]
        assert {True, False} == set(expected)
        assert swept.occupied_sites(sites, own, rows, skip).tolist() == expected


def test_nearest_static_looks_at_the_given_heights_only(rng) -> None:
    statics = random_uprights(rng, 6, 0.5)
    low, high = 0.1, 0.2
    at_height = [row for row in statics if row[2] + row[5] > low and row[2] - row[5] < high]
    assert 0 < len(at_height) < 6
    for _ in range(50):
        x, y = rng.uniform(-1, 1, 2)
        expected = min(reference.point_distance(row, x, y) for row in at_height)
        assert swept.nearest_static(x, y, statics, low, high) == pytest.approx(expected)
    assert swept.nearest_static(0, 0, statics, 5.0, 6.0) == math.inf


def test_open_headings_are_those_that_nothing_fixed_bars(rng) -> None:
    for hand in HANDS:
        statics = np.array([random_neighbour(rng) for _ in range(5)])
        statics[0, 3] = 1.2
        sites, hold = rng.uniform(-0.5, 0.5, (12, 3)) * [1, 1, 0.2], random_hold(rng)
        found = swept.open_headings(sites, hold, 0.1, OWN, statics, hand)
        for site, bits in zip(sites, found, strict=True):
            shut = set().union(*(twin(site, hold, 0.1, row, hand) for row in statics))
            assert headings_of(int(bits)) == set(range(swept.HEADINGS)) - shut


def test_a_heading_needs_somewhere_to_stand(rng) -> None:
    """A table in a room that a wall cuts in two."""
    table = upright_row(np.array([0.9, 0.0, 0.38]), np.array([0.3, 0.45, 0.38]), 0.0)
    divide = upright_row(np.array([0.9, 0.9, 0.2]), np.array([30.0, 0.01, 0.2]), 0.0)
    statics, clearance = np.array([table, divide]), np.array([0.4, 0.3])
    room = room_around(statics, clearance, 0.0, 0.0)
    sites = np.column_stack([rng.uniform([0.65, -0.4], [1.15, 0.4], (12, 2)), np.full(12, 0.76)])
    hold, wanted = random_hold(rng), rng.integers(0, 1 << swept.HEADINGS, 12)
    found = swept.stand_headings(sites, hold, wanted, SHOULDER, 0.2, 0.35, 0.72, *room.floor)
    seen = set()
    for site, ask, bits in zip(sites, wanted, found, strict=True):
        for k in range(swept.HEADINGS):
            centre = site[:2] + turn_z(k * swept.STEP)[:2, :2] @ hold[k, 1:]
            stand = reference.has_stand(centre, k, SHOULDER, 0.2, (0.35, 0.72), room)
            asked = bool(int(ask) >> k & 1)
            seen.add((asked, stand))
            assert bool(int(bits) >> k & 1) == (stand and asked)
    assert len(seen) == 4


def test_a_robot_that_cannot_drive_reaches_an_annulus(rng) -> None:
    base, (inner, outer), wrist = np.array([0.3, -0.2, 0.7]), (0.35, 0.72), 0.2
    sites, hold = rng.uniform(-1.0, 1.5, (30, 3)), random_hold(rng)
    wanted = np.full(30, swept.ALL)
    found = swept.fixed_headings(sites, hold, wanted, base, SHOULDER, wrist, inner, outer)
    axis = base[:2] + turn_z(base[2])[:2, :2] @ SHOULDER
    for site, bits in zip(sites, found, strict=True):
        expected = set()
        for k in range(swept.HEADINGS):
            at = site[:2] + turn_z(k * swept.STEP)[:2, :2] @ (hold[k, 1:] - [wrist, 0.0])
            if inner <= float(np.linalg.norm(at - axis)) <= outer:
                expected.add(k)
        assert headings_of(int(bits)) == expected
    assert len(set(found.tolist())) > 5


def test_a_heading_between_two_is_next_to_both(rng) -> None:
    """A quarter of a step from one of them it is that one's alone."""
    steps = rng.uniform(-2 * swept.HEADINGS, 2 * swept.HEADINGS, 500)
    for place in (*steps, *range(-5, 5)):
        turns = [math.remainder(place - k, swept.HEADINGS) for k in range(swept.HEADINGS)]
        expected = {k for k, off in enumerate(turns) if abs(off) < 1 - swept.BETWEEN}
        assert headings_of(swept.near_headings(place * swept.STEP)) == expected
        nearest = min(range(swept.HEADINGS), key=lambda k: abs(turns[k]))
        assert swept.heading_bit(place * swept.STEP) == nearest
        assert nearest in expected
