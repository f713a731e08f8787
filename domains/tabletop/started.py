"""States as scene files: the file of the problem, with the robot and the objects where they are.

Furniture, objects and goals stay as they were written. A goal `at = "start"` becomes the point
that it meant, for the start is another one now.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import AnyGoal, Goal, PoseGoal, Scene, SingleGoal
from domains.tabletop.state import Placement, State
from domains.tabletop.world import TabletopWorld
from runtime.reporting import UnsayableError
from runtime.toml_text import document
from runtime.world.poses import Floats, Pose, compose
from runtime.world.snap import middle_of
from sketchlang.analysis.words import listed
from sketchlang.errors import InputError
from sketchlang.files import write_text
from sketchlang.reading import read_toml

DIGITS = 7
"""Decimals of lengths and angles: finer than the steps of states."""

SAME = 2e-5
"""Metres, and lengths of turned unit vectors, that a pose may be off when it is read again."""

SAME_HEIGHT = 1e-3
"""The same for heights: the planner sees what is round as a polyhedron around it."""

Table = dict[str, Any]


def started_from(world: TabletopWorld, state: State, file: Path) -> str:
    """The text of a scene file that starts in a state of the world of a scene file.

    Raises:
        UnsayableError: scene files have no words for the state.
    """
    _refuse(world, state)
    data: Table = deepcopy(read_toml(file))
    x, y, yaw = state.base.pose
    data["robot_start"] = [round(x, DIGITS), round(y, DIGITS), round(math.degrees(yaw), DIGITS)]
    poses = _poses(world, state)
    for index, entry in enumerate(data["object"]):
        _place(world, state, index, entry, poses[index])
        if "mesh" in entry:
            entry["mesh"] = str((file.parent / entry["mesh"]).resolve())
    data["goal"] = [goal for entry in data["goal"] for goal in _goals(world.scene, entry)]
    text = document(data)
    _confirm(world, state, poses, text)
    return text


def _refuse(world: TabletopWorld, state: State) -> None:
    """Raises where there are no words for what is particular about a state."""
    if state.held is not None:
        name = world.items[state.held].name
        raise UnsayableError(f"{name} is in the hand, and scenes begin with an empty one")
    if state.facts != world.initial.facts:
        names = sorted({name for name, _ in {*state.facts} ^ {*world.initial.facts}})
        raise UnsayableError(f"scenes know nothing of {listed(names)}")
    for index, placement in enumerate(state.placements):
        if placement is not None and placement.face and index in world.scene.goals:
            name = world.items[index].name
            raise UnsayableError(
                f"{name} stands on another side than at the start, and its goal goes by that"
            )


def _poses(world: TabletopWorld, state: State) -> list[Pose]:
    """The poses of all objects' bodies; none of them is held."""
    found = []
    for index, placement in enumerate(state.placements):
        standing = world.pose(state.placements, index)
        assert placement is not None
        assert standing is not None
        found.append(compose(standing, world.item(index, placement.face).standing))
    return found


def _place(world: TabletopWorld, state: State, index: int, entry: Table, pose: Pose) -> None:
    """Puts an object where it is in a state; what did not move is left as it was written."""
    if _is_same(pose, world.scene.world.movables[index].pose):
        return
    for key in ("yaw", "rpy", "bottom"):
        entry.pop(key, None)
    placement = state.placements[index]
    assert placement is not None
    x, y, _ = middle_of(world.items[index].body, pose).tolist()
    entry["at"] = [round(x, DIGITS), round(y, DIGITS)]
    entry["on"] = _names(world.scene, _bearers(world.scene, index, placement))
    *tilt, yaw = (round(math.degrees(angle), DIGITS) + 0.0 for angle in _rpy(pose))
    entry.update({"rpy": [*tilt, yaw]} if any(tilt) else {"yaw": yaw})


def _bearers(scene: Scene, index: int, placement: Placement) -> tuple[int, ...]:
    """The supports that bear an object: several only where its goal says so."""
    for goal in _singles(scene.goals.get(index)):
        if isinstance(goal, PoseGoal) and goal.support == placement.support:
            return goal.support, *goal.others
    return (placement.support,)


def _singles(goal: Goal | None) -> tuple[SingleGoal, ...]:
    """The goals of which one will do."""
    if isinstance(goal, AnyGoal):
        return goal.alternatives
    return () if goal is None else (goal,)


def _names(scene: Scene, supports: tuple[int, ...]) -> str | list[str]:
    names = [scene.supports[support].name for support in supports]
    return names if len(names) > 1 else names[0]


def _rpy(pose: Pose) -> tuple[float, float, float]:
    """Roll, pitch and yaw (fixed axes) of a pose, radians."""
    r = pose[:, :3]
    pitch = math.asin(min(1.0, max(-1.0, -float(r[2, 0]))))
    if abs(r[2, 0]) > 1 - 1e-9:
        return 0.0, pitch, math.atan2(-r[0, 1], r[1, 1])
    return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])


def _goals(scene: Scene, entry: Table) -> Iterator[Table]:
    """A goal as it was written; where it speaks of the start, with points, for each object."""
    parts = entry.get("any", [entry])
    if not any(part.get("at") == "start" for part in parts):
        yield entry
        return
    for index, thing in enumerate(scene.objects):
        if thing.name != entry.get("object") and thing.colour != entry.get("colour", ""):
            continue
        singles = _singles(scene.goals[index])
        made = [_pointed(scene, p, s) for p, s in zip(parts, singles, strict=True)]
        rest = {key: value for key, value in made[0].items() if key != "colour"}
        yield {"object": thing.name, **({"any": made} if "any" in entry else rest)}


def _pointed(scene: Scene, part: Table, goal: SingleGoal) -> Table:
    if part.get("at") != "start":
        return part
    assert isinstance(goal, PoseGoal)
    on = _names(scene, (goal.support, *goal.others))
    return {**part, "at": [goal.x, goal.y], "on": on}


def _confirm(world: TabletopWorld, state: State, poses: list[Pose], text: str) -> None:
    """Raises where the text, read again, is another state or has other goals."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        write_text(path, text)
        try:
            scene = load_scene(path)
        except InputError as error:
            raise UnsayableError(f"a scene file would be refused: {error.message}") from error
    for thing, pose in zip(scene.world.movables, poses, strict=True):
        if not _is_same(thing.pose, pose):
            raise UnsayableError(f"{thing.name} would stand otherwise in a scene file")
    if scene.goals != world.scene.goals or scene.word != world.scene.word:
        raise UnsayableError("its goals would be others in a scene file")


def _is_same(a: Pose, b: Pose) -> bool:
    difference: Floats = np.abs(a - b)
    height = float(difference[2, 3])
    difference[2, 3] = 0.0
    return float(difference.max()) < SAME and height < SAME_HEIGHT
