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

STRIP = np.array([0.063, 0.022, 0.40, 0.068, 0.012])
SHOULDER = np.array([0.093, 0.014])


def random_headings(rng: np.random.Generator) -> set[int]:
    return set(np.flatnonzero(rng.random(swept.HEADINGS) < 0.4).tolist())


def random_grips(rng: np.random.Generator) -> Floats:
    """Half widths of an object across every heading."""
    return rng.uniform(0.01, 0.05, swept.HEADINGS)


def random_neighbour(rng: np.random.Generator) -> Floats:
    """A standing object within half a metre (8,)."""
    centre = np.array([*rng.uniform(-0.35, 0.35, 2), 0.85])
    half = np.array([*rng.uniform(0.01, 0.06, 2), 0.1])
    return upright_row(centre, half, rng.uniform(-math.pi, math.pi))


def moved(row: Floats, angle: float, shift: Floats) -> Floats:
    """A packed box turned about the origin, then shifted."""
    c, s = math.cos(angle), math.sin(angle)
    turned = row.copy()
    turned[:2] = turn_z(angle)[:2, :2] @ row[:2] + shift
    turned[6:] = c * row[6] - s * row[7], s * row[6] + c * row[7]
    return turned


def test_barred_headings_agree_with_the_plain_twin(rng) -> None:
    sizes = set()
    for _ in range(2000):
        site, grips, row = rng.uniform(-0.3, 0.3, 2), random_grips(rng), random_neighbour(rng)
        found = swept.barred_headings(*site, grips, row, STRIP)
        expected = reference.barred_headings(site, grips, row, STRIP, swept.PLAY)
        assert headings_of(found) == expected
        sizes.add(len(expected))
    assert {0, swept.HEADINGS} < sizes


def test_barred_headings_turn_with_the_scene(rng) -> None:
    for _ in range(500):
        grips, row = random_grips(rng), random_neighbour(rng)
        steps = int(rng.integers(swept.HEADINGS))
        turned = moved(row, steps * swept.STEP, np.zeros(2))
        before = headings_of(swept.barred_headings(0.0, 0.0, grips, row, STRIP))
        after = headings_of(swept.barred_headings(0.0, 0.0, np.roll(grips, steps), turned, STRIP))
        assert after == {(k + steps) % swept.HEADINGS for k in before}


def test_barred_headings_do_not_depend_on_where_the_scene_is(rng) -> None:
    for _ in range(500):
        grips, row, shift = random_grips(rng), random_neighbour(rng), rng.uniform(-3, 3, 2)
        here = swept.barred_headings(0.0, 0.0, grips, row, STRIP)
        assert swept.barred_headings(*shift, grips, moved(row, 0.0, shift), STRIP) == here


def test_something_larger_bars_at_least_as_much(rng) -> None:
    for _ in range(500):
        grips, row = random_grips(rng), random_neighbour(rng)
        larger = row.copy()
        larger[3:5] += 0.02
        less = headings_of(swept.barred_headings(0.0, 0.0, grips, row, STRIP))
        assert less <= headings_of(swept.barred_headings(0.0, 0.0, grips, larger, STRIP))


def test_something_behind_the_object_does_not_bar_the_way_to_it() -> None:
    """The gripper comes from the west (heading 0); the other object stands east."""
    grips = np.full(swept.HEADINGS, 0.02)
    east = upright_row(np.array([0.1, 0.0, 0.85]), np.array([0.02, 0.02, 0.1]), 0.0)
    west = moved(east, math.pi, np.zeros(2))
    assert 0 not in headings_of(swept.barred_headings(0.0, 0.0, grips, east, STRIP))
    assert 0 in headings_of(swept.barred_headings(0.0, 0.0, grips, west, STRIP))


def test_matrix_is_every_pair(rng) -> None:
    sites = rng.uniform(-0.3, 0.3, (6, 2))
    grips = np.array([random_grips(rng) for _ in range(6)])
    rows = np.array([random_neighbour(rng) for _ in range(4)])
    found = swept.barred_matrix(sites, grips, rows, STRIP)
    for i in range(6):
        for j in range(4):
            expected = reference.barred_headings(sites[i], grips[i], rows[j], STRIP, swept.PLAY)
            assert headings_of(int(found[i, j])) == expected


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


def test_least_barred_headings_agree_with_brute_force(rng) -> None:
    for _ in range(50):
        counts = rng.integers(0, 4, (3, swept.HEADINGS)).astype(np.int32)
        minus = [random_headings(rng) for _ in range(3)]
        value = {
            (i, k): counts[i, k] - (k in minus[i]) for i in range(3) for k in range(swept.HEADINGS)
        }
        least = min(value.values())
        found = swept.least_barred(counts, np.array([bits_of(h) for h in minus]))
        for i in range(3):
            expected = {k for k in range(swept.HEADINGS) if value[i, k] == least}
            assert headings_of(int(found[i])) == expected


def test_leaves_open_means_that_a_heading_stays_free(rng) -> None:
    answers = set()
    for _ in range(300):
        sites = rng.uniform(-0.1, 0.1, (2, 2))
        headings = [random_headings(rng) & set(range(6)) for _ in range(2)]
        grips = np.array([random_grips(rng) for _ in range(2)])
        row = random_neighbour(rng)
        bits = np.array([bits_of(h) for h in headings])
        found = swept.leaves_open(bits, sites, grips, row, STRIP)
        expected = any(
            wanted - reference.barred_headings(site, grip, row, STRIP, swept.PLAY)
            for site, grip, wanted in zip(sites, grips, headings, strict=True)
        )
        answers.add(expected)
        assert found == expected
    assert answers == {True, False}


def test_sites_are_occupied_where_something_round_would_touch(rng) -> None:
    sites = rng.uniform(-0.3, 0.3, (50, 2))
    rows = np.array([random_neighbour(rng) for _ in range(6)])
    for skip in (-1, 2):
        expected = [
            any(
                reference.point_distance(row, *site) < 0.03 + swept.PLAY
                for j, row in enumerate(rows)
                if j != skip
            )
            for site in sites
        ]
        assert {True, False} == set(expected)
        assert swept.occupied_sites(sites, 0.03, rows, skip).tolist() == expected


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


def test_reachable_headings_need_a_stand_and_a_free_strip(rng) -> None:
    """A table with a wall behind it, in a room that another wall cuts in two."""
    table = upright_row(np.array([0.9, 0.0, 0.38]), np.array([0.3, 0.45, 0.38]), 0.0)
    wall = upright_row(np.array([1.05, 0.0, 0.9]), np.array([0.01, 0.45, 0.2]), 0.0)
    divide = upright_row(np.array([0.9, 0.9, 0.2]), np.array([30.0, 0.01, 0.2]), 0.0)
    statics, clearance = np.array([table, wall, divide]), np.array([0.4, 0.3, 0.3])
    room = room_around(statics, clearance, 0.0, 0.0)
    sites = rng.uniform([0.65, -0.4], [1.15, 0.4], (12, 2))
    found = swept.reachable_headings(sites, STRIP, SHOULDER, 0.2, 0.35, 0.72, 0.85, 0.91, *room)
    seen = set()
    for site, bits in zip(sites, found, strict=True):
        for k in range(swept.HEADINGS):
            direction = np.array([math.cos(k * swept.STEP), math.sin(k * swept.STEP)])
            arm = reference.segment_distance(
                wall, site - STRIP[0] * direction, site - STRIP[2] * direction
            )
            fingers = reference.segment_distance(wall, site + STRIP[1] * direction, site)
            if min(abs(arm - STRIP[3]), abs(fingers - STRIP[3] / 2)) < 1e-3:
                continue  # sampling cannot tell
            barred = arm < STRIP[3] or fingers < STRIP[3] / 2
            stand = reference.has_stand(site, k, SHOULDER, 0.2, (0.35, 0.72), room)
            seen.add((barred, stand))
            assert bool(bits >> k & 1) == (stand and not barred)
    assert len(seen) >= 3


@pytest.mark.parametrize("modulus", [1, 6, 12, 24])
def test_the_least_union_agrees_with_sets(rng, modulus) -> None:
    """More than 63 objects as well: sets of objects are packed into words."""
    counted_twice = 0
    for objects in (3, 10, 70):
        for _ in range(8):
            sites, turn = 2, int(rng.integers(-30, 30))
            pick = np.array([bits_of(random_headings(rng)) for _ in range(objects)])
            place = np.array(
                [[bits_of(random_headings(rng)) for _ in range(objects)] for _ in range(sites)]
            )
            reachable = rng.integers(1, 1 << swept.HEADINGS, sites + 1)
            counted = rng.random(objects) < 0.8
            found = swept.least_union(
                pick, reachable[0], place, reachable[1:], counted, modulus, turn
            )
            unions, sums = [], []
            for k in headings_of(int(reachable[0])):
                before = {j for j in range(objects) if counted[j] and k in headings_of(pick[j])}
                for i in range(sites):
                    for m in headings_of(int(reachable[1 + i])):
                        if (m - k - turn) % modulus == 0:
                            bars = [k2 for k2 in range(objects) if m in headings_of(place[i, k2])]
                            after = {j for j in bars if counted[j]}
                            unions.append(len(before | after))
                            sums.append(len(before) + len(after))
            assert found == min(unions, default=2 * swept.UNREACHABLE)
            counted_twice += min(sums, default=0) > min(unions, default=0)
    assert counted_twice
