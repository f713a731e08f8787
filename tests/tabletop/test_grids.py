"""Sticks in dense grids, some of which belong on another table: from the outside in."""

from __future__ import annotations

import random

import pytest

from domains.tabletop.features.functions import arrangement
from runtime.search.limits import Limits
from runtime.solve import Task, open_task
from sketchlang.loader import load_sketch

TABLES = """
robot_start = [-0.6, 0.0, 0.0]
{}
[[table]]
name = "a"
at = [0.8, 0.0]
size = [0.8, 1.1]
top = 0.7
[[table]]
name = "b"
at = [-1.8, 0.0]
size = [0.8, 1.4]
top = 0.7
[[goal]]
colour = "blue"
on = "b"
"""
STICK = """
[[object]]
name = "s{0}_{1}"
size = [0.04, 0.04, 0.2]
at = [{2:.3f}, {3:.3f}]
colour = "{4}"
"""


def grid(folder, spacing: float, rows: int, columns: int, blue: int, seed: int, side: bool) -> Task:
    """Rows along y and columns along x, so many metres apart."""
    rng = random.Random(seed)
    cells = [(i, j) for i in range(columns) for j in range(rows)]
    chosen = set(rng.sample(cells, blue))
    sticks = [
        STICK.format(
            i,
            j,
            0.8 + (i - (columns - 1) / 2) * spacing,
            (j - (rows - 1) / 2) * spacing,
            "blue" if (i, j) in chosen else "grey",
        )
        for i, j in cells
    ]
    scene = folder / "grid.toml"
    scene.write_text(TABLES.format('approaches = ["side"]' if side else "") + "".join(sticks))
    return open_task(load_sketch("pick_and_place").checked, str(scene), seed)


def test_the_middle_of_a_grid_is_reached_by_taking_away_what_is_around(tmp_path) -> None:
    """In a block of five by five each stick bars others: the middle one is taken in several
    steps, each of which lowers v, and the objects that are to go first can be picked up."""
    task = grid(tmp_path, 0.07, 5, 5, 25, 0, side=True)
    world = task.problem.initial.world
    here = arrangement(world, world.initial.placements)
    middle = 12
    goal = world.goal_sites(middle, here)
    assert goal is not None
    placements = world.initial.placements
    alpha = here.obstructions(middle, goal)
    assert alpha > 1
    assert not here.free_headings(middle, world.families[0])
    steps = 0
    while alpha:
        clear = here.in_the_way(middle, goal)
        ready = [i for i in clear if here.free_headings(i, world.families[0])]
        assert ready
        placements = (*placements[: ready[0]], None, *placements[ready[0] + 1 :])
        here, before = arrangement(world, placements), alpha
        alpha = here.obstructions(middle, goal)
        assert alpha < before
        steps += 1
    assert steps > 1
    assert here.free_headings(middle, world.families[0])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spacing", "rows", "columns"), [(0.08, 11, 7), (0.07, 12, 8), (0.06, 15, 9)]
)
@pytest.mark.parametrize("side", [True, False])
def test_dense_grids_are_solved(tmp_path, spacing, rows, columns, side) -> None:
    for seed in range(2):
        found = grid(tmp_path, spacing, rows, columns, 12, seed, side).solve(Limits(timeout=300))
        assert found.solved, found.outcome.reason
        assert found.plan.validate().valid
