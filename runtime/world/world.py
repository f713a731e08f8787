"""A world: what stands fixed, what can be moved, and where things can rest.

This is all that the judge, traces, physics and drawings know of a task. World frame: origin
on the floor, z up; metres, radians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from runtime.world.body import Body
from runtime.world.goals import Goal
from runtime.world.poses import Pose

FLOOR = "floor"
"""The name of the floor, wherever one is shown or may be rested on."""


@dataclass(frozen=True)
class Guide:
    """How something that is fixed can move all the same: a door about its hinge (`"revolute"`,
    radians), a drawer along its rails (`"prismatic"`, metres). `axis` is a unit vector, `origin`
    a point on it, in the world; where it stands at the start is 0."""

    type: str
    axis: tuple[float, float, float]
    origin: tuple[float, float, float]
    lower: float
    upper: float


@dataclass(frozen=True, eq=False)
class Fixed:
    """Something that nothing moves (a table, a wall, a shelf) but a tool that follows its
    `guide`, if it has one; and its pose (3, 4)."""

    name: str
    body: Body
    pose: Pose
    guide: Guide | None = None


@dataclass(frozen=True, eq=False)
class Movable:
    """Something that can be moved, and its pose (3, 4) at the start. `label` is shown on it
    (a letter), `colour` is how it is painted. It may rest on the supports `only_on`, on any where
    that is None."""

    name: str
    body: Body
    pose: Pose
    colour: str | None = None
    label: str | None = None
    only_on: frozenset[str] | None = None


@dataclass(frozen=True)
class Peg:
    """What stands up from the middle of a support: only what is hollow from below goes there, over
    it. Metres: the radius of an upright cylinder around it, and how far it rises above the height
    at which bottoms rest."""

    radius: float
    height: float


@dataclass(frozen=True, eq=False)
class Support:
    """A horizontal region that things can rest on: a table's top, a board of a shelf, the floor
    of a bin, the top of an object.

    `owner` is the name of the fixed or movable thing it belongs to (`FLOOR` for the floor).
    `pose` (3, 4) puts the middle of the region, at the height at which bottoms rest, into the
    owner's frame if that can be moved, else into the world; its z is up. `half` are half its
    extents along x and y, `clearance` the metres free above it but for a `peg`, if it has one.
    """

    name: str
    owner: str
    pose: Pose
    half: tuple[float, float]
    clearance: float = math.inf
    peg: Peg | None = None


@dataclass(frozen=True, eq=False)
class World:
    """A world at the start of a task, and what is wanted of it. `robot_start` is x, y, heading
    of the robot's base."""

    name: str
    digest: str
    robot_start: tuple[float, float, float]
    fixed: tuple[Fixed, ...]
    movables: tuple[Movable, ...]
    supports: tuple[Support, ...]
    goals: tuple[Goal, ...] = ()

    def index(self, name: str) -> int:
        """The index of a movable.

        Raises:
            KeyError: there is none of that name.
        """
        for i, thing in enumerate(self.movables):
            if thing.name == name:
                return i
        raise KeyError(name)
