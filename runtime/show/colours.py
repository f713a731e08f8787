"""One set of colours for pages, pictures and models: red, green, blue, from 0 to 1 (sRGB)."""

from __future__ import annotations

import re

from runtime.trace.model import TraceRobot
from runtime.world.world import Movable

Colour = tuple[float, float, float]

WALL: Colour = (0.76, 0.79, 0.83)
TABLE: Colour = (0.90, 0.82, 0.69)
FLOOR: Colour = (0.87, 0.90, 0.92)
LETTERED: Colour = (0.96, 0.87, 0.70)
UNNAMED: Colour = (0.66, 0.63, 0.74)

OBJECTS: dict[str, Colour] = {
    "black": (0.18, 0.19, 0.21),
    "blue": (0.18, 0.44, 0.84),
    "brown": (0.55, 0.37, 0.24),
    "cyan": (0.20, 0.68, 0.76),
    "gray": (0.55, 0.58, 0.62),
    "green": (0.20, 0.63, 0.38),
    "grey": (0.55, 0.58, 0.62),
    "orange": (0.93, 0.53, 0.18),
    "pink": (0.91, 0.50, 0.67),
    "purple": (0.55, 0.36, 0.77),
    "red": (0.84, 0.27, 0.23),
    "silver": (0.75, 0.77, 0.80),
    "white": (0.95, 0.95, 0.94),
    "yellow": (0.93, 0.75, 0.17),
}
"""Colours of objects by the names that scenes give them; they may also write `#rrggbb`."""


def of_object(thing: Movable) -> Colour:
    """The colour of an object."""
    name = (thing.colour or "").lower()
    if re.fullmatch(r"#[0-9a-f]{6}", name):
        red, green, blue = (int(name[i : i + 2], 16) / 255 for i in (1, 3, 5))
        return red, green, blue
    return OBJECTS.get(name, LETTERED if thing.label is not None else UNNAMED)


def of_links(robot: TraceRobot) -> dict[str, Colour]:
    """A colour for each link that has none of its own: base dark, lift and arm in turns, gripper
    darker."""
    moving = {*robot.joints, *robot.fingers}
    found: dict[str, Colour] = {}

    def depth(link: str) -> int:
        joint = robot.urdf.joints.get(link)
        return 0 if joint is None else depth(joint.parent) + (joint.name in moving)

    for link in robot.urdf.shapes:
        level = depth(link)
        found[link] = (0.96, 0.965, 0.97) if level % 2 else (0.70, 0.74, 0.78)
        if level == 0:
            found[link] = (0.33, 0.37, 0.42)
        if link in robot.gripper_links:
            found[link] = (0.22, 0.24, 0.28)
    return found
