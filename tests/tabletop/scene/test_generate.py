"""Generated sorting scenes are valid tasks of the size asked for."""

from __future__ import annotations

import pytest

from domains.tabletop.features.functions import arrangement, misplaced
from domains.tabletop.scene.generate import sorting_scene
from domains.tabletop.scene.load import load_scene
from domains.tabletop.world import TabletopWorld
from runtime.robot.load import load_robot


@pytest.mark.parametrize("objects", [1, 2, 10, 28, 29, 100, 200])
def test_a_generated_scene_is_a_task_of_its_size(tmp_path, objects) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(sorting_scene(objects, seed=objects))
    scene = load_scene(path)
    assert len(scene.objects) == objects
    world = TabletopWorld.of(scene, load_robot("tiago"))
    # A goal object that stood on its goal table would need no planning.
    assert misplaced(world.initial) == frozenset(scene.goals)
    here = arrangement(world, world.initial.placements)
    assert all(here.is_reachable(i) for i in range(objects))


def test_a_seed_makes_one_scene() -> None:
    assert sorting_scene(50, 3) == sorting_scene(50, 3) != sorting_scene(50, 4)
