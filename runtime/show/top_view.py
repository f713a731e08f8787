"""A scene seen from above, as data: what is drawn as text and as SVG. Metres, world frame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from runtime.world.goals import AnyOf, Goal, IsHeld, RestsAt, RestsOn, Spelled
from runtime.world.poses import Floats

Point = tuple[float, float]

AIR = 0.12
"""Metres around what is drawn."""


class Sort(Enum):
    """What a patch is of."""

    SUPPORT = "support"
    OBSTACLE = "obstacle"
    OBJECT = "object"


@dataclass(frozen=True)
class Patch:
    """What a convex piece of something covers in the plane: corners in turn, and the height of
    its upper side."""

    sort: Sort
    name: str
    corners: tuple[Point, ...]
    top: float
    colour: str | None = None


@dataclass(frozen=True)
class Thing:
    """An object in words: its name, colour, label (a letter), where it is and what is wanted of
    it; `middle` is None where it is not in the picture."""

    name: str
    colour: str | None
    label: str | None
    where: str
    goal: str | None
    middle: Point | None


@dataclass(frozen=True)
class TopView:
    """All that is drawn: patches from below to above; `marks` are the points that goals name,
    with the object each is for; `robot` is x, y and heading of its base. `wanted` are goals that
    are about no single object."""

    name: str
    patches: tuple[Patch, ...]
    things: tuple[Thing, ...]
    supports: tuple[tuple[str, float], ...]
    marks: tuple[tuple[str, Point], ...]
    robot: tuple[float, float, float]
    wanted: tuple[str, ...] = ()

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x and y, greatest x and y of the picture: all but obstacles, such as a fence, is
        in it."""
        drawn = [patch for patch in self.patches if patch.sort is not Sort.OBSTACLE]
        points = [point for patch in drawn for point in patch.corners]
        points += [point for _, point in self.marks]
        points.append(self.robot[:2])
        xs, ys = [x for x, _ in points], [y for _, y in points]
        return min(xs) - AIR, min(ys) - AIR, max(xs) + AIR, max(ys) + AIR


def outline(points: Floats) -> tuple[Point, ...]:
    """The corners of the convex hull of points (n, 2 or more) in the plane, counter-clockwise
    (Andrew's monotone chain)."""
    pairs = sorted({(float(x), float(y)) for x, y in np.round(points[:, :2], 6)})
    if len(pairs) < 3:
        return tuple(pairs)

    def half(ordered: Iterable[Point]) -> list[Point]:
        chain: list[Point] = []
        for point in ordered:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return (*half(pairs), *half(reversed(pairs)))


def _turn(a: Point, b: Point, c: Point) -> float:
    """Positive where the way from a over b to c turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def contains(corners: Sequence[Point], x: float, y: float) -> bool:
    """Whether a point is in a convex polygon with corners in counter-clockwise order."""
    if len(corners) < 3:
        return False
    return all(
        _turn(corner, following, (x, y)) >= 0
        for corner, following in zip(corners, [*corners[1:], corners[0]], strict=True)
    )


def goal_text(goal: Goal) -> str:
    """What is wanted, without the object: `on table3`, `at (0.10, 0.00) on tray`."""
    match goal:
        case RestsOn(support=support):
            return f"on {support}"
        case RestsAt():
            turned = "" if goal.yaw is None else f" at {np.degrees(goal.yaw):.0f} degrees"
            return f"at ({goal.x:.2f}, {goal.y:.2f}) of {goal.support}{turned}"
        case IsHeld():
            return "in the hand"
        case Spelled():
            return f"{goal.word} on {goal.support}"
        case AnyOf():
            return " or ".join(map(goal_text, goal.goals))


def goal_body(goal: Goal) -> str | None:
    """The object that a goal is about; None where it is about several."""
    match goal:
        case Spelled():
            return None
        case AnyOf():
            return goal_body(goal.goals[0])
        case _:
            return goal.body
