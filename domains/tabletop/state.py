"""States and ground actions (paper, State-Space S and Action Schemas Act).

Poses are quantised to integers where they enter the planner, here, and compared exactly
from then on: a novelty table needs equality that is transitive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from domains.tabletop.world import Task

UNIT = 1e-5
"""Metres and radians of one step of a quantised coordinate."""

TURN = round(2 * math.pi / UNIT)


def quantise(value: float) -> int:
    """A length in whole steps."""
    return round(value / UNIT)


def quantise_angle(angle: float) -> int:
    """An angle in whole steps of one turn, [0, 2 pi)."""
    return round(angle / UNIT) % TURN


class Placement(NamedTuple):
    """Where an object stands: quantised x, y and heading, index of the surface."""

    x: int
    y: int
    yaw: int
    surface: int

    @classmethod
    def of(cls, x: float, y: float, yaw: float, surface: int) -> Placement:
        return cls(quantise(x), quantise(y), quantise_angle(yaw), surface)

    @property
    def pose(self) -> tuple[float, float, float]:
        """x, y in metres, heading in radians."""
        return self.x * UNIT, self.y * UNIT, self.yaw * UNIT


class BasePose(NamedTuple):
    """Where the robot stands: quantised x, y and heading."""

    x: int
    y: int
    yaw: int

    @classmethod
    def of(cls, x: float, y: float, yaw: float) -> BasePose:
        return cls(quantise(x), quantise(y), quantise_angle(yaw))

    @property
    def pose(self) -> tuple[float, float, float]:
        """x, y in metres, heading in radians."""
        return self.x * UNIT, self.y * UNIT, self.yaw * UNIT


class Grasp(NamedTuple):
    """A side grasp: quantised heading of the approach in the object's frame, and height
    of the grasp centre above the object's bottom. `flipped` turns the gripper over."""

    angle: int
    height: int
    flipped: bool = False

    @classmethod
    def of(cls, angle: float, height: float, flipped: bool = False) -> Grasp:
        return cls(quantise_angle(angle), quantise(height), flipped)

    @property
    def heading(self) -> float:
        """Heading of the approach in the object's frame, radians."""
        return self.angle * UNIT


class MoveBase(NamedTuple):
    """Move-Base(b, b')."""

    target: BasePose


class Pick(NamedTuple):
    """Pick(b, o, g) from where the robot stands."""

    object: int
    grasp: Grasp


class Place(NamedTuple):
    """Place(b, o, p, sigma) from where the robot stands; the placement's heading is sigma."""

    object: int
    placement: Placement


Action = MoveBase | Pick | Place


@dataclass(frozen=True, slots=True)
class State:
    """The robot's base pose, where every object stands (None: held), and the grasp.

    Between actions the arm is in its home posture. `task` gives domain functions access to
    the scene's geometry; it is the same object in all states of one run.
    """

    base: BasePose
    placements: tuple[Placement | None, ...]
    held: int | None = None
    grasp: Grasp | None = None
    task: Task = field(compare=False, repr=False, default=None)  # type: ignore[assignment]

    def after(self, action: Action) -> State:
        """The state that an action leads to (N of the paper, for an executable action)."""
        match action:
            case MoveBase(target):
                return State(target, self.placements, self.held, self.grasp, self.task)
            case Pick(index, grasp):
                placements = (*self.placements[:index], None, *self.placements[index + 1 :])
                return State(self.base, placements, index, grasp, self.task)
            case Place(index, placement):
                placements = (*self.placements[:index], placement, *self.placements[index + 1 :])
                return State(self.base, placements, None, None, self.task)
