"""Scenes and states as top views."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import Scene
from domains.tabletop.state import State
from runtime.show.top_view import (
    Patch,
    Point,
    Sort,
    Thing,
    TopView,
    goal_body,
    goal_text,
    outline,
)
from runtime.world.body import Part
from runtime.world.goals import AnyOf, Goal, RestsAt
from runtime.world.outline import vertices_and_edges
from runtime.world.poses import Pose, apply, compose
from runtime.world.solids import Hull, Solid
from runtime.world.world import FLOOR, Support

Shape = tuple[tuple[Part, ...], Pose]
"""Solids, and the frame in which they are given, in the world."""


def view_of_file(path: str, name: str) -> TopView:
    """A scene as it is at the start.

    Raises:
        InputError: the scene is not as it should be.
    """
    return view_of_scene(load_scene(Path(path), name))


def view_of_scene(scene: Scene) -> TopView:
    """A scene as it is at the start."""
    shapes = {i: (t.body.parts, t.pose) for i, t in enumerate(scene.world.movables)}
    places = [f"on {scene.supports[thing.rests.support].name}" for thing in scene.objects]
    return _view(scene, shapes, places, scene.robot_start)


def view_of_state(state: State) -> TopView:
    """A state of a run. What is in the hand, and what stands on that, is in no place."""
    world = state.world
    shapes, places = {}, []
    for i, placement in enumerate(state.placements):
        pose = world.pose(state.placements, i)
        if pose is not None:
            shapes[i] = (world.items[i].parts, pose)
        if placement is None:
            places.append("in the hand")
        else:
            places.append(f"on {world.grounds[placement.support].name}")
    return _view(world.scene, shapes, places, state.base.pose)


def _view(
    scene: Scene,
    shapes: Mapping[int, Shape],
    places: list[str],
    robot: tuple[float, float, float],
) -> TopView:
    owners = {support.owner for support in scene.supports}
    patches: list[Patch] = []
    for thing in scene.world.fixed:
        sort = Sort.SUPPORT if thing.name in owners else Sort.OBSTACLE
        patches += _patches(sort, thing.name, thing.body.parts, thing.pose)
    for i, (parts, pose) in shapes.items():
        told = scene.objects[i]
        patches += _patches(Sort.OBJECT, told.name, parts, pose, told.colour)
    goals = {body: goal for goal in scene.world.goals if (body := goal_body(goal)) is not None}
    movable = {thing.name for thing in scene.objects}
    things = []
    for i, told in enumerate(scene.objects):
        goal = goals.get(told.name)
        middle = _middle(*shapes[i]) if i in shapes else None
        wanted = None if goal is None else goal_text(goal)
        things.append(Thing(told.name, told.colour, told.letter, places[i], wanted, middle))
    return TopView(
        name=scene.name,
        patches=tuple(sorted(patches, key=lambda patch: patch.top)),
        things=tuple(things),
        supports=tuple(
            (support.name, float(support.pose[2, 3]))
            for support in scene.supports
            if support.owner not in movable and support.owner != FLOOR
        ),
        marks=tuple(_marks(scene.world.goals, _pose_of(scene.supports, movable))),
        robot=robot,
        wanted=tuple(goal_text(goal) for goal in scene.world.goals if goal_body(goal) is None),
    )


def _patches(
    sort: Sort, name: str, parts: tuple[Part, ...], pose: Pose, colour: str | None = None
) -> Iterator[Patch]:
    for part in parts:
        points = apply(compose(pose, part.pose), _corners(part.solid))
        yield Patch(sort, name, outline(points), float(points[:, 2].max()), colour)


def _corners(solid: Solid) -> np.ndarray:
    return solid.points if isinstance(solid, Hull) else vertices_and_edges(solid)[0]


def _middle(parts: tuple[Part, ...], pose: Pose) -> Point:
    points = np.vstack([apply(compose(pose, p.pose), _corners(p.solid)) for p in parts])
    x, y = ((points.min(axis=0) + points.max(axis=0)) / 2)[:2].tolist()
    return x, y


def _pose_of(supports: tuple[Support, ...], movable: set[str]) -> Callable[[str], Pose | None]:
    """The pose in the world of a support that never moves, by its name."""
    fixed = {s.name: s.pose for s in supports if s.owner not in movable}
    return fixed.get


def _marks(
    goals: tuple[Goal, ...], pose_of: Callable[[str], Pose | None]
) -> Iterator[tuple[str, Point]]:
    """The points that goals name on what never moves."""
    for goal in goals:
        if isinstance(goal, AnyOf):
            yield from _marks(goal.goals, pose_of)
        elif isinstance(goal, RestsAt):
            pose = pose_of(goal.support)
            if pose is not None:
                x, y, _ = apply(pose, np.array([[goal.x, goal.y, 0.0]]))[0].tolist()
                yield goal.body, (x, y)
