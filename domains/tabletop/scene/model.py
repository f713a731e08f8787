"""One instance of the pick-and-place domain. Metres, radians, world frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


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

    @cached_property
    def obstacle_rows(self) -> Floats:
        """All obstacles packed for the kernels (w, 8)."""
        return np.array([obstacle.box.row() for obstacle in self.obstacles]).reshape(-1, 8)

    def object_box(self, index: int, x: float, y: float, yaw: float, surface: int) -> UprightBox:
        """The box of an object that stands at a pose on a surface."""
        size = self.objects[index].size
        return UprightBox((x, y, self.surfaces[surface].rest + size[2] / 2), size, yaw)
