"""Towers that goals describe: where there is room for them."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from domains.tabletop.features.functions import arrangement, misplaced
from domains.tabletop.features.towers import storeys, ways
from domains.tabletop.problem import load_problem
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.domain import LoadOptions
from sketchlang.loader import load_sketch

SIDE = 0.06  # metres of a cube


def scene(folder: Path, number: int, ceiling: float) -> str:
    """A table and a tray beside it; over the table a ceiling, so many metres above its top.
    Cubes stand on the table, the lowest of the tower among them."""
    cubes = "".join(
        f"""
[[object]]
name = "c{i}"
size = [{SIDE}, {SIDE}, {SIDE}]
on = "table"
at = [0.52, {0.25 - 0.14 * i:.3f}]
"""
        for i in range(number)
    )
    stacked = "".join(f'\n[[goal]]\nobject = "c{i}"\non = "c{i - 1}"\n' for i in range(1, number))
    text = f"""robot_start = [-0.6, 0.0, 0.0]
approaches = ["side", "top", "slant"]

[[table]]
name = "table"
at = [0.7, 0.0]
size = [0.5, 0.9]
top = 0.6
thickness = 0.03

[[table]]
name = "tray"
at = [-0.5, 1.2]
size = [0.3, 0.4]
top = 0.6
thickness = 0.03

[[wall]]
name = "ceiling"
at = [0.7, 0.0]
size = [0.5, 0.9, 0.03]
bottom = {0.6 + ceiling}
{cubes}
[[goal]]
object = "c0"
any = [{{ on = "table" }}, {{ on = "tray" }}]
{stacked}"""
    path = folder / f"{number}-{ceiling}.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def loaded(path: str):
    """The problem's world, and its initial state."""
    problem = load_problem(path, LoadOptions())
    return problem.world, problem.initial


def test_storeys_are_what_goals_put_on_an_object(tmp_path) -> None:
    world, _ = loaded(scene(tmp_path, 4, 1.0))
    found = storeys(world, 0)
    assert [each.index for each in found] == [1, 2, 3]
    assert [each.z for each in found] == pytest.approx(
        [k * (SIDE + 0.002) for k in (1, 2, 3)], abs=0.003
    )
    assert storeys(world, 3) == ()


@pytest.mark.parametrize("number", [2, 4, 6])
def test_there_are_not_more_ways_with_less_room(tmp_path, number: int) -> None:
    counts = []
    for ceiling in (0.2, 0.4, 0.7, 1.2):
        world, state = loaded(scene(tmp_path, number, ceiling))
        counts.append(ways(world, 0, world.rests(state.placements, 0)))
    assert counts == sorted(counts)
    assert counts[-1] > 0


def test_what_leaves_no_room_for_the_tower_is_not_its_place(tmp_path) -> None:
    low, high = loaded(scene(tmp_path, 6, 0.35)), loaded(scene(tmp_path, 6, 1.2))
    assert 0 in misplaced(low[1])  # the tower would meet the ceiling
    assert 0 not in misplaced(high[1])
    world, state = low
    goal = world.goal_sites(0, arrangement(world, state.placements))
    assert goal is not None
    assert world.grounds[goal.support].name == "tray"


def test_a_tower_goes_where_it_has_room(tmp_path) -> None:
    path = scene(tmp_path, 5, 0.35)
    task = open_task(load_sketch("pick_and_place").checked, path, 0, None)
    result = task.solve(Limits(timeout=60))
    assert result.solved, result.outcome.reason
    world, state = task.problem.world, result.outcome.state
    feet = [world.rests(state.placements, i) for i in range(5)]
    assert world.grounds[state.placements[0].support].name == "tray"
    for lower, upper in pairwise(feet):
        assert np.hypot(upper[0] - lower[0], upper[1] - lower[1]) < 0.01
        assert upper[2] > lower[2] + SIDE - 1e-3
