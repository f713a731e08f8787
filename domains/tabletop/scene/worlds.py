"""The world of a scene, for those who read worlds and no scenes: judge, traces, drawings."""

from __future__ import annotations

from domains.tabletop.scene.load import load_scene
from runtime.world.world import World
from sketchlang.library import find_scene


def find_world(name: str) -> World:
    """The world of a scene by its built-in name or its path.

    Raises:
        InputError: there is no such scene, or it has mistakes.
    """
    path, shown = find_scene(name)
    return load_scene(path, shown).world
