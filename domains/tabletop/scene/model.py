"""One instance of the pick-and-place domain. Metres, radians, world frame."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from runtime.world.body import Body
from runtime.world.making import standing
from runtime.world.poses import Pose, compose, heading, upright
from runtime.world.snap import resting_pose
from runtime.world.solids import Box
from runtime.world.stable import StablePose
from runtime.world.world import Fixed, Movable, Support, World

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
class Start:
    """Where an object rests at the start: the index of the support, the number of its stable
    pose, where its middle is (x, y) and its heading, in the world. `others` are further supports
    that bear it, at the same height."""

    support: int
    stable: int
    x: float
    y: float
    yaw: float
    others: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class SceneObject:
    """Something that can be moved, its stable poses, and how it rests at the start."""

    name: str
    body: Body
    stable: tuple[StablePose, ...]
    rests: Start
    colour: str | None = None
    letter: str | None = None
    only_on: frozenset[int] | None = None
    """The supports that it may rest on; None: any."""

    @cached_property
    def size(self) -> tuple[float, float, float]:
        """The full size of the box around the body, along the axes of its frame."""
        low, high = self.body.bounds
        x, y, z = (high - low).tolist()
        return x, y, z

    @property
    def start(self) -> tuple[float, float, float]:
        """x, y and heading at the start."""
        return self.rests.x, self.rests.y, self.rests.yaw


@dataclass(frozen=True, slots=True)
class RegionGoal:
    """The object must rest anywhere on a support."""

    support: int


@dataclass(frozen=True, slots=True)
class PoseGoal:
    """The object must rest within `tolerance` metres of a point of a support, with a heading
    (radians, up to the symmetry of its stable pose) or any. In the world; in the frame of the
    support where that belongs to something that can be moved. `others` bear it as well."""

    support: int
    x: float
    y: float
    yaw: float | None
    tolerance: float
    others: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class HeldGoal:
    """The object must be in the gripper."""


@dataclass(frozen=True, slots=True)
class AnyGoal:
    """At least one of some goals for the object must hold."""

    alternatives: tuple[RegionGoal | PoseGoal | HeldGoal, ...]


@dataclass(frozen=True, slots=True)
class WordGoal:
    """Blocks must spell a word on a support, letters in a row, `pitch` between centres."""

    word: str
    support: int
    pitch: float
    tolerance: float


SingleGoal = RegionGoal | PoseGoal | HeldGoal
Goal = SingleGoal | AnyGoal


@dataclass(frozen=True, eq=False)
class Scene:
    """A scene; `goals` maps the index of an object to what is wanted of it, `families` are the
    approaches that may be used (`domains.tabletop.state`).

    Supports are in this order: tables, boards of shelves, bins, pegs, the floor, tops of objects.
    """

    world: World
    objects: tuple[SceneObject, ...]
    goals: dict[int, Goal]
    word: WordGoal | None
    families: tuple[int, ...] = (0, 1, 2)
    aslant: bool = False

    @property
    def name(self) -> str:
        """What the scene is called."""
        return self.world.name

    @property
    def digest(self) -> str:
        """SHA-256 of its file."""
        return self.world.digest

    @property
    def robot_start(self) -> tuple[float, float, float]:
        """x, y and heading of the robot's base."""
        return self.world.robot_start

    @property
    def supports(self) -> tuple[Support, ...]:
        """Where things can rest."""
        return self.world.supports

    @cached_property
    def bearing(self) -> frozenset[int]:
        """Objects on which something is to be put at a point: that is measured along their axes,
        so their heading matters even where their shape does not tell it."""
        return bearing(self.goals, self.objects, self.supports)

    @cached_property
    def surfaces(self) -> tuple[Surface, ...]:
        """The tops of tables: the first of the supports."""
        fixed = {thing.name: thing for thing in self.world.fixed}
        tables = []
        for support in self.supports:
            owner = fixed.get(support.owner)
            if owner is None or support.name != owner.name or len(owner.body.parts) > 1:
                break
            rest = float(support.pose[2, 3])
            tables.append(Surface(support.name, _upright_boxes(owner)[0], support.half, rest))
        return tuple(tables)

    @cached_property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """The boxes of everything that never moves."""
        return tuple(
            Obstacle(thing.name, box) for thing in self.world.fixed for box in _upright_boxes(thing)
        )

    @cached_property
    def obstacle_rows(self) -> Floats:
        """All obstacles packed for the kernels (w, 8)."""
        return np.array([obstacle.box.row() for obstacle in self.obstacles]).reshape(-1, 8)

    def with_boxes(self, boxes: Sequence[Obstacle]) -> Scene:
        """The scene with further things that never move."""
        fixed = (*self.world.fixed, *(fixed_box(o.name, o.box) for o in boxes))
        return replace(self, world=replace(self.world, fixed=fixed))


def _upright_boxes(thing: Fixed) -> list[UprightBox]:
    boxes = []
    for part in thing.body.parts:
        pose = compose(thing.pose, part.pose)
        if isinstance(part.solid, Box):
            x, y, z = pose[:, 3].tolist()
            boxes.append(UprightBox((x, y, z), part.solid.size, heading(pose)))
    return boxes


def fixed_box(name: str, box: UprightBox) -> Fixed:
    """A box that never moves."""
    x, y, z = box.centre
    return Fixed(name, standing(Box(box.size)), upright(x, y, z - box.size[2] / 2, box.yaw))


def bearing(
    goals: Mapping[int, Goal], objects: Sequence[SceneObject], supports: Sequence[Support]
) -> frozenset[int]:
    """The objects on which goals put something at a point that is not the middle."""
    index = {thing.name: i for i, thing in enumerate(objects)}
    singles = [
        single
        for goal in goals.values()
        for single in (goal.alternatives if isinstance(goal, AnyGoal) else (goal,))
    ]
    owners = [
        supports[goal.support].owner
        for goal in singles
        if isinstance(goal, PoseGoal) and (goal.x, goal.y) != (0.0, 0.0)
    ]
    return frozenset(index[owner] for owner in owners if owner in index)


def support_in_world(support: Support, owners: Mapping[str, Pose]) -> Pose:
    """The pose of a support in the world, where those of movable things are known by name."""
    owner = owners.get(support.owner)
    return support.pose if owner is None else compose(owner, support.pose)


def movable(thing: SceneObject, z: float) -> Movable:
    """An object at its start, on a support at height z."""
    start = thing.rests
    pose = resting_pose(thing.stable[start.stable], start.x, start.y, z, start.yaw)
    return Movable(thing.name, thing.body, pose, thing.colour, thing.letter)
