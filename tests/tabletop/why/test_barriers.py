"""What is said to bar the ways to an object, against what the features count."""

from __future__ import annotations

import math

import numpy as np

from domains.tabletop.features.functions import arrangement
from domains.tabletop.features.swept import HEADINGS, open_headings
from domains.tabletop.state import PINCH, SIDE, TOP
from domains.tabletop.why.barriers import to_object
from domains.tabletop.world import TabletopWorld
from tests.tabletop.tasks import ON_RIGHT, task

OBJECT = '[[object]]\nname = "{}"\nsize = {}\nat = [{:.3f}, {:.3f}]\nyaw = {:.0f}\n'
SIZES = ([0.04, 0.04, 0.2], [0.2, 0.05, 0.05], [0.05, 0.3, 0.04], [0.16, 0.04, 0.12])
FAMILIES = ("side", "top", "pinch")


def surrounded(folder, rng, number: int) -> TabletopWorld:
    """A thing in the middle of a table, others around it."""
    things = [OBJECT.format("a", SIZES[number % len(SIZES)], 0.8, 0.6, rng.uniform(0, 90))]
    ring = rng.uniform(0, 2 * math.pi)
    for i in range(int(rng.integers(1, 4))):
        bearing, reach = ring + 2 * math.pi * i / 3, rng.uniform(0.24, 0.3)
        x, y = 0.8 + reach * math.cos(bearing), 0.6 + reach * math.sin(bearing)
        size = [0.06, 0.06, round(rng.uniform(0.05, 0.3), 3)]
        things.append(OBJECT.format(f"o{i}", size, x, y, 0))
    text = ", ".join(f'"{family}"' for family in FAMILIES)
    return task(folder, *things, ON_RIGHT.format("a"), approaches=f"[{text}]")


def bits(number: int) -> set[int]:
    return {k for k in range(HEADINGS) if (number >> k) & 1}


def test_ways_are_those_in_which_a_hand_fits_and_what_bars_them_is_what_the_features_count(
    tmp_path, rng
) -> None:
    some = partly = 0
    for number in range(16):
        world = surrounded(tmp_path, rng, number)
        state = world.initial
        here = arrangement(world, state.placements)
        names = [item.name for item in world.items]
        at = world.rests(state.placements, 0)
        assert at is not None
        ways = {barrier.family: barrier for barrier in to_object(world, state, 0)}
        for family in (SIDE, TOP, PINCH):
            hold, sweep = world.hold(0, family, at[3]), world.hand.sweeps[family]
            fits = bits(hold.fits)
            assert (family in ways) == bool(fits)
            if not fits:
                continue
            barrier, barred = ways[family], here.picks[family].barred[0]
            assert barrier.ways == len(fits)
            for name, of_it in zip(names[1:], barred[1:].tolist(), strict=True):
                assert barrier.barred.get(name, 0) == len(fits & bits(of_it))
            (unfixed,) = open_headings(
                np.array([at[:3]]), hold.rows, hold.height, world.own(0), world.statics, sweep
            )
            others = bits(int(np.bitwise_or.reduce(barred[1:])))
            assert barrier.free == len(fits & bits(int(unfixed)) - others)
            assert bool(barrier.nearest) == (barrier.free == 0)
            some += bool(barrier.barred)
            partly += len(fits) < HEADINGS
    assert some
    assert partly
