"""Scenes of boxes that stand on tables, made without a file."""

from __future__ import annotations

from collections.abc import Sequence

from domains.tabletop.scene.model import (
    Goal,
    Obstacle,
    Scene,
    SceneObject,
    Start,
    Surface,
    WordGoal,
    fixed_box,
    movable,
)
from domains.tabletop.scene.wanted import wanted_of
from runtime.world.making import standing
from runtime.world.poses import upright
from runtime.world.solids import Box
from runtime.world.stable import stable_poses
from runtime.world.world import Support, World


def standing_box(
    name: str,
    size: tuple[float, float, float],
    start: tuple[float, float, float],
    surface: int,
    colour: str | None = None,
    letter: str | None = None,
) -> SceneObject:
    """A box that stands as it is described."""
    body = standing(Box(size))
    return SceneObject(name, body, stable_poses(body), Start(surface, 0, *start), colour, letter)


def scene_of_boxes(
    name: str,
    robot_start: tuple[float, float, float],
    surfaces: Sequence[Surface],
    obstacles: Sequence[Obstacle],
    objects: Sequence[SceneObject],
    goals: dict[int, Goal],
    word: WordGoal | None,
    digest: str,
) -> Scene:
    """A scene of boxes that stand on tables."""
    supports = [
        Support(s.name, s.name, upright(*s.table.centre[:2], s.rest, s.table.yaw), s.half)
        for s in surfaces
    ]
    return Scene(
        World(
            name=name,
            digest=digest,
            robot_start=robot_start,
            fixed=tuple(fixed_box(o.name, o.box) for o in obstacles),
            movables=tuple(movable(thing, surfaces[thing.rests.support].rest) for thing in objects),
            supports=tuple(supports),
            goals=wanted_of(goals, word, objects, supports),
        ),
        tuple(objects),
        goals,
        word,
    )
