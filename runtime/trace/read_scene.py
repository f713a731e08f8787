"""The scene of a trace file."""

from __future__ import annotations

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
from runtime.plan.node import Node, index_of, name_of


def scene_of(node: Node) -> Scene:
    """The scene that a node of a trace file describes."""
    surfaces: list[Surface] = []
    obstacles: list[Obstacle] = []
    obstacles += [Obstacle(wall["name"].text(), _box(wall["box"])) for wall in node["walls"].each()]
    for entry in node["tables"].each():
        box, region = _box(entry["box"]), entry["region"].numbers((2,)).tolist()
        name, rest = entry["name"].text(), entry["rest"].number()
        surfaces.append(Surface(name, box, (region[0] / 2, region[1] / 2), rest))
        obstacles.append(Obstacle(name, box))
    objects = [_object(entry, len(surfaces)) for entry in node["objects"].each()]
    names = [thing.name for thing in objects]
    goals: dict[int, Goal] = {}
    for entry in node["goals"].each():
        index = names.index(name_of(entry["object"], names))
        surface = index_of(entry["table"], len(surfaces), "table")
        if "at" in entry.value:
            x, y = entry["at"].numbers((2,)).tolist()
            goals[index] = PoseGoal(surface, x, y, entry["tolerance"].number())
        else:
            goals[index] = RegionGoal(surface)
    word = node["word"].optional()
    if word is not None and not word["word"].text():
        raise word["word"].fail("a word has letters")
    start = node["robot_start"].numbers((3,)).tolist()
    return Scene(
        name=node["name"].text(),
        robot_start=(start[0], start[1], start[2]),
        surfaces=tuple(surfaces),
        obstacles=tuple(obstacles),
        objects=tuple(objects),
        goals=goals,
        word=None
        if word is None
        else WordGoal(
            word["word"].text(),
            index_of(word["table"], len(surfaces), "table"),
            word["pitch"].number(),
            word["tolerance"].number(),
        ),
        digest=node["digest"].text(),
    )


def _object(node: Node, surfaces: int) -> SceneObject:
    size, start = node["size"].numbers((3,)), node["start"].numbers((3,)).tolist()
    if size.min() <= 0:
        raise node["size"].fail("sizes must be positive")
    a, b, c = size.tolist()
    colour, letter = node["colour"].optional(), node["letter"].optional()
    return SceneObject(
        node["name"].text(),
        (a, b, c),
        (start[0], start[1], start[2]),
        index_of(node["table"], surfaces, "table"),
        None if colour is None else colour.text(),
        None if letter is None else letter.text(),
    )


def _box(node: Node) -> UprightBox:
    x, y, z = node["centre"].numbers((3,)).tolist()
    size = node["size"].numbers((3,))
    if size.min() <= 0:
        raise node["size"].fail("sizes must be positive")
    a, b, c = size.tolist()
    return UprightBox((x, y, z), (a, b, c), node["yaw"].number())
