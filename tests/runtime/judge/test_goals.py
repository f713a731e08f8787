"""Goals judged on exact poses."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import Scene
from runtime.judge.extents import homogeneous
from runtime.judge.footing import Poses
from runtime.judge.goals import unmet
from runtime.world.goals import AnyOf, Goal, IsHeld, RestsAt, RestsOn
from runtime.world.poses import upright
from runtime.world.world import World
from tests.tabletop.scene.texts import SCENE, WORD, write_scene


def standing(scene: Scene, places: dict[int, tuple[float, float, float]]) -> Poses:
    """Objects that stand on the table that is under them."""
    rest = scene.surfaces[0].rest
    return {i: homogeneous(upright(x, y, rest, yaw)) for i, (x, y, yaw) in places.items()}


def test_region_and_pose_goals(tmp_path) -> None:
    scene = load_scene(write_scene(tmp_path, SCENE))
    there = {0: (0.8, -0.8, 0.3), 1: (0.903, -1.004, 2.0)}

    def lacks(**changed: tuple[float, float, float]) -> list[str]:
        places = there | {int(key[1:]): place for key, place in changed.items()}
        return unmet(scene.world, standing(scene, places))

    assert lacks() == []
    assert lacks(o0=(0.8, 0.6, 0.0)) == ["blue1 is not on right"]
    assert "red1 is 10.0 mm" in lacks(o1=(0.91, -1.0, 0.0))[0]
    assert lacks(o0=(0.8, -0.5, 0.0)) == ["blue1 is not on right"]


def test_what_lies_in_the_air_is_on_nothing(tmp_path) -> None:
    scene = load_scene(write_scene(tmp_path, SCENE))
    poses = dict(standing(scene, {0: (0.8, -0.8, 0.3), 1: (0.903, -1.004, 2.0)}))
    poses[0] = poses[0].copy()
    poses[0][2, 3] += 0.01
    assert unmet(scene.world, poses) == ["blue1 is not on right"]
    assert unmet(scene.world, poses, rest=0.02) == []


def wanting(world: World, *goals: Goal) -> World:
    return replace(world, goals=goals)


def test_headings_holding_and_alternatives(tmp_path) -> None:
    scene = load_scene(write_scene(tmp_path, SCENE))
    world, poses = scene.world, standing(scene, {0: (0.8, -0.8, 0.3), 1: (0.9, -1.0, 2.0)})
    there = RestsAt("red1", "right", 0.0, 0.0, 2.0, yaw=2.0)
    table = next(s for s in world.supports if s.name == "right")
    turned = math.atan2(table.pose[1, 0], table.pose[0, 0])
    assert unmet(wanting(world, replace(there, yaw=2.0 - turned)), poses) == []
    quarter = replace(there, yaw=2.0 - turned + math.pi / 2)
    assert "turned 1.571 rad" in unmet(wanting(world, quarter), poses)[0]
    assert unmet(wanting(world, replace(quarter, symmetry=4)), poses) == []
    assert unmet(wanting(world, IsHeld("red1")), poses) == ["red1 is not held"]
    left = {i: p for i, p in poses.items() if i != 1}
    assert unmet(wanting(world, IsHeld("red1")), left, {"red1"}) == []
    either = AnyOf((RestsOn("blue1", "left"), RestsOn("blue1", "right")))
    assert unmet(wanting(world, either), poses) == []
    neither = AnyOf((RestsOn("blue1", "left"), IsHeld("blue1")))
    assert unmet(wanting(world, neither), poses) == ["blue1 is not on left and blue1 is not held"]


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
    lacks = unmet(scene.world, standing(scene, {0: (*a, 0.0), 1: (*b, 0.0)}))
    assert bool(lacks) != spelt


def test_a_word_on_another_table_does_not_count(tmp_path) -> None:
    scene = load_scene(write_scene(tmp_path, WORD))
    assert unmet(scene.world, standing(scene, {0: (0.8, 0.6, 0.0), 1: (0.87, 0.6, 0.0)}))
