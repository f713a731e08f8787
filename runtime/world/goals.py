"""What is wanted of a world, as plain data; `runtime.judge.goals` decides whether it holds."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RestsOn:
    """A body rests anywhere on a support."""

    body: str
    support: str


@dataclass(frozen=True)
class RestsAt:
    """A body rests on a support, its middle (that of the box around it, along its own axes)
    within `tolerance` metres of a point there: x, y in the support's frame. `yaw` is its heading
    there, that of its stable pose, radians, where that matters: within `yaw_tolerance`, and up
    to turns by a full circle divided by `symmetry`."""

    body: str
    support: str
    x: float
    y: float
    tolerance: float
    yaw: float | None = None
    yaw_tolerance: float = 0.05
    symmetry: int = 1


@dataclass(frozen=True)
class IsHeld:
    """A body is in the gripper."""

    body: str


@dataclass(frozen=True)
class Spelled:
    """Bodies spell a word on a support by their labels, in a row along one of its axes,
    `pitch` metres between the middles of neighbours; each within `tolerance` of its place."""

    word: str
    support: str
    pitch: float
    tolerance: float


@dataclass(frozen=True)
class AnyOf:
    """At least one of some goals."""

    goals: tuple[Goal, ...]


Goal = RestsOn | RestsAt | IsHeld | Spelled | AnyOf
