"""Read and validate scene files (TOML). `docs/scenes.md` describes the format."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from runtime.errors import InputError
from runtime.kernels.boxes import pose_vs_upright
from runtime.robot.urdf import rotation_from_rpy
from runtime.scene.model import (
    Goal,
    Obstacle,
    PoseGoal,
    RegionGoal,
    Scene,
    SceneObject,
    Surface,
    UprightBox,
    WordGoal,
)
from runtime.tables import Table, read_toml

DEFAULT_TOLERANCE = 0.005
"""Metres; the published tolerance of point goals."""


def load_scene(path: Path, name: str | None = None) -> Scene:
    """Read a scene.

    Raises:
        InputError: with file, table and key, for whatever is wrong with it.
    """
    table = read_toml(path)
    surfaces, obstacles = _tables(table)
    obstacles += _walls(table)
    objects = _objects(table, surfaces)
    goals, word = _goals(table, surfaces, objects)
    start = table.numbers("robot_start", 3)
    table.finish()
    _refuse_overlaps(table, surfaces, obstacles, objects)
    return Scene(
        name=name or path.stem,
        robot_start=(start[0], start[1], math.radians(start[2])),
        surfaces=tuple(surfaces),
        obstacles=tuple(obstacles),
        objects=tuple(objects),
        goals=goals,
        word=word,
        digest=hashlib.sha256(path.read_bytes()).hexdigest(),
    )


def _positive(table: Table, key: str, values: Sequence[float]) -> list[float]:
    if any(value <= 0 for value in values):
        raise table.error(key, f"sizes must be positive, found {list(values)}")
    return list(values)


def _tables(scene: Table) -> tuple[list[Surface], list[Obstacle]]:
    surfaces: list[Surface] = []
    obstacles: list[Obstacle] = []
    if scene.has("arena"):
        arena = scene.table("arena")
        inner, outer = arena.number("inner"), arena.number("outer")
        height = arena.number("height")
        if not 0 < inner < outer:
            raise arena.error("outer", "the fence needs 0 < inner < outer")
        middle, thick = (inner + outer) / 2, outer - inner
        for side, (x, y) in {"east": (1, 0), "north": (0, 1), "west": (-1, 0), "south": (0, -1)}.items():
            size = (thick, 2 * outer, height) if x else (2 * outer, thick, height)
            box = UprightBox((x * middle, y * middle, height / 2), size)
            obstacles.append(Obstacle(f"fence_{side}", box))
    tables = scene.tables("table")
    if not tables:
        raise InputError("a scene needs at least one [[table]]", place=scene.place)
    for table in tables:
        at, size = table.numbers("at", 2), _positive(table, "size", table.numbers("size", 2))
        region = table.numbers("region", 2) if table.has("region") else size
        if region[0] > size[0] or region[1] > size[1]:
            raise table.error("region", "the region is larger than the table")
        top, rest = table.number("top"), table.number("rest")
        if rest < top:
            raise table.error("rest", f"objects would rest inside the table (its top is at {top})")
        yaw = math.radians(table.number("yaw", 0.0))
        # The body of a table reaches down to the floor: nobody drives under it.
        box = UprightBox((at[0], at[1], top / 2), (size[0], size[1], top), yaw)
        name = table.text("name")
        if any(name == surface.name for surface in surfaces):
            raise table.error("name", f"there are two tables named {name!r}")
        surfaces.append(Surface(name, box, (region[0] / 2, region[1] / 2), rest))
        obstacles.append(Obstacle(name, box))
    return surfaces, obstacles


def _walls(scene: Table) -> list[Obstacle]:
    walls = []
    for wall in scene.tables("wall"):
        at, size = wall.numbers("at", 2), _positive(wall, "size", wall.numbers("size", 3))
        bottom = wall.number("bottom", 0.0)
        centre = (at[0], at[1], bottom + size[2] / 2)
        yaw = math.radians(wall.number("yaw", 0.0))
        box = UprightBox(centre, (size[0], size[1], size[2]), yaw)
        walls.append(Obstacle(wall.text("name"), box))
    return walls


def _objects(scene: Table, surfaces: Sequence[Surface]) -> list[SceneObject]:
    objects: list[SceneObject] = []
    for entry in scene.tables("object"):
        name = entry.text("name")
        if any(name == other.name for other in objects):
            raise entry.error("name", f"there are two objects named {name!r}")
        size, at = _positive(entry, "size", entry.numbers("size", 3)), entry.numbers("at", 2)
        yaw = math.radians(entry.number("yaw", 0.0))
        on = [i for i, surface in enumerate(surfaces) if surface.contains(at[0], at[1])]
        if not on:
            raise entry.error("at", f"({at[0]:g}, {at[1]:g}) is not on a table")
        if entry.has("bottom"):
            bottom, surface = entry.number("bottom"), surfaces[on[0]]
            top = surface.table.size[2]
            if bottom < top:
                raise entry.error(
                    "bottom",
                    f"the object is inside {surface.name!r}: its bottom is at {bottom:g} m, "
                    f"the top of the table at {top:g} m",
                    hint="leave `bottom` out: objects rest on their table",
                )
            if abs(bottom - surface.rest) > 1e-6:
                raise entry.error("bottom", f"objects on {surface.name!r} rest at {surface.rest:g} m")
        objects.append(
            SceneObject(
                name,
                (size[0], size[1], size[2]),
                (at[0], at[1], yaw),
                on[0],
                entry.text("colour") if entry.has("colour") else None,
                entry.text("letter") if entry.has("letter") else None,
            )
        )
    return objects


def _goals(
    scene: Table, surfaces: Sequence[Surface], objects: Sequence[SceneObject]
) -> tuple[dict[int, Goal], WordGoal | None]:
    goals: dict[int, Goal] = {}
    word: WordGoal | None = None
    for entry in scene.tables("goal"):
        if entry.has("word"):
            if word is not None:
                raise entry.error("word", "a scene can ask for one word only")
            word = _word_goal(entry, surfaces, objects)
            continue
        for index in _goal_objects(entry, objects):
            if index in goals:
                raise InputError(f"{objects[index].name!r} has two goals", place=entry.place)
            goals[index] = _goal(entry, objects[index], surfaces)
    if not goals and word is None:
        raise InputError(
            "a scene needs at least one [[goal]]",
            place=scene.place,
            hint='for example: [[goal]] colour = "blue", on = "table1"',
        )
    return goals, word


def _goal_objects(entry: Table, objects: Sequence[SceneObject]) -> list[int]:
    if entry.has("object"):
        name = entry.text("object")
        found = [i for i, o in enumerate(objects) if o.name == name]
        if not found:
            raise entry.error("object", f"there is no object named {name!r}")
        return found
    colour = entry.text("colour")
    found = [i for i, o in enumerate(objects) if o.colour == colour]
    if not found:
        raise entry.error("colour", f"no object is {colour!r}")
    return found


def _surface(entry: Table, key: str, surfaces: Sequence[Surface]) -> int:
    name = entry.text(key)
    for i, surface in enumerate(surfaces):
        if surface.name == name:
            return i
    known = ", ".join(surface.name for surface in surfaces)
    raise entry.error(key, f"there is no table named {name!r}", hint=f"tables: {known}")


def _goal(entry: Table, thing: SceneObject, surfaces: Sequence[Surface]) -> Goal:
    if not entry.has("at"):
        return RegionGoal(_surface(entry, "on", surfaces))
    tolerance = entry.number("tolerance", DEFAULT_TOLERANCE)
    if entry.is_text("at") and entry.text("at") == "start":
        return PoseGoal(thing.surface, thing.start[0], thing.start[1], tolerance)
    x, y = entry.numbers("at", 2)
    on = [i for i, surface in enumerate(surfaces) if surface.contains(x, y)]
    if not on:
        raise entry.error("at", f"({x:g}, {y:g}) is not on a table")
    return PoseGoal(on[0], x, y, tolerance)


def _word_goal(
    entry: Table, surfaces: Sequence[Surface], objects: Sequence[SceneObject]
) -> WordGoal:
    word = entry.text("word")
    missing = [c for c in set(word) if sum(o.letter == c for o in objects) < word.count(c)]
    if not word or missing:
        raise entry.error("word", f"not enough blocks with the letters {sorted(missing)}")
    surface = _surface(entry, "on", surfaces)
    pitch = entry.number("pitch")
    depths = [o.size[0] for o in objects if o.letter in set(word)]
    if pitch < max(depths):
        raise entry.error("pitch", f"blocks of {max(depths):g} m do not fit a pitch of {pitch:g} m")
    if pitch * (len(word) - 1) + max(depths) > 2 * max(surfaces[surface].half):
        raise entry.error("word", f"{word!r} is longer than {surfaces[surface].name!r}")
    return WordGoal(word, surface, pitch, entry.number("tolerance", DEFAULT_TOLERANCE))


def _refuse_overlaps(
    scene: Table,
    surfaces: Sequence[Surface],
    obstacles: Sequence[Obstacle],
    objects: Sequence[SceneObject],
) -> None:
    """No object may start inside another one, a wall or a table."""
    boxes = []
    for thing in objects:
        x, y, yaw = thing.start
        rest = surfaces[thing.surface].rest
        boxes.append((thing.name, UprightBox((x, y, rest + thing.size[2] / 2), thing.size, yaw)))
    others = [(obstacle.name, obstacle.box) for obstacle in obstacles]
    for i, (name, box) in enumerate(boxes):
        for other, other_box in boxes[:i] + others:
            if _overlap(box, other_box):
                raise InputError(
                    f"{name!r} starts inside {other!r}",
                    place=f"{scene.place}: [[object]] {name}",
                    hint="move one of them apart",
                )


def _overlap(a: UprightBox, b: UprightBox) -> bool:
    pose = np.empty((3, 4))
    pose[:, :3] = rotation_from_rpy(0.0, 0.0, a.yaw)
    pose[:, 3] = a.centre
    half = np.array(a.size) / 2
    hit: bool = pose_vs_upright(pose, half, float(np.linalg.norm(half)), b.row(), 0.0)
    return hit
