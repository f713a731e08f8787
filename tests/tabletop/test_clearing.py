"""What to take away first, against a plain search with sets."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from domains.tabletop.features import swept
from domains.tabletop.features.arrangement import Arrangement
from domains.tabletop.features.clearing import NEVER, clearing_of, least_clearing, members
from domains.tabletop.scene.load import load_scene
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from tests.tabletop.scene.texts import write_scene

SOME = 4
"""Headings that are looked at: the others are out of reach, which makes room tight."""

Bars = list[dict[int, set[int]]]
"""For each object, what bars each of its headings."""


def random_bars(rng: np.random.Generator, n: int, density: float) -> Bars:
    reach = [[k for k in range(SOME) if rng.random() < 0.8] for _ in range(n)]
    return [
        {k: {j for j in range(n) if j != i and rng.random() < density} for k in reach[i]}
        for i in range(n)
    ]


def packed(bars: Bars, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Bits (n, n) and counts (n, K) of one family."""
    barred = np.zeros((n, n), dtype=np.int64)
    reachable = np.zeros(n, dtype=np.int64)
    for i, ways in enumerate(bars):
        for k, things in ways.items():
            reachable[i] |= 1 << k
            for j in things:
                barred[i, j] |= 1 << k
    return barred, swept.bar_counts(barred, np.ones(n, dtype=np.int64), reachable)


def can_go(bars: list[Bars], index: int, gone: set[int]) -> bool:
    return any(things <= gone for family in bars for things in family[index].values())


def can_all_go(bars: list[Bars], those: set[int]) -> bool:
    """Whether some objects can be taken away, in some order: whichever can go next, may."""
    gone: set[int] = set()
    while gone != those:
        found = {i for i in those - gone if can_go(bars, i, gone)}
        if not found:
            return False
        gone |= found
    return True


def fewest(bars: list[Bars], index: int, n: int) -> int:
    others = [j for j in range(n) if j != index]
    for size in range(n):
        for chosen in combinations(others, size):
            if can_go(bars, index, set(chosen)) and can_all_go(bars, set(chosen)):
                return size
    return NEVER


@pytest.mark.parametrize("density", [0.15, 0.3, 0.6])
def test_what_is_to_be_taken_away_can_be_and_is_enough(density) -> None:
    rng = np.random.default_rng(0)
    seen, least, of = set(), 0, 0
    for _ in range(40):
        n = int(rng.integers(2, 8))
        bars = [random_bars(rng, n, density) for _ in range(int(rng.integers(1, 3)))]
        barred, counts = map(np.array, zip(*[packed(family, n) for family in bars], strict=True))
        none = np.zeros((len(bars), n), dtype=np.int64)
        found = clearing_of(barred, counts, none, np.ones(n, dtype=np.int64))
        for i in range(n):
            size, chosen = int(found.sizes[i]), set(members(found.sets[i]))
            expected = fewest(bars, i, n)
            assert (size == NEVER) == (expected == NEVER)
            assert size >= expected
            assert (size == 0) == (expected == 0)
            if size < NEVER:
                assert len(chosen) == size
                assert i not in chosen
                assert can_all_go(bars, chosen)
                assert can_go(bars, i, chosen)
                least, of = least + (size == expected), of + 1
                seen.add(size)
    assert {0, 1} <= seen
    assert least > 0.9 * of > 9


def test_more_objects_than_bits_in_a_word() -> None:
    """A line of objects, each in the way of the next, and one more in the way of the first."""
    n = 130
    bars: Bars = [{0: {i - 1} if i else set()} for i in range(n)]
    barred, counts = packed(bars, n)
    present = np.ones(n, dtype=np.int64)
    extra = np.zeros((1, n), dtype=np.int64)
    found = clearing_of(barred[None], counts[None], extra, present)
    assert found.sizes.tolist() == list(range(n))
    assert members(found.sets[100]) == list(range(100))
    extra[0, 0] = 1
    found = clearing_of(barred[None], counts[None], extra, present)
    assert found.sizes.tolist() == list(range(1, n + 1))
    assert members(found.sets[100]) == [*range(100), n]


@pytest.mark.parametrize("modulus", [1, 2, 4])
def test_a_way_out_and_a_way_in_share_what_bars_both(modulus) -> None:
    rng = np.random.default_rng(modulus)
    shared = 0
    for _ in range(60):
        n, sites, turn = int(rng.integers(3, 9)), 2, int(rng.integers(4))
        bars = random_bars(rng, n, 0.25)
        barred, counts = packed(bars, n)
        none = np.zeros((1, n), dtype=np.int64)
        clear = clearing_of(barred[None], counts[None], none, np.ones(n, dtype=np.int64))
        goals = [random_bars(rng, n + 1, 0.3)[n] for _ in range(sites)]
        place = np.zeros((sites, n + 1), dtype=np.int64)
        for s, ways in enumerate(goals):
            for k, things in ways.items():
                for j in things:
                    place[s, j] |= 1 << k
        reachable = np.array([sum(1 << k for k in ways) for ways in goals], dtype=np.int64)
        counted = np.append(np.ones(n, dtype=np.bool_), False)
        counted[0] = False
        size, chosen = least_clearing(
            0, np.append(barred[0], 0), sum(1 << k for k in bars[0]), place, reachable, counted,
            clear.sets, clear.sizes, modulus, turn % modulus,
        )  # fmt: skip

        def closed(things: set[int], clear=clear) -> set[int] | None:
            found = set(things - {0})
            for j in things - {0}:
                if clear.sizes[j] == NEVER or 0 in members(clear.sets[j]):
                    return None
                found |= set(members(clear.sets[j]))
            return found

        unions = [
            (out | into, len(out) + len(into))
            for k, before in bars[0].items()
            for ways in goals
            for m, after in ways.items()
            if (m - k - turn) % modulus == 0
            and (out := closed(before)) is not None
            and (into := closed(after)) is not None
        ]
        expected = min((len(union) for union, _ in unions), default=NEVER)
        assert size == expected
        if size < NEVER:
            best = [union for union, _ in unions if len(union) == size]
            assert set(members(chosen)) == set().union(*best)
            shared += min(both for _, both in unions) > size
    assert shared


STICK = '[[object]]\nname = "s{0}"\nsize = [0.04, 0.04, 0.2]\nat = [{1:.3f}, {2:.3f}]\n'
TABLES = (
    'approaches = ["side"]\nrobot_start = [-0.6, 0.0, 0.0]\n'
    '[[table]]\nname = "a"\nat = [0.8, 0.0]\nsize = [0.8, 1.1]\ntop = 0.7\n'
    '[[table]]\nname = "b"\nat = [-1.8, 0.0]\nsize = [0.8, 1.4]\ntop = 0.7\n'
)


def test_what_is_thought_to_be_there_counts_as_what_is_there(tmp_path) -> None:
    """In a dense grid: the answer with an object thought to be at a place is that of the
    arrangement in which it is there, but for its own ways, which are taken to be free."""
    sticks = [
        STICK.format(f"{i}_{j}", 0.8 + (i - 2) * 0.08, (j - 2) * 0.08)
        for i in range(5)
        for j in range(5)
    ]
    goals = [f'[[goal]]\nobject = "s{i}_2"\non = "b"\n' for i in range(5)]
    scene = load_scene(write_scene(tmp_path, "".join([TABLES, *sticks, *goals])))
    world = TabletopWorld.of(scene, load_robot("tiago"))
    whole = world.initial.placements
    rng, raised = np.random.default_rng(0), 0
    for _ in range(12):
        index = int(rng.integers(len(sticks)))
        placements = (*whole[:index], None, *whole[index + 1 :])
        without = Arrangement.afresh(world, placements)
        there = Arrangement.afresh(world, whole)
        for other in world.scene.goals:
            goal = world.goal_sites(other, without)
            assert goal is not None
            if other == index:
                continue
            placement = whole[index]
            assert placement is not None
            count = without.disturbed_by(index, placement, frozenset([other]))
            before, after = without.obstructions(other, goal), there.obstructions(other, goal)
            if there.free_headings(index, world.families[0]):
                assert count == (after > before)
            raised += count
    assert raised
