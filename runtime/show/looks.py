"""What a robot looks like: shapes of ours, the visual shapes of its URDF, or what it collides
with, in this order."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from runtime.robot.file import BUILT_IN, read_robot_file
from runtime.robot.meshes import read_mesh
from runtime.robot.shapes import Visual
from runtime.robot.urdf import Joint
from runtime.show.colours import Colour, of_links
from runtime.show.decimate import decimated
from runtime.show.forms import Triangles, rounded_box
from runtime.show.looks_file import read_looks
from runtime.show.meshes import of_solid
from runtime.trace.model import TraceRobot
from runtime.world.poses import apply
from sketchlang.errors import InputError

BUDGET = 40_000
"""Triangles of a robot's meshes; more of them are made fewer."""

GREY: Colour = (0.48, 0.51, 0.55)

Look = tuple[str, Triangles, Colour]
"""A link, triangles in its frame, a colour."""


def looks_of(robot: TraceRobot) -> list[Look]:
    """What is seen of a robot."""
    found = _ours(robot) or _seen(robot)
    bare = robot.urdf.shapes.keys() - {link for link, _, _ in found}
    return found + [look for look in _collided(robot) if look[0] in bare]


def is_built_in(robot: TraceRobot) -> bool:
    """Whether this is a robot that comes with us, as it is, and has looks of ours."""
    if robot.name not in {path.stem for path in BUILT_IN.glob("*/looks/*.toml")}:
        return False
    return read_robot_file(BUILT_IN / robot.name / f"{robot.name}.toml").digest == robot.digest


def _ours(robot: TraceRobot) -> list[Look]:
    """Shapes that come with a built-in robot."""
    if not is_built_in(robot):
        return []
    return read_looks(BUILT_IN / robot.name / "looks" / f"{robot.name}.toml")


def _seen(robot: TraceRobot) -> list[Look]:
    """The `<visual>` elements of the URDF, or what a trace file keeps of them."""
    if robot.looks:
        return list(robot.looks)
    colours = of_links(robot)
    found: list[Look] = []
    for link, visuals in robot.urdf.visuals.items():
        for visual in visuals:
            colour = visual.colour or colours[link]
            found += [(link, triangles, colour) for triangles in _triangles(visual)]
    total = sum(len(faces) for _, (_, faces), _ in found)
    share = min(1.0, BUDGET / max(total, 1))
    return [(link, decimated(*triangles, share), colour) for link, triangles, colour in found]


def _triangles(visual: Visual) -> Iterator[Triangles]:
    if visual.solid is not None:
        vertices, faces = of_solid(visual.solid, 0.008)
        yield apply(visual.pose, vertices), faces
    elif visual.mesh is not None:
        try:
            mesh = read_mesh(visual.mesh, visual.scale)
        except InputError:  # nothing depends on it
            return
        yield apply(visual.pose, mesh.vertices), np.asarray(mesh.faces, dtype=np.int64)


def _collided(robot: TraceRobot) -> Iterator[Look]:
    colours = of_links(robot)
    for link, shapes in robot.urdf.shapes.items():
        for shape in shapes:
            vertices, faces = of_solid(shape.solid, 0.012)
            yield link, (apply(shape.pose, vertices), faces), colours[link]
    for joint in robot.urdf.joints.values():
        column = _column(robot, joint)
        if column is not None:
            yield joint.child, column, GREY


def _column(robot: TraceRobot, joint: Joint) -> Triangles | None:
    """A column below what a lift raises, in its frame: collision shapes alone would leave it
    floating."""
    shapes = robot.urdf.shapes[joint.child]
    lifts = joint.type == "prismatic" and joint.name in robot.joints and joint.axis[2] > 0.99
    length = joint.upper - joint.lower
    if not lifts or not shapes or length <= 0:
        return None
    x, y, z = shapes[0].half.tolist()
    vertices, faces = rounded_box((x, y, length), 0.01)
    return vertices + shapes[0].pose[:, 3] - [0, 0, z + length / 2], faces
