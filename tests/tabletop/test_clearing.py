"""What to take away first, against its equations, and what is thought to be there."""

from __future__ import annotations

import numpy as np
import pytest

from domains.tabletop.features import swept
from domains.tabletop.features.alpha import Thought
from domains.tabletop.features.arrangement import Arrangement
from domains.tabletop.features.clearing import NEVER, all_to_clear, clearing_costs, least_cost
from domains.tabletop.scene.load import load_scene
from domains.tabletop.state import Placement
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot
from tests.tabletop.scene.texts import write_scene
from tests.tabletop.tasks import ON_RIGHT, task

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


def packed(bars: Bars, n: int, present: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bits (n, n) and counts (n, K) of one family."""
    barred = np.zeros((n, n), dtype=np.int64)
    reachable = np.zeros(n, dtype=np.int64)
    for i, ways in enumerate(bars):
        for k, things in ways.items():
            reachable[i] |= 1 << k
            for j in things:
                barred[i, j] |= 1 << k
    return barred, swept.bar_counts(barred, present, reachable)


def reference(bars: list[Bars], there: set[int]) -> dict[int, int]:
    """The costs by their equations, solved from above."""
    costs = dict.fromkeys(there, NEVER)
    for _ in range(len(there) + 1):
        costs = {
            i: min(
                (
                    sum(1 + costs[j] for j in things & there)
                    for family in bars
                    for things in family[i].values()
                ),
                default=NEVER,
            )
            for i in there
        }
        costs = {i: cost if cost < NEVER else NEVER for i, cost in costs.items()}
    return costs


def costs_of(bars: list[Bars], there: set[int], extra: np.ndarray | None = None) -> np.ndarray:
    n = len(bars[0])
    present = np.array([int(i in there) for i in range(n)])
    made = [packed(family, n, present) for family in bars]
    barred, counts = map(np.array, zip(*made, strict=True))
    none = np.zeros((len(bars), n), dtype=np.int64)
    found: np.ndarray = clearing_costs(barred, counts, none if extra is None else extra, present)
    return found


@pytest.mark.parametrize("density", [0.1, 0.2, 0.4])
def test_costs_solve_their_equations_and_fall_with_what_is_taken_away(density) -> None:
    """What sketches rely on: taking an object away makes nothing dearer; taking away a free one
    that is to be cleared makes that cheaper for which it is."""
    rng = np.random.default_rng(0)
    seen: set[int] = set()
    for _ in range(30):
        n = int(rng.integers(2, 9))
        bars = [random_bars(rng, n, density) for _ in range(int(rng.integers(1, 3)))]
        there = set(range(n))
        found = costs_of(bars, there)
        assert {i: int(found[i]) for i in there} == reference(bars, there)
        seen |= set(found.tolist())
        made = [packed(family, n, np.ones(n, dtype=np.int64)) for family in bars]
        barred, counts = map(np.array, zip(*made, strict=True))
        for j in there:
            fewer = costs_of(bars, there - {j})
            others = [i for i in there if i != j]
            assert all(fewer[i] <= found[i] for i in others)
            for i in others:
                chosen = np.array([k == i for k in range(n)])
                clear = all_to_clear(chosen, barred, counts, found)
                if 0 < found[i] < NEVER and clear[j] and found[j] == 0:
                    assert fewer[i] < found[i]
        for i in there:
            clear = all_to_clear(np.array([k == i for k in range(n)]), barred, counts, found)
            if 0 < found[i] < NEVER:  # something that can be taken away right now is among them
                assert any(found[j] == 0 for j in np.flatnonzero(clear) if j != i)
    assert {0, 1, 2 if density < 0.4 else NEVER} <= seen


def test_a_long_line_of_objects_is_cleared_one_by_one() -> None:
    """Each object is in the way of the next, and one more in the way of the first."""
    n = 130
    bars: Bars = [{0: {i - 1} if i else set()} for i in range(n)]
    assert costs_of([bars], set(range(n))).tolist() == list(range(n))
    extra = np.zeros((1, n), dtype=np.int64)
    extra[0, 0] = 1
    assert costs_of([bars], set(range(n)), extra).tolist() == list(range(1, n + 1))


@pytest.mark.parametrize("modulus", [1, 2, 4])
def test_what_bars_both_ways_counts_once(modulus) -> None:
    """More than 63 objects as well: sets of objects are packed into words."""
    rng = np.random.default_rng(modulus)
    shared = 0
    for _ in range(60):
        n, turn = int(rng.choice([3, 8, 80])), int(rng.integers(4))
        costs = rng.choice([-1, 0, 0, 2, NEVER], n)
        pick, goals = (random_bars(rng, n, 2 / n)[0], random_bars(rng, n, 2 / n)[:2])
        rows = [
            [sum(1 << k for k, things in ways.items() if j in things) for j in range(n)]
            for ways in (pick, *goals)
        ]
        reachable = np.array([sum(1 << k for k in ways) for ways in (pick, *goals)])
        found, chosen = least_cost(
            np.array(rows[0]), reachable[0], np.array(rows[1:]), reachable[1:], costs, modulus, turn
        )

        def cost(things: set[int], costs=costs) -> int:
            total = sum(1 + int(costs[j]) for j in things if costs[j] >= 0)
            return min(total, NEVER)

        ways = [
            (cost(before | after), cost(before) + cost(after), before | after)
            for k, before in pick.items()
            for goal in goals
            for m, after in goal.items()
            if (m - k - turn) % modulus == 0
        ]
        assert found == min((each for each, _, _ in ways), default=NEVER)
        if found < NEVER:
            best = [things for each, _, things in ways if each == found]
            counted = {int(j) for j in np.flatnonzero(costs >= 0)}
            assert set(np.flatnonzero(chosen).tolist()) == set().union(*best) & counted
            shared += min(both for _, both, _ in ways) > found
    assert shared


STICK = '[[object]]\nname = "s{0}"\nsize = [0.04, 0.04, 0.2]\nat = [{1:.3f}, {2:.3f}]\n'
TABLES = (
    'approaches = ["side"]\nrobot_start = [-0.6, 0.0, 0.0]\n'
    '[[table]]\nname = "a"\nat = [0.8, 0.0]\nsize = [0.8, 1.1]\ntop = 0.7\n'
    '[[table]]\nname = "b"\nat = [-1.8, 0.0]\nsize = [0.8, 1.4]\ntop = 0.7\n'
)


def grid_world(tmp_path, holes: set[int], more: str = "") -> TabletopWorld:
    """Sticks 8 cm apart, five by five, but for some; all belong on the other table."""
    sticks = [
        STICK.format(i, 0.8 + (i // 5 - 2) * 0.08, (i % 5 - 2) * 0.08)
        for i in range(25)
        if i not in holes
    ]
    goals = [f'[[goal]]\nobject = "s{i}"\non = "b"\n' for i in range(25) if i not in holes]
    scene = load_scene(write_scene(tmp_path, "".join([TABLES, *sticks, *goals, more])))
    return TabletopWorld.of(scene, load_robot("tiago"))


def test_what_is_thought_to_be_there_counts_as_what_is_there(tmp_path) -> None:
    """In a dense grid: the answer with an object thought to be at a place is that of the
    arrangement in which it is there, where nothing bars that one."""
    world = grid_world(tmp_path, {6, 12, 18})
    whole = world.initial.placements
    rng, seen, dearer = np.random.default_rng(0), set(), 0
    for _ in range(14):
        index = int(rng.integers(len(whole)))
        without = Arrangement.afresh(world, (*whole[:index], None, *whole[index + 1 :]))
        x, y = rng.uniform([0.5, -0.3], [1.1, 0.3])
        placement = Placement.of(x, y, 0.0, 0)
        there = Arrangement.afresh(world, (*whole[:index], placement, *whole[index + 1 :]))
        if not there.free_headings(index, world.families[0]):
            continue
        extra = Thought(without, index, there.boxes[index])
        others = [i for i in range(len(whole)) if i != index]
        assert extra.costs[others].tolist() == there.costs[others].tolist()
        dearer += int((extra.costs > without.costs)[others].sum())
        for other in world.scene.goals:
            goal = world.goal_sites(other, without)
            assert goal is not None
            if other != index:
                raised = there.obstructions(other, goal) > without.obstructions(other, goal)
                count = without.disturbed_by(index, placement, frozenset([other]))
                assert count == raised
                seen.add((bool(extra.bars[:, other].any()), raised))
    assert seen == {(False, False), (True, False), (True, True)}
    assert dearer


BOX = '[[object]]\nname = "{}"\nsize = {}\nat = [{:.3f}, {:.3f}]\n'


@pytest.mark.parametrize("length", [0.3, 0.5, 0.7])
def test_what_is_far_off_disturbs_by_what_it_bars(tmp_path, rng, length) -> None:
    """A plank bars a box beside its one end; what stands at the plank's middle, where it is taken,
    is in the way of the plank, and so of the box, however long the plank is."""
    end = 0.6 + length / 2 - 0.06
    entries = [
        BOX.format("plank", [0.05, length, 0.05], 0.8, 0.6),
        BOX.format("box", [0.05, 0.1, 0.05], 0.855, end),
        BOX.format("stick", [0.04, 0.04, 0.2], 0.55, 0.3),
        *(ON_RIGHT.format(name) for name in ("plank", "box", "stick")),
    ]
    world = task(tmp_path, *entries, approaches='["top"]')
    plank, box, _ = world.initial.placements
    without = Arrangement.afresh(world, (plank, box, None))
    goal = world.goal_sites(1, without)
    assert goal is not None
    before, seen = without.obstructions(1, goal), set()
    assert before == 1
    spots = [(0.8 + side * rng.uniform(0.05, 0.08), 0.6) for side in (-1, 1)]
    spots += rng.uniform([0.65, 0.25], [0.95, 0.95], (20, 2)).tolist()
    for x, y in spots:
        placement = Placement.of(x, y, 0.0, 0)
        there = Arrangement.afresh(world, (plank, box, placement))
        if there.free_headings(2, world.families[0]):
            raised = there.obstructions(1, goal) > before
            assert without.disturbed_by(2, placement, frozenset([1])) == raised
            seen.add((abs(y - end) > 0.28, raised))
    assert (True, length == 0.7) in seen


def test_a_place_in_a_grid_is_not_harmless_and_one_apart_is(tmp_path) -> None:
    """Sticks that belong into the holes of a grid, where they bar others, or apart from it."""
    spots = [(0.72, -0.08), (0.8, 0.0), (0.88, 0.08), (-1.6, 0.5)]
    more = "".join(
        STICK.format(30 + k, -2.0, 0.2 * k - 0.3)
        + f'[[goal]]\nobject = "s{30 + k}"\nat = [{x}, {y}]\n'
        for k, (x, y) in enumerate(spots)
    )
    world = grid_world(tmp_path, {6, 12, 18}, more)
    here = Arrangement.afresh(world, world.initial.placements)
    found = []
    for index in range(22, 26):
        goal = world.goal_sites(index, here)
        assert goal is not None
        found.append(here.has_harmless_site(index, goal, range(22)))
    assert found == [False, False, False, True]


def test_what_is_certainly_in_nobodys_way_disturbs_nobody(tmp_path) -> None:
    """The quick answer, with the object still where it was, against the slow one without it."""
    at = '[[goal]]\nobject = "s{}"\nat = [{}, {}]\n'
    rng, seen = np.random.default_rng(1), set()
    for _ in range(6):
        spots = rng.permutation([(i, j) for i in range(5) for j in range(5)])[:9]
        sticks = [
            STICK.format(k, 0.62 + 0.09 * i, 0.09 * (j - 2)) for k, (i, j) in enumerate(spots[:7])
        ]
        sticks += [
            STICK.format(k + 7, -1.9 + 0.1 * i, 0.1 * (j - 2)) for k, (i, j) in enumerate(spots[7:])
        ]
        goals = [f'[[goal]]\nobject = "s{i}"\non = "b"\n' for i in range(3)]
        goals += [at.format(3, -1.7, 0.1), at.format(4, -1.8, 0.1), at.format(7, 0.9, 0.2)]
        goals += [at.format(8, *rng.uniform([0.6, -0.3], [0.9, 0.3])) + "yaw = 0.0\n"]
        scene = load_scene(write_scene(tmp_path, "".join([TABLES, *sticks, *goals])))
        world = TabletopWorld.of(scene, load_robot("tiago"))
        placements = world.initial.placements
        whole = Arrangement.afresh(world, placements)
        for index in world.scene.goals:
            others = frozenset(i for i in world.scene.goals if i != index)
            goal = world.goal_sites(index, whole)
            assert goal is not None
            certain = whole.has_harmless_site(index, goal, others)
            without = Arrangement.afresh(
                world, (*placements[:index], None, *placements[index + 1 :])
            )
            counts = []
            for placement, free in zip(goal.placements, whole.free_sites(index, goal), strict=True):
                spot = world.rests_at(without.placements, index, placement)
                assert spot is not None
                extra = Thought(without, index, world.box_row(index, spot))
                raised = 0
                for other in others:
                    sites = world.goal_sites(other, without)
                    assert sites is not None
                    before = without.obstructions(other, sites)
                    raised += without.obstructions_with(other, sites, None, extra) > before
                assert without.disturbed_by(index, placement, others) == raised
                if free:
                    counts.append(raised)
            assert not certain or 0 in counts
            seen.add((certain, 0 in counts))
    assert {(True, True), (False, False)} <= seen
