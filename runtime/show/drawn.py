"""All that is to be seen of a trace at a time, for whatever draws it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from runtime.robot.urdf import Joint
from runtime.show.colours import TABLE, WALL, Colour, of_links, of_object
from runtime.show.meshes import Ints, of_body, triangles
from runtime.trace.kinematics import Tree, guided_at, links_at, object_at
from runtime.trace.model import Trace, TraceRobot
from runtime.world.poses import Floats
from runtime.world.solids import Box, Solid


@dataclass(frozen=True, eq=False)
class Drawn:
    """Triangles: vertices (n, 3) and faces (m, 3) in a frame, its world pose (4, 4), a colour."""

    name: str
    vertices: Floats
    faces: Ints
    pose: Floats
    colour: Colour


def drawn(trace: Trace, time: float) -> Iterator[Drawn]:
    """Fixed things, objects and the links of the robot at a time."""
    furniture = {support.owner for support in trace.world.supports}
    for fixed in trace.world.fixed:
        colour = TABLE if fixed.name in furniture else WALL
        pose = guided_at(trace, fixed.name, time)
        yield Drawn(fixed.name, *of_body(fixed.body), pose, colour)
    links = links_at(trace, Tree(trace.robot), time)
    for index, thing in enumerate(trace.world.movables):
        pose = object_at(trace, links, index, time)
        yield Drawn(thing.name, *of_body(thing.body), pose, of_object(thing))
    colours = of_links(trace.robot)
    for link, shapes in trace.robot.urdf.shapes.items():
        for number, shape in enumerate(shapes):
            pose = links[link] @ np.vstack([shape.pose, [0, 0, 0, 1.0]])
            name = f"{link}_{number}"
            yield Drawn(name, *triangles(shape.solid), pose, colours[link])
    for joint in trace.robot.urdf.joints.values():
        column = _column(trace.robot, joint)
        if column is not None:
            solid, below = column
            pose = links[joint.child] @ below
            yield Drawn(f"{joint.child}_column", *triangles(solid), pose, WALL)


def _column(robot: TraceRobot, joint: Joint) -> tuple[Solid, Floats] | None:
    """A column and its pose (4, 4) in the link below what a lift raises: collision shapes
    alone would leave it floating."""
    shapes = robot.urdf.shapes[joint.child]
    lifts = joint.type == "prismatic" and joint.name in robot.joints and joint.axis[2] > 0.99
    if not lifts or not shapes:
        return None
    length, below = joint.upper - joint.lower, np.eye(4)
    if length <= 0:
        return None
    below[:3, 3] = shapes[0].pose[:, 3]
    x, y, z = shapes[0].half.tolist()
    below[2, 3] -= z + length / 2
    return Box((x, y, length)), below
