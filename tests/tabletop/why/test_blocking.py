"""A smallest set of things in the way: of set systems, and of scenes, against brute force."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import pytest
from hypothesis import given, settings, strategies

from domains.tabletop.why import after, before
from runtime.reasons.smallest import smallest
from runtime.search.limits import Limits
from runtime.solve import open_task
from sketchlang.errors import InputError
from sketchlang.loader import load_sketch
from tests.tabletop.why.small_scenes import SmallScene, by_brute_force, small_scene

THINGS = range(7)
WAYS = strategies.lists(strategies.frozensets(strategies.sampled_from(THINGS), min_size=1))


@given(WAYS)
@settings(max_examples=300)
def test_no_fewer_things_suffice(ways: list[frozenset[int]]) -> None:
    def possible(gone: frozenset[int]) -> bool:
        return any(way <= gone for way in ways)

    found = smallest(THINGS, possible, 60.0)
    sizes = [
        size
        for size in range(len(THINGS) + 1)
        if any(possible(frozenset(gone)) for gone in combinations(THINGS, size))
    ]
    if not sizes:
        assert found is None
    else:
        assert found is not None
        assert found.proved
        assert possible(frozenset(found.things))
        assert len(found.things) == sizes[0]


def test_what_is_possible_as_it_is_has_no_reason() -> None:
    assert smallest(THINGS, lambda gone: True, 60.0) is None


def test_without_time_nothing_is_claimed() -> None:
    assert smallest(THINGS, lambda gone: len(gone) > 3, 0.0) is None


def unsolved(folder: Any, scene: SmallScene) -> dict[str, Any] | None:
    """What `run` finds about the stick; None if the scene is solved, or is no scene."""
    path = folder / "scene.toml"
    path.write_text(scene.text())
    try:
        task = open_task(load_sketch("pick_and_place").checked, str(path))
    except InputError:
        return None  # things in one another
    outcome = task.solve(Limits()).outcome
    if outcome.solved:
        return None
    assert outcome.reason
    about = [f for f in outcome.why if f.get("object") == "a" and "rule" not in f]
    return about[0] if about else {}


def agrees(folder: Any, seed: int, most: int) -> bool | None:
    """Whether the smallest set in a scene is as brute force says, and not missing; None if
    nothing is in the way there. A set that is named has to be right."""
    scene = small_scene(seed, most)
    found = unsolved(folder, scene)
    if found is None:
        return None
    fewest = by_brute_force(load_sketch("pick_and_place").checked, folder, scene)
    named = len(found.get("blocking", ()))
    assert named in (0, fewest or 0), (seed, found)
    assert found.get("smallest", True)
    return named == (fewest or 0)


@pytest.fixture
def enough_time(monkeypatch) -> None:
    for module in (before, after):
        monkeypatch.setattr(module, "SECONDS", 60.0)


@pytest.mark.usefixtures("enough_time")
def test_the_smallest_set_is_that_of_brute_force(tmp_path) -> None:
    found = [agrees(tmp_path, seed, 3) for seed in range(20)]
    assert False not in found
    assert found.count(True) >= 4


@pytest.mark.slow
@pytest.mark.usefixtures("enough_time")
@pytest.mark.parametrize("part", range(10))
def test_two_hundred_smallest_sets_are_those_of_brute_force(tmp_path, part) -> None:
    """Twenty scenes each with something in the way. A set is looked for where the search ended,
    which may be some subgoals later than the start that brute force takes."""
    found: list[bool] = []
    for seed in range(10_000 * (part + 1), 10_000 * (part + 2)):
        same = agrees(tmp_path, seed, 5)
        if same is not None:
            found.append(same)
        if len(found) == 20:
            assert False not in found
            return
    raise AssertionError("too few scenes have something in the way")


def test_in_the_time_of_a_run_what_is_said_suffices(tmp_path) -> None:
    """Within its limits a set may be larger than it has to be; it is never too small."""
    scene = small_scene(2, 5)
    found = unsolved(tmp_path, scene)
    assert found is not None
    gone = frozenset(found["blocking"])
    assert unsolved(tmp_path, SmallScene(scene.text(gone), {})) is None
    assert all(f"without {name}" in found["text"] or name in found["text"] for name in gone)
