"""A benchmark problem as a scene file, with notes on what the scene cannot say."""

from __future__ import annotations

import itertools
import math
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from domains.tabletop.state import FAMILIES
from domains.tabletop.tmp_benchmark.problem import FLAT, Problem, Thing
from domains.tabletop.tmp_benchmark.wanted import Wanted
from runtime.world.pegs import name_of_ring
from runtime.world.solids import Floats
from sketchlang.errors import InputError

RESTS = 0.03
"""Metres between a thing and what it is said to rest on, at most: the files are not exact."""

SLAB = 0.005
"""Metres of thickness of what is only drawn as a sheet."""

BOX_LIKE = 0.97
"""What fills this part of the box around it is that box."""

APART = 0.005
"""Metres between objects that were separated."""

COLOURS = ("red", "green", "blue", "yellow", "black", "white", "orange", "purple")


@dataclass
class _Scene:
    problem: Problem
    wanted: Wanted
    folder: Path  # of the scene file
    separate: bool
    floor: float = 0.0
    notes: list[str] = field(default_factory=list)
    places: dict[str, Floats] = field(default_factory=dict)  # where objects start, if moved

    def boards(self) -> list[Thing]:
        """Furniture on which several things find room."""
        return [t for t in self.problem.fixed() if t.region is not None and not t.region.is_point]

    def under(self, thing: Thing) -> Thing | None:
        """What a thing rests on: a peg that it is over, else of the things under its middle the
        highest one that is not above its bottom; None: the floor."""
        over = [peg for peg in self.problem.fixed() if peg.is_peg and self._is_over(thing, peg)]
        if over:
            return over[0]
        found = [
            other
            for other in (*self.boards(), *self.problem.movable())
            if other is not thing
            and other.is_under(thing.middle)
            and min(abs(z - thing.bottom) for z in (other.top, other.shoulder)) < RESTS
            and other.bottom < thing.bottom
        ]
        return max(found, key=lambda other: other.top, default=None)

    @staticmethod
    def _is_over(thing: Thing, peg: Thing) -> bool:
        """Whether a thing is over a peg, on what that stands on."""
        at_bottom = abs(peg.bottom - thing.bottom) < RESTS
        return thing.movable and at_bottom and peg.is_under(thing.middle)


def scene_of(
    problem: Problem,
    wanted: Wanted,
    folder: Path,
    separate: bool = False,
    any_grasp: bool = False,
    start: tuple[float, float, float] | None = None,
) -> tuple[str, list[str]]:
    """The text of a scene file that lies in `folder`, and notes on what it leaves out or changes.

    Args:
        separate: objects that start in one another are moved apart.
        any_grasp: objects may be held from all sides, not only as the problem lists.
        start: where the robot starts instead, x, y (m) and heading (rad).

    Raises:
        InputError: the goal wants what a scene cannot say, or objects start in one another.
    """
    scene = _Scene(problem, wanted, folder, separate)
    scene.floor = min(min(thing.at[2], thing.bottom) for thing in problem.fixed())
    goals = [_goal(scene, problem.things[name], places) for name, places in wanted.goals.items()]
    _separate(scene)
    x, y, yaw = start or problem.start
    grasps = sorted({grasp for thing in problem.movable() for grasp in thing.grasps})
    if any_grasp:
        grasps = list(FAMILIES)
    lines = [f"robot_start = {_list([x, y, math.degrees(yaw)])}"]
    if grasps:
        lines.append(f"approaches = [{', '.join(map(_text, grasps))}]")
    for thing in problem.fixed():
        lines += ["", *_furniture(scene, thing)]
    for thing in problem.movable():
        lines += ["", *_object(scene, thing)]
    for goal in goals:
        lines += ["", *goal]
    if not problem.base_moves:
        scene.notes.append("the robot's base is to stay where it is there (movebase=false); here "
                           "it moves, if the robot has one that can")  # fmt: skip
    for name, place in wanted.start.items():
        _compare_start(scene, problem.things[name], problem.things[place])
    text = re.sub(r"\n{3,}", "\n\n", "\n".join(lines)) + "\n"
    return text, scene.notes


def _furniture(scene: _Scene, thing: Thing) -> list[str]:
    low, high = thing.box
    if thing.region is not None and not thing.region.is_point:
        return _table(scene, thing)
    if high[2] - low[2] <= FLAT:
        return []  # a mark: goals refer to it
    frame = _frame(thing)
    if frame is not None:
        inner, outer = frame
        return [
            "[arena]",
            f"inner = {_number(inner)}",
            f"outer = {_number(outer)}",
            f"height = {_number(thing.top - scene.floor)}",
        ]
    if thing.is_peg and len(thing.pieces) == 1:
        return _peg(scene, thing)
    if thing.region is not None:
        scene.notes.append(f"{thing.name}: nothing can be put over it here; it is in the way")
    return _walls(scene, thing, thing.pieces, thing.name)


def _table(scene: _Scene, thing: Thing) -> list[str]:
    """A top, with the pieces below it as walls; one piece alone is solid down to the floor."""
    region = thing.region
    assert region is not None
    highest = max(thing.pieces, key=lambda piece: float(piece[:, 2].max()))
    below = [piece for piece in thing.pieces if piece is not highest]
    low, high = highest.min(axis=0), highest.max(axis=0)
    middle = (low + high)[:2] / 2
    half = [
        min(region.high[i] - middle[i], middle[i] - region.low[i], (high - low)[i] / 2)
        for i in range(2)
    ]
    if min(half) <= 0:
        raise InputError(f"{thing.name}: its region is not on it")
    lines = [
        "[[table]]",
        f"name = {_text(thing.name)}",
        f"at = {_list(thing.world(middle))}",
        *_yaw(thing),
        f"size = {_list((high - low)[:2])}",
        f"top = {_number(thing.top - scene.floor)}",
        f"region = {_list([2 * h for h in half])}",
    ]
    deep = thing.top - thing.at[2] - low[2]
    stands = thing.bottom - scene.floor < RESTS
    if below or not stands:
        thickness = max(SLAB, min(deep, thing.top - scene.floor - APART))
        lines.insert(-1, f"thickness = {_number(thickness)}")
    elif thing.top - scene.floor > 10 * RESTS:
        scene.notes.append(f"{thing.name} is one piece in its mesh: here it is solid to the floor")
    for number, piece in enumerate(below, 1):
        lines += ["", *_walls(scene, thing, [piece], f"{thing.name} leg {number}")]
    return lines


def _peg(scene: _Scene, thing: Thing) -> list[str]:
    """An upright rod as large as the thing, on what the thing stands on."""
    corners, middle = np.vstack(thing.pieces), thing.box.mean(axis=0)
    radius = float(np.hypot(*(corners[:, :2] - middle[:2]).T).max())
    board = scene.under(thing)
    return [
        "[[peg]]",
        f"name = {_text(thing.name)}",
        f"at = {_list(thing.middle)}",
        f"radius = {_number(radius)}",
        f"height = {_number(thing.top - thing.bottom)}",
        f"on = {_text('floor' if board is None else board.name)}",
    ]


def _support(thing: Thing) -> str:
    """What the place for things on a thing is called."""
    return name_of_ring(thing.name) if thing.movable and thing.has_knob else thing.name


def _walls(scene: _Scene, thing: Thing, pieces: list[Floats], name: str) -> list[str]:
    """The boxes around some pieces, as walls."""
    lines = []
    for number, piece in enumerate(pieces, 1):
        low, high = piece.min(axis=0), piece.max(axis=0)
        bottom = max(0.0, thing.at[2] + low[2] - scene.floor)
        lines += [
            "",
            "[[wall]]",
            f"name = {_text(name if len(pieces) == 1 else f'{name} {number}')}",
            f"at = {_list(thing.world((low + high)[:2] / 2))}",
            *_yaw(thing),
            f"size = {_list([*(high - low)[:2], high[2] - low[2]])}",
            f"bottom = {_number(bottom)}",
        ]
    return lines[1:]


def _frame(thing: Thing) -> tuple[float, float] | None:
    """Half the inner and outer width of a square fence around the origin, or None."""
    corners = np.vstack(thing.pieces)
    away = np.abs(thing.world(corners[:, :2].T).T).max(axis=1)
    inner, outer = float(away.min()), float(away.max())
    square = np.all(np.minimum(np.abs(away - inner), np.abs(away - outer)) < 1e-3)
    turned = abs(math.remainder(thing.yaw, math.pi / 2)) < 1e-3
    hollow = inner > 0.5 * outer and outer > 1.0
    return (inner, outer) if square and turned and hollow else None


def _object(scene: _Scene, thing: Thing) -> list[str]:
    rests = scene.under(thing)
    lines = ["[[object]]", f"name = {_text(thing.name)}", *_shape(scene, thing)]
    colours = [colour for colour in COLOURS if colour in thing.name.lower()]
    if len(colours) == 1:
        lines.append(f"colour = {_text(colours[0])}")
    lines.append(f"on = {_text('floor' if rests is None else _support(rests))}")
    if rests is None or not (rests.movable or rests.is_peg):
        lines.append(f"at = {_list(scene.places.get(thing.name, thing.middle))}")
    elif np.linalg.norm(rests.middle - thing.middle) > APART:
        lines.append(f"at = {_list(thing.middle)}")
    kept = scene.wanted.only_on.get(thing.name)
    if kept is not None:
        names = {_support(scene.problem.things[name]) for name in kept}
        names |= {"floor" if rests is None else _support(rests)}
        lines.append(f"only_on = [{', '.join(_text(name) for name in sorted(names))}]")
    return [*lines, *_yaw(thing)]


def _shape(scene: _Scene, thing: Thing) -> list[str]:
    from runtime.world.load_mesh import filling

    size = thing.box[1] - thing.box[0]
    corners = np.vstack(thing.pieces)
    if filling(thing.mesh) > BOX_LIKE and _hull(corners) > BOX_LIKE * float(size.prod()):
        return [f"size = {_list(size)}"]
    mesh = Path(os.path.relpath(thing.mesh, scene.folder)).as_posix()
    return ['shape = "mesh"', f"mesh = {_text(mesh)}"]


def _hull(corners: Floats) -> float:
    """The volume of the convex hull of some points (m^3)."""
    from scipy.spatial import ConvexHull

    return float(ConvexHull(corners).volume)


def _goal(scene: _Scene, thing: Thing, choices: list[str]) -> list[str]:
    places = [_place(scene, thing, scene.problem.things[choice]) for choice in choices]
    lines = ["[[goal]]", f"object = {_text(thing.name)}"]
    if len(places) == 1:
        return [*lines, *(f"{key} = {value}" for key, value in places[0].items())]
    listed = (", ".join(f"{k} = {v}" for k, v in place.items()) for place in places)
    return [*lines, "any = [", *(f"  {{ {place} }}," for place in listed), "]"]


def _place(scene: _Scene, thing: Thing, place: Thing) -> dict[str, str]:
    """Keys of a goal: on a board or an object, or at a mark on a board."""
    if place.movable or (place.region is not None and not place.region.is_point) or place.is_peg:
        return {"on": _text(_support(place))}
    if np.ptp(place.box[:, 2]) > FLAT:
        raise InputError(
            f"{thing.name} is to be put on {place.name}: it is no peg, and has no place for things"
        )
    board = scene.under(place)
    if board is None:
        raise InputError(f"{place.name} lies on nothing: {thing.name} cannot be put there")
    x, y = place.middle
    return {"at": _list([x, y]), "on": _text(board.name)}


def _compare_start(scene: _Scene, thing: Thing, place: Thing) -> None:
    """A note where the two files do not agree about where something starts."""
    rests = scene.under(thing)
    if rests is place or (np.ptp(place.box[:, 2]) <= FLAT and place.is_under(thing.middle)):
        return
    here = "the floor" if rests is None else rests.name
    scene.notes.append(
        f"{thing.name} starts on {here}, as the XML has it; the PDDL says {place.name}"
    )


def _separate(scene: _Scene) -> None:
    """Move objects out of each other, or refuse what cannot stand like that."""
    standing: list[Thing] = []
    for thing in scene.problem.movable():
        inside = [t for t in standing if _gap(scene, thing, thing.middle, t, _narrow) < 0]
        if inside and not scene.separate:
            raise InputError(
                f"{thing.name} and {inside[0].name} start in one another",
                hint="--separate-overlaps moves such objects apart",
            )
        if inside:
            place = next((xy for xy in _around(thing) if _is_free(scene, thing, xy)), None)
            if place is None:
                raise InputError(f"{thing.name} finds no free place near {inside[0].name}")
            moved = 100 * float(np.linalg.norm(place - thing.middle))
            scene.places[thing.name] = place
            scene.notes.append(
                f"{thing.name} starts in {inside[0].name}: moved by {moved:.0f} cm to "
                f"({place[0]:.2f}, {place[1]:.2f})"
            )
        standing.append(thing)


def _around(thing: Thing) -> Iterator[Floats]:
    """Places on rings around the middle of a thing, the nearest first."""
    for ring, turn in itertools.product(range(1, 21), range(16)):
        angle = 2 * math.pi * turn / 16
        yield thing.middle + 0.02 * ring * np.array([math.cos(angle), math.sin(angle)])


def _is_free(scene: _Scene, thing: Thing, xy: Floats) -> bool:
    board = scene.under(thing)
    others = [other for other in scene.problem.movable() if other is not thing]
    on_it = board is None or all(
        board.is_under(xy + _wide(thing) * np.array(way))
        for way in ((1, 0), (-1, 0), (0, 1), (0, -1))
    )
    return on_it and all(_gap(scene, thing, xy, other, _wide) > APART for other in others)


def _gap(
    scene: _Scene, thing: Thing, xy: Floats, other: Thing, radius: Callable[[Thing], float]
) -> float:
    """Metres between circles around two things in the plane; infinite for what is above the
    other."""
    if thing.bottom > other.top - RESTS or other.bottom > thing.top - RESTS:
        return math.inf
    pairs = ((thing, other), (other, thing))
    if any(low.has_knob and scene.under(high) is low for low, high in pairs):
        return math.inf  # one goes over the knob of the other
    there = scene.places.get(other.name, other.middle)
    return float(np.linalg.norm(xy - there)) - radius(thing) - radius(other)


def _narrow(thing: Thing) -> float:
    """The radius of the largest circle in the box around a thing (m)."""
    return float(np.ptp(thing.box[:, :2], axis=0).min()) / 2


def _wide(thing: Thing) -> float:
    """The radius of the circle around that box (m)."""
    return float(np.linalg.norm(np.ptp(thing.box[:, :2], axis=0))) / 2


def _yaw(thing: Thing) -> list[str]:
    turn = math.degrees(thing.yaw)
    return [f"yaw = {_number(turn)}"] if abs(turn) > 1e-4 else []


def _text(text: str) -> str:
    return '"' + re.sub(r'[\\"\x00-\x1f\x7f]', "_", text) + '"'


def _number(value: float) -> str:
    return repr(round(float(value), 6) + 0.0)


def _list(values: Floats | list[float]) -> str:
    return "[" + ", ".join(_number(value) for value in values) + "]"
