"""One instance of the pick-and-place domain. Metres, radians, world frame."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from runtime.world import goals as world_goals
from runtime.world.body import Body, Part
from runtime.world.poses import upright
from runtime.world.solids import Box
from runtime.world.world import Fixed, Movable, Support, World

Floats = NDArray[np.float64]

DENSITY = 500.0
"""kg/m^3 of objects whose scene does not give their mass: light wood."""


@dataclass(frozen=True, slots=True)
class UprightBox:
    """A box that turns about z only: centre, full size, heading."""

    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw: float = 0.0

    def row(self) -> Floats:
        """Packed for the kernels (8,): centre, half extents, cos and sin of the heading."""
        return np.array(
            [*self.centre, *(s / 2 for s in self.size), math.cos(self.yaw), math.sin(self.yaw)]
        )

    def local(self, x: float, y: float) -> tuple[float, float]:
        """A point of the plane in the frame of the box."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        dx, dy = x - self.centre[0], y - self.centre[1]
        return c * dx + s * dy, c * dy - s * dx

    def world(self, lx: float, ly: float) -> tuple[float, float]:
        """A point of the plane given in the frame of the box."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return self.centre[0] + c * lx - s * ly, self.centre[1] + s * lx + c * ly


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Something that never moves: a wall, a fence panel, the body of a table."""

    name: str
    box: UprightBox


@dataclass(frozen=True, slots=True)
class Surface:
    """The top of a table: where objects may rest (`half`, around the centre of the table).

    `rest` is the height of the bottom of a resting object.
    """

    name: str
    table: UprightBox
    half: tuple[float, float]
    rest: float

    def contains(self, x: float, y: float, inset: float = 0.0) -> bool:
        """Whether a point of the plane is on the surface, `inset` metres from its edge."""
        lx, ly = self.table.local(x, y)
        return abs(lx) <= self.half[0] - inset and abs(ly) <= self.half[1] - inset


@dataclass(frozen=True, slots=True)
class SceneObject:
    """A movable box: its size, and the pose (x, y, heading) in which it starts."""

    name: str
    size: tuple[float, float, float]
    start: tuple[float, float, float]
    surface: int
    colour: str | None = None
    letter: str | None = None


@dataclass(frozen=True, slots=True)
class RegionGoal:
    """The object must stand anywhere on a surface."""

    surface: int


@dataclass(frozen=True, slots=True)
class PoseGoal:
    """The object must stand within `tolerance` of a point, in any heading."""

    surface: int
    x: float
    y: float
    tolerance: float


@dataclass(frozen=True, slots=True)
class WordGoal:
    """Blocks must spell a word on a surface, letters in a row, `pitch` between centres."""

    word: str
    surface: int
    pitch: float
    tolerance: float


Goal = RegionGoal | PoseGoal


@dataclass(frozen=True, eq=False)
class Scene:
    """A scene; `goals` maps the index of an object to what is wanted of it."""

    name: str
    robot_start: tuple[float, float, float]
    surfaces: tuple[Surface, ...]
    obstacles: tuple[Obstacle, ...]
    objects: tuple[SceneObject, ...]
    goals: dict[int, Goal]
    word: WordGoal | None
    digest: str
    families: tuple[int, ...] = (0,)

    @cached_property
    def obstacle_rows(self) -> Floats:
        """All obstacles packed for the kernels (w, 8)."""
        return np.array([obstacle.box.row() for obstacle in self.obstacles]).reshape(-1, 8)

    def object_box(self, index: int, x: float, y: float, yaw: float, surface: int) -> UprightBox:
        """The box of an object that stands at a pose on a surface."""
        size = self.objects[index].size
        return UprightBox((x, y, self.surfaces[surface].rest + size[2] / 2), size, yaw)

    @cached_property
    def world(self) -> World:
        """The geometry of the scene: all that the judge, traces, physics and drawings need."""
        return World(
            name=self.name,
            digest=self.digest,
            robot_start=self.robot_start,
            fixed=tuple(
                Fixed(o.name, box_body(o.box.size), upright(*_foot(o.box), o.box.yaw))
                for o in self.obstacles
            ),
            movables=tuple(
                Movable(
                    thing.name,
                    box_body(thing.size),
                    upright(*thing.start[:2], self.surfaces[thing.surface].rest, thing.start[2]),
                    thing.colour,
                    thing.letter,
                )
                for thing in self.objects
            ),
            supports=tuple(
                Support(s.name, s.name, upright(*s.table.centre[:2], s.rest, s.table.yaw), s.half)
                for s in self.surfaces
            ),
            goals=tuple(self._wanted()),
        )

    def _wanted(self) -> Iterator[world_goals.Goal]:
        for index, goal in self.goals.items():
            body, surface = self.objects[index].name, self.surfaces[goal.surface]
            if isinstance(goal, PoseGoal):
                x, y = surface.table.local(goal.x, goal.y)
                yield world_goals.RestsAt(body, surface.name, x, y, goal.tolerance)
            else:
                yield world_goals.RestsOn(body, surface.name)
        if self.word is not None:
            word, surface = self.word, self.surfaces[self.word.surface]
            yield world_goals.Spelled(word.word, surface.name, word.pitch, word.tolerance)


def box_body(size: tuple[float, float, float]) -> Body:
    """A box as a body: its frame is in the middle of its bottom."""
    solid = Box(size)
    middle = upright(0.0, 0.0, size[2] / 2, 0.0)
    return Body((Part(solid, middle),), DENSITY * solid.volume, (0.0, 0.0, size[2] / 2))


def _foot(box: UprightBox) -> tuple[float, float, float]:
    x, y, z = box.centre
    return x, y, z - box.size[2] / 2
