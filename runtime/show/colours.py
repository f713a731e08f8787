"""One set of colours for pictures and models: red, green, blue, from 0 to 1."""

from __future__ import annotations

from runtime.trace.model import TraceRobot
from runtime.world.world import Movable

Colour = tuple[float, float, float]

WALL: Colour = (0.60, 0.65, 0.70)
TABLE: Colour = (0.87, 0.78, 0.64)
FLOOR: Colour = (0.87, 0.90, 0.92)

OBJECTS: dict[str, Colour] = {
    "blue": (0.18, 0.44, 0.82),
    "green": (0.21, 0.63, 0.38),
    "red": (0.82, 0.27, 0.24),
    "yellow": (0.91, 0.74, 0.18),
}


def of_object(thing: Movable) -> Colour:
    """The colour of an object."""
    if thing.label is not None:
        return (0.95, 0.83, 0.61)
    return OBJECTS.get(thing.colour or "", (0.69, 0.49, 0.78))


def of_links(robot: TraceRobot) -> dict[str, Colour]:
    """The colour of each link: base dark, lift and arm in turns, gripper darker."""
    moving = {*robot.joints, *robot.fingers}
    found: dict[str, Colour] = {}

    def depth(link: str) -> int:
        joint = robot.urdf.joints.get(link)
        return 0 if joint is None else depth(joint.parent) + (joint.name in moving)

    for link in robot.urdf.shapes:
        level = depth(link)
        found[link] = (0.96, 0.96, 0.96) if level % 2 else (0.89, 0.53, 0.24)
        if level == 0:
            found[link] = (0.35, 0.39, 0.44)
        if link in robot.gripper_links:
            found[link] = (0.23, 0.26, 0.30)
    return found
