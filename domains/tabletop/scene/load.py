"""Read and validate scene files (TOML). `docs/scenes.md` describes the format."""

from __future__ import annotations

import difflib
import hashlib
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from domains.tabletop.scene.model import (
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
from runtime.kernels.boxes import pose_vs_upright
from runtime.tables import Table, read_toml
from runtime.world.poses import rotation_from_rpy
from sketchlang.errors import InputError
from sketchlang.reading import read_bytes

DEFAULT_TOLERANCE = 0.005
"""Metres; the published tolerance of point goals."""

AIR = 0.002
"""Metres between a table and the objects that rest on it, unless the scene says otherwise."""

LEAST_AIR = 0.0015
"""Less than that, and the planner sees objects touch the table that they rest on."""

LARGEST = 10.0
"""Metres a table may measure."""

FARTHEST = 50.0
"""Metres from the origin that things may be."""


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
    _refuse_far(table, "robot_start", start[:2])
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
        digest=hashlib.sha256(read_bytes(path)).hexdigest(),
    )


def _tables(scene: Table) -> tuple[list[Surface], list[Obstacle]]:
    surfaces: list[Surface] = []
    obstacles = _fence(scene.table("arena")) if scene.has("arena") else []
    tables = scene.tables("table")
    if not tables:
        raise InputError("a scene needs at least one [[table]]", place=scene.place)
    for table in tables:
        name, at, size = table.text("name"), _at(table), table.positives("size", 2)
        if any(name == surface.name for surface in surfaces):
            raise table.error("name", f"there are two tables named {name!r}")
        if max(size) > LARGEST:
            raise table.error("size", f"a table may measure {LARGEST:g} m at most")
        region = table.positives("region", 2) if table.has("region") else size
        if region[0] > size[0] or region[1] > size[1]:
            raise table.error("region", "the region is larger than the table")
        top = table.positive("top")
        rest = table.number("rest", top + AIR)
        if rest < top + LEAST_AIR:
            raise table.error(
                "rest",
                f"objects at {rest:g} m would touch the table, whose top is at {top:g} m",
                hint=f"leave {1000 * AIR:g} mm of air: rest = {top + AIR:g}",
            )
        yaw = math.radians(table.number("yaw", 0.0))
        # The body of a table reaches down to the floor: nobody drives under it.
        box = UprightBox((at[0], at[1], top / 2), (size[0], size[1], top), yaw)
        surfaces.append(Surface(name, box, (region[0] / 2, region[1] / 2), rest))
        obstacles.append(Obstacle(name, box))
    return surfaces, obstacles


def _at(table: Table) -> list[float]:
    """Where on the floor something is."""
    at = table.numbers("at", 2)
    _refuse_far(table, "at", at)
    return at


def _refuse_far(table: Table, key: str, lengths: Sequence[float]) -> None:
    if max(map(abs, lengths)) > FARTHEST:
        raise table.error(key, f"nothing may be further than {FARTHEST:g} m from the origin")


def _fence(arena: Table) -> list[Obstacle]:
    """Four walls around the origin."""
    inner, outer, height = arena.positive("inner"), arena.number("outer"), arena.positive("height")
    if not inner < outer:
        raise arena.error("outer", "the fence needs 0 < inner < outer")
    _refuse_far(arena, "outer", [outer])
    middle, thick = (inner + outer) / 2, outer - inner
    sides = {"east": (1, 0), "north": (0, 1), "west": (-1, 0), "south": (0, -1)}
    panels = []
    for side, (x, y) in sides.items():
        size = (thick, 2 * outer, height) if x else (2 * outer, thick, height)
        box = UprightBox((x * middle, y * middle, height / 2), size)
        panels.append(Obstacle(f"fence_{side}", box))
    return panels


def _walls(scene: Table) -> list[Obstacle]:
    walls = []
    for wall in scene.tables("wall"):
        at, size = _at(wall), wall.positives("size", 3)
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
        size, at = entry.positives("size", 3), entry.numbers("at", 2)
        yaw = math.radians(entry.number("yaw", 0.0))
        on = [i for i, surface in enumerate(surfaces) if surface.contains(at[0], at[1])]
        if not on:
            raise _off_tables(entry, at, surfaces)
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
                raise entry.error(
                    "bottom",
                    f"objects on {surface.name!r} rest at {surface.rest:g} m",
                    hint="leave `bottom` out: objects rest on their table",
                )
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
    if goals and word is not None:
        raise InputError("a scene asks for a word or for other goals, not both", place=scene.place)
    if not goals and word is None:
        raise InputError(
            "a scene needs at least one [[goal]]",
            place=scene.place,
            hint='for example: [[goal]] colour = "blue", on = "table1"',
        )
    return goals, word


def _goal_objects(entry: Table, objects: Sequence[SceneObject]) -> list[int]:
    if entry.has("object"):
        if entry.has("colour"):
            raise entry.error("colour", "a goal is for an `object` or for a `colour`, not both")
        name = entry.text("object")
        found = [i for i, o in enumerate(objects) if o.name == name]
        if not found:
            hint = _known("objects", name, [o.name for o in objects])
            raise entry.error("object", f"there is no object named {name!r}", hint)
        return found
    colour = entry.text("colour")
    found = [i for i, o in enumerate(objects) if o.colour == colour]
    if not found:
        hint = _known("colours", colour, [o.colour for o in objects if o.colour is not None])
        raise entry.error("colour", f"no object is {colour!r}", hint)
    return found


def _known(what: str, name: str, names: Iterable[str]) -> str:
    """A hint for a name that nothing has."""
    known = sorted(set(names))
    close = difflib.get_close_matches(name, known, 1)
    return f"did you mean {close[0]!r}?" if close else f"{what}: {', '.join(known) or 'none'}"


def _off_tables(entry: Table, at: Sequence[float], surfaces: Sequence[Surface]) -> InputError:
    x, y = at
    nearest = min(surfaces, key=lambda s: math.dist((x, y), s.table.centre[:2]))
    cx, cy, _ = nearest.table.centre
    return entry.error(
        "at",
        f"({x:g}, {y:g}) is not on a table",
        hint=f"the nearest one is {nearest.name!r}, around ({cx:g}, {cy:g})",
    )


def _surface(entry: Table, key: str, surfaces: Sequence[Surface]) -> int:
    name = entry.text(key)
    for i, surface in enumerate(surfaces):
        if surface.name == name:
            return i
    hint = _known("tables", name, [surface.name for surface in surfaces])
    raise entry.error(key, f"there is no table named {name!r}", hint)


def _goal(entry: Table, thing: SceneObject, surfaces: Sequence[Surface]) -> Goal:
    if not entry.has("at"):
        if entry.has("tolerance"):
            raise entry.error("tolerance", "only goals with `at` have one")
        return RegionGoal(_surface(entry, "on", surfaces))
    if entry.has("on"):
        raise entry.error("on", "a goal says either `at` which point or `on` which table")
    tolerance = entry.positive("tolerance", DEFAULT_TOLERANCE)
    if entry.is_text("at") and entry.text("at") == "start":
        return PoseGoal(thing.surface, thing.start[0], thing.start[1], tolerance)
    x, y = entry.numbers("at", 2)
    on = [i for i, surface in enumerate(surfaces) if surface.contains(x, y)]
    if not on:
        raise _off_tables(entry, (x, y), surfaces)
    return PoseGoal(on[0], x, y, tolerance)


def _word_goal(
    entry: Table, surfaces: Sequence[Surface], objects: Sequence[SceneObject]
) -> WordGoal:
    word = entry.text("word")
    if not word:
        raise entry.error("word", "the word is empty")
    missing = {c for c in word if sum(o.letter == c for o in objects) < word.count(c)}
    if missing:
        letters = ", ".join(sorted(missing))
        have = "".join(sorted(o.letter for o in objects if o.letter))
        raise entry.error(
            "word",
            f"not enough blocks with the letters {letters} for {word!r}",
            hint=f"the blocks have the letters {have}" if have else 'blocks need `letter = "A"`',
        )
    surface = _surface(entry, "on", surfaces)
    pitch = entry.positive("pitch")
    depth = max(o.size[0] for o in objects if o.letter in set(word))
    if pitch < depth:
        raise entry.error("pitch", f"blocks of {depth:g} m do not fit a pitch of {pitch:g} m")
    if pitch * (len(word) - 1) + depth > 2 * max(surfaces[surface].half):
        raise entry.error("word", f"{word!r} is longer than {surfaces[surface].name!r}")
    return WordGoal(word, surface, pitch, entry.positive("tolerance", DEFAULT_TOLERANCE))


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
