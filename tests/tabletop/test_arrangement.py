"""What is carried over from one arrangement to the next equals what is computed afresh."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from domains.tabletop.features.arrangement import Arrangement
from domains.tabletop.ground import Ground
from domains.tabletop.memory import Memory
from domains.tabletop.state import PINCH, SIDE, TOP, Placement
from domains.tabletop.world import TabletopWorld
from runtime.world.poses import upright
from tests.tabletop.tasks import AT, task

SIZES = (
    (0.02, 0.02, 0.02), (0.04, 0.04, 0.2), (1.6, 0.05, 0.03), (3.0, 0.08, 0.06),
    (0.3, 0.2, 0.03), (0.05, 0.05, 0.1), (0.4, 0.4, 0.4), (0.06, 0.9, 0.02),
)  # fmt: skip
"""From 2 cm to 3 m: cubes, sticks, planks, a tray, a crate."""

FLOOR = '[[table]]\nname = "large"\nat = [12, 0]\nsize = [9, 9]\ntop = 0.7\n'


def world_of(tmp_path, families, stacks) -> TabletopWorld:
    entries = [FLOOR]
    for i, size in enumerate(SIZES):
        at = [12, i - 3.5]
        entries.append(f'[[object]]\nname = "o{i}"\nsize = {list(size)}\nat = {at}\n')
    entries += [AT.format("o0", 0.8, 0.6), AT.format("o1", 0.9, 0.5), AT.format("o2", 0.8, -0.9)]
    world = task(tmp_path, *entries)
    tops = [
        Ground(f"top of o{i}", i, upright(0.0, 0.0, world.items[i].size[2], 0.0), (0.2, 0.1), 1.0)
        for i in stacks
    ]
    grounds = (*world.grounds, *tops)
    return replace(world, families=families, grounds=grounds, memory=Memory())


def value_of(found: Arrangement) -> list[np.ndarray]:
    values = [found.boxes, found.sites, found.present]
    for family in sorted(found.picks):
        picks = found.picks[family]
        values += [np.asarray(getattr(picks, field.name)) for field in fields(picks)]
    return values


def answers(world: TabletopWorld, found: Arrangement) -> list[object]:
    """Alpha and the ways to the goals, which are carried over as well."""
    out: list[object] = []
    for index in world.scene.goals:
        goal = world.goal_sites(index, found)
        assert goal is not None
        out.append(found.obstructions(index, goal))
        for family in world.families:
            ways = found.places_of(index, goal, family)
            out += [ways.counts.tolist(), ways.barred.tolist()]
        if goal.frame is None:
            table = found.site_table(index, goal)
            out += [np.asarray(getattr(table, field.name)).tolist() for field in fields(table)]
            others = frozenset(i for i in world.scene.goals if i != index)
            out.append(found.has_harmless_site(index, goal, others))
    return out


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("stacks", [(), (4, 6)])
def test_what_is_carried_over_equals_what_is_computed_afresh(tmp_path, seed, stacks) -> None:
    world = world_of(tmp_path, (SIDE, TOP, PINCH), stacks)
    rng = np.random.default_rng(seed)
    placements = world.initial.placements
    here = Arrangement.afresh(world, placements)
    answers(world, here)
    seen = set()
    for _ in range(25):
        index = int(rng.integers(len(SIZES)))
        moved: Placement | None = None
        if placements[index] is None or rng.random() < 0.7:
            x, y = rng.uniform(-1.2, 1.2, 2) + np.array([0.8, -0.1])
            moved = Placement.of(x, y, rng.uniform(0, 6.28), int(rng.integers(2)))
            if stacks and index not in stacks and rng.random() < 0.4:
                top = len(world.grounds) - 1 - int(rng.integers(len(stacks)))
                moved = Placement.of(*rng.uniform(-0.1, 0.1, 2), rng.uniform(0, 6.28), top)
        placements = (*placements[:index], moved, *placements[index + 1 :])
        here = here.moved(placements)
        fresh = Arrangement.afresh(world, placements)
        for carried, anew in zip(value_of(here), value_of(fresh), strict=True):
            assert np.array_equal(carried, anew)
        assert answers(world, here) == answers(world, fresh)
        seen.add(tuple(here.picks[SIDE].barred.any(axis=1).tolist()))
    assert len(seen) > 5
