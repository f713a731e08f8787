"""The XML of a benchmark problem: things, their meshes and poses, and the robot's start.

A pose is a 3x4 matrix in one row. A thing on which something can be put has an `sssp`, a region in
its own frame, which may be a single point. A `gc` is a class of grasps, from the side or the top.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runtime.world.solids import Floats
from sketchlang.errors import InputError
from sketchlang.reading import read_xml
from sketchlang.suggest import did_you_mean

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

GRASPS = ("side", "top")

MESHES = "meshes"
"""What folders with meshes are called, or end with."""

FLAT = 0.003
"""Metres: what is not higher is a mark on what it lies on, or a picture on a side."""

UPRIGHT = 1e-3
"""How far the z axis of a thing may be from the world's."""


@dataclass(frozen=True)
class Region:
    """Where something can be put on a thing, in its frame (m)."""

    low: tuple[float, float]
    high: tuple[float, float]
    z: float

    @property
    def is_point(self) -> bool:
        """Whether only one place will do."""
        return self.high[0] - self.low[0] < 1e-6 and self.high[1] - self.low[1] < 1e-6


@dataclass(frozen=True, eq=False)
class Thing:
    """An object or a piece of furniture; lengths in metres, angles in radians."""

    name: str
    mesh: Path
    at: tuple[float, float, float]
    yaw: float
    movable: bool
    grasps: frozenset[str]
    region: Region | None

    @cached_property
    def pieces(self) -> list[Floats]:
        """The corners (k, 3) of each connected piece that is not flat, in its own frame."""
        from runtime.world.load_mesh import pieces_of_mesh

        pieces = pieces_of_mesh(self.mesh)
        solid = [piece for piece in pieces if (np.ptp(piece, axis=0) > FLAT).all()]
        return solid or [np.vstack(pieces)]

    @cached_property
    def box(self) -> Floats:
        """The lowest and the highest corner (2, 3) of the box around it, in its own frame."""
        corners = np.vstack(self.pieces)
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    @property
    def bottom(self) -> float:
        """The height of its lowest point."""
        return float(self.at[2] + self.box[0, 2])

    @property
    def top(self) -> float:
        """The height of its highest point."""
        return float(self.at[2] + self.box[1, 2])

    def world(self, xy: Floats) -> Floats:
        """A point of its own frame (2,) in the world."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return np.array([self.at[0] + c * xy[0] - s * xy[1], self.at[1] + s * xy[0] + c * xy[1]])

    @property
    def is_peg(self) -> bool:
        """Whether it does not move, and things are put over it: their place is at its bottom."""
        region = self.region
        if self.movable or region is None or not region.is_point:
            return False
        return self.top - self.bottom > FLAT and self.shoulder < (self.bottom + self.top) / 2

    @property
    def has_knob(self) -> bool:
        """Whether what is put on it goes over something: its place is below its top."""
        return self.region is not None and self.region.is_point and self.shoulder < self.top - FLAT

    @property
    def shoulder(self) -> float:
        """The height at which the bottom of what is put on it is."""
        return self.top if self.region is None else self.at[2] + self.region.z

    @property
    def middle(self) -> Floats:
        """Where the middle of the box around it is (2,), in the world."""
        return self.world(self.box.mean(axis=0)[:2])

    def is_under(self, xy: Floats) -> bool:
        """Whether a point of the world (2,) is over the box around it."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        dx, dy = xy[0] - self.at[0], xy[1] - self.at[1]
        own = np.array([c * dx + s * dy, c * dy - s * dx])
        return bool((own >= self.box[0, :2]).all() and (own <= self.box[1, :2]).all())


@dataclass(frozen=True, eq=False)
class Problem:
    """All things of a problem, and the pose of the robot's base: x, y (m) and heading (rad)."""

    things: dict[str, Thing]
    start: tuple[float, float, float]
    base_moves: bool

    def movable(self) -> Iterator[Thing]:
        """The objects."""
        return (thing for thing in self.things.values() if thing.movable)

    def fixed(self) -> Iterator[Thing]:
        """The furniture, marks included."""
        return (thing for thing in self.things.values() if not thing.movable)


def read_problem(path: Path) -> Problem:
    """Read a problem; its meshes are in a folder `meshes` or `..._meshes` beside the file or
    beside its folder.

    Raises:
        InputError: it cannot be read, or a thing leans.
    """
    root = read_xml(path)
    reader = _Reader(path)
    things: dict[str, Thing] = {}
    for element in root.iter("obj"):
        thing = reader.thing(element)
        if thing.name in things:
            raise reader.error(thing.name, "is there twice")
        things[thing.name] = thing
    if not things:
        raise InputError("has no <obj>: is it a problem of the benchmark?", place=str(path))
    robot = root.find(".//robot")
    if robot is None:
        raise InputError("has no <robot>", place=str(path))
    (x, y, _), yaw = reader.pose(robot, "basepose", "robot")
    moves = reader.text(robot, "movebase", "robot", "true") != "false"
    return Problem(things, (x, y, yaw), moves)


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path

    def error(self, name: str, message: str, hint: str | None = None) -> InputError:
        return InputError(f"{name} {message}", place=str(self.path), hint=hint)

    def text(self, element: Element, tag: str, name: str, default: str | None = None) -> str:
        found = element.findtext(tag, default)
        if found is None or not found.strip():
            raise self.error(name, f"has no <{tag}>")
        return found.strip()

    def numbers(self, element: Element, tag: str, name: str, count: int) -> list[float]:
        words = self.text(element, tag, name).split()
        try:
            values = [float(word) for word in words]
        except ValueError:
            values = []
        if len(values) != count or not all(math.isfinite(value) for value in values):
            raise self.error(name, f"has a <{tag}> that is not {count} numbers")
        return values

    def pose(
        self, element: Element, tag: str, name: str
    ) -> tuple[tuple[float, float, float], float]:
        matrix = np.array(self.numbers(element, tag, name, 12)).reshape(3, 4)
        rotation = matrix[:, :3]
        turned = np.allclose(rotation @ rotation.T, np.eye(3), atol=UPRIGHT)
        if not turned or rotation[2, 2] < 1 - UPRIGHT:
            raise self.error(name, f"has a <{tag}> that leans: only turns about z are supported")
        x, y, z = (float(value) for value in matrix[:, 3])
        return (x, y, z), math.atan2(rotation[1, 0], rotation[0, 0])

    def thing(self, element: Element) -> Thing:
        name = self.text(element, "name", "an <obj>")
        at, yaw = self.pose(element, "pose", name)
        mesh = self.mesh(name, self.text(element, "geom", name))
        grasps = {grasp.get("type", "") for grasp in element.iter("gc")}
        for unknown in sorted(grasps - set(GRASPS)):
            hint = did_you_mean(unknown, GRASPS) or f"known are {' and '.join(GRASPS)}"
            raise self.error(name, f"has grasps of the unknown type {unknown!r}", hint)
        region = element.find("sssp")
        return Thing(
            name=name,
            mesh=mesh,
            at=at,
            yaw=yaw,
            movable=self.text(element, "moveable", name, "false") == "true",
            grasps=frozenset(grasps),
            region=None if region is None else self.region(region, name),
        )

    def mesh(self, name: str, file: str) -> Path:
        """Where a mesh is: the files have lain in two ways, together and by kind."""
        beside = self.path.absolute().parent
        folders = [beside / MESHES]
        for folder in (beside, beside.parent):
            folders += sorted(folder.glob(f"*_{MESHES}"))
        for folder in folders:
            if (folder / file).is_file():
                return folder / file
        raise self.error(
            name,
            f"has a mesh that is not there: {file}",
            f"meshes are in {MESHES} or ..._{MESHES}, beside the file or beside its folder",
        )

    def region(self, element: Element, name: str) -> Region:
        low, high = (
            [self.numbers(element, f"{axis}{end}", name, 1)[0] for axis in "xyz"]
            for end in ("min", "max")
        )
        return Region((low[0], low[1]), (high[0], high[1]), low[2])
