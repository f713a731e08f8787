"""Where things are to go: coloured frames on supports."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from runtime.show.colours import Colour, of_object
from runtime.show.forms import Triangles, strip
from runtime.world.goals import AnyOf, Goal, RestsAt, RestsOn, Spelled
from runtime.world.poses import Floats, apply
from runtime.world.solids import Box
from runtime.world.world import Movable, Support, World

WIDTH = 0.010
"""Metres that a frame around a whole support is wide; those around a place are half as wide."""

LIFT = 0.0015
"""Metres above the support."""

FRAMES = 5
"""Frames, one within the other, on a support where things of several colours are to go."""

LARGEST = 4.0
"""Metres: half the side of supports without a frame, such as the floor."""

LETTERS: Colour = (0.80, 0.62, 0.22)

Mark = tuple[str, Triangles, Colour]
"""The owner of the support, triangles in its frame if it can be moved, else in the world, and a
colour."""


def goal_marks(world: World) -> Iterator[Mark]:
    """The marks of a world's goals."""
    supports = {support.name: support for support in world.supports}
    things = {thing.name: thing for thing in world.movables}
    colours: dict[str, list[Colour]] = {}
    for goal in _flat(world.goals):
        match goal:
            case RestsOn(body, name) if name in supports and body in things:
                _note(colours, name, of_object(things[body]))
            case Spelled() if goal.support in supports:
                _note(colours, goal.support, LETTERS)
            case RestsAt() if goal.support in supports and goal.body in things:
                yield _place(goal, supports[goal.support], things[goal.body])
    for name, found in colours.items():
        support = supports[name]
        if max(support.half) > LARGEST:
            continue
        for number, colour in enumerate(found[:FRAMES]):
            inset = 0.006 + 1.6 * WIDTH * number
            a, b = support.half[0] - inset, support.half[1] - inset
            if min(a, b) > 2 * WIDTH:
                corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b]])
                yield support.owner, _on(support, corners, WIDTH), colour


def _flat(goals: tuple[Goal, ...]) -> Iterator[Goal]:
    for goal in goals:
        if isinstance(goal, AnyOf):
            yield from _flat(goal.goals)
        else:
            yield goal


def _note(colours: dict[str, list[Colour]], support: str, colour: Colour) -> None:
    found = colours.setdefault(support, [])
    if colour not in found:
        found.append(colour)


def _place(goal: RestsAt, support: Support, thing: Movable) -> Mark:
    """The outline of a body around where it is to stand, as it stands at the start."""
    size = 0.004 + WIDTH / 2
    parts = thing.body.parts
    first = parts[0].solid
    if len(parts) == 1 and isinstance(first, Box):
        points = apply(parts[0].pose, _corners(first)) @ thing.pose[:, :3].T
        turn = math.atan2(thing.pose[1, 0], thing.pose[0, 0])
        across = points[:, :2] @ _turn(turn)
        a, b = ((across.max(axis=0) - across.min(axis=0)) / 2 + size).tolist()
        corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b]])
    else:
        reach = max(float(np.hypot(*part.solid.half[:2])) for part in parts) / math.sqrt(2) + size
        turns = np.linspace(0, 2 * math.pi, 32, endpoint=False)
        corners = reach * np.column_stack([np.cos(turns), np.sin(turns)])
    corners = corners @ _turn(goal.yaw or 0.0).T + [goal.x, goal.y]
    return support.owner, _on(support, corners, WIDTH / 2), of_object(thing)


def _corners(box: Box) -> Floats:
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    found: Floats = signs * np.array(box.half)
    return found


def _turn(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def _on(support: Support, corners: Floats, width: float) -> Triangles:
    vertices, faces = strip(corners, width)
    return apply(support.pose, vertices + np.array([0, 0, LIFT])), faces
