"""Goals judged on exact poses."""

from __future__ import annotations

import pytest

from domains.tabletop.scene.load import load_scene
from runtime.judge.goals import spells, unmet
from tests.tabletop.scene.texts import SCENE, WORD, write_scene


def test_region_and_pose_goals(tmp_path) -> None:
    scene = load_scene(write_scene(tmp_path, SCENE))
    there = {0: (1, (0.8, -0.8, 0.3)), 1: (1, (0.903, -1.004, 2.0))}
    assert unmet(scene, there) == []
    assert "blue1 is not on right" in unmet(scene, there | {0: (0, (0.8, 0.6, 0.0))})
    assert "red1 is 10.0 mm" in unmet(scene, there | {1: (1, (0.91, -1.0, 0.0))})[0]
    assert "outside the region" in unmet(scene, there | {0: (1, (0.8, -0.5, 0.0))})[0]


@pytest.mark.parametrize(
    ("a", "b", "spelt"),
    [
        ((0.8, -0.9), (0.87, -0.9), True),  # along x of the table
        ((0.87, -0.9), (0.8, -0.9), True),  # read from the other side
        ((0.8, -0.9), (0.8, -0.83), True),  # along y
        ((0.8, -0.9), (0.8, -0.97), True),
        ((0.8, -0.9), (0.9, -0.9), False),  # too far apart
        ((0.8, -0.9), (0.85, -0.85), False),  # aslant
        ((0.8, -0.9), (0.876, -0.9), True),  # within the tolerance
    ],
)
def test_words_are_read_along_either_side(tmp_path, a, b, spelt) -> None:
    scene = load_scene(write_scene(tmp_path, WORD))
    poses = {0: (1, (*a, 0.0)), 1: (1, (*b, 0.0))}
    assert spells(scene, poses) == spelt
    assert bool(unmet(scene, poses)) != spelt


def test_a_word_on_another_table_does_not_count(tmp_path) -> None:
    scene = load_scene(write_scene(tmp_path, WORD))
    assert not spells(scene, {0: (0, (0.8, 0.6, 0.0)), 1: (0, (0.87, 0.6, 0.0))})
