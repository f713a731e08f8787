"""All that is drawn of a trace, as coloured triangles that hang on nodes.

A **node** is what moves as one: a fixed thing, an object, a link of the robot. The replay page, the
software renderer and the GLB export draw these parts and no others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from runtime.show.colours import TABLE, WALL, Colour, of_object
from runtime.show.forms import Ints, Triangles, rounded_box
from runtime.show.looks import looks_of
from runtime.show.marks import goal_marks
from runtime.show.meshes import of_solid
from runtime.trace.model import Trace
from runtime.world.body import Body
from runtime.world.poses import Floats, apply
from runtime.world.solids import Box
from runtime.world.world import Fixed

SLAB = 0.035
"""Thickness of a table's top, where the table is one box down to the floor."""

EDGE = 0.006
"""Radius by which edges of furniture are rounded."""


@dataclass(frozen=True)
class Node:
    """What moves as one: `kind` is `"fixed"`, `"object"`, `"link"`, or `"world"`, which stays."""

    kind: str
    name: str


@dataclass(frozen=True, eq=False)
class Part:
    """Triangles in the frame of a node: vertices (n, 3), faces (m, 3), counter-clockwise from
    outside. `layer`: `"looks"`, `"goals"` for marks of where things are to go, `"solids"` for
    what the planner keeps clear of."""

    node: Node
    vertices: Floats
    faces: Ints
    colour: Colour
    layer: str = "looks"


def parts_of(trace: Trace) -> Iterator[Part]:
    """The parts of a trace."""
    furniture = {support.owner for support in trace.world.supports}
    for fixed in trace.world.fixed:
        yield from _fixed(fixed, fixed.name in furniture)
    for thing in trace.world.movables:
        yield Part(Node("object", thing.name), *_body(thing.body, 0.004), of_object(thing))
    for link, (vertices, faces), colour in looks_of(trace.robot):
        yield Part(Node("link", link), vertices, faces, colour)
    yield from _solids(trace)
    objects = {thing.name for thing in trace.world.movables}
    for owner, (vertices, faces), colour in goal_marks(trace.world):
        node = Node("object", owner) if owner in objects else Node("world", "")
        yield Part(node, vertices, faces, colour, "goals")


def _fixed(thing: Fixed, furniture: bool) -> Iterator[Part]:
    node, parts = Node("fixed", thing.name), thing.body.parts
    only = parts[0].solid if len(parts) == 1 else None
    if furniture and isinstance(only, Box) and only.size[2] > 4 * SLAB:
        # The planner keeps clear of all of it, down to the floor: drawn as a block below a top.
        a, b, c = only.size
        low, high = np.array([0, 0, -SLAB / 2]), np.array([0, 0, (c - SLAB) / 2])
        below = rounded_box((a - 0.05, b - 0.05, c - SLAB), EDGE)
        above = rounded_box((a, b, SLAB), EDGE)
        for (vertices, faces), up, shade in ((below, low, 0.90), (above, high, 1.0)):
            red, green, blue = TABLE
            colour = (shade * red, shade * green, shade * blue)
            yield Part(node, apply(parts[0].pose, vertices + up), faces, colour)
        return
    yield Part(node, *_body(thing.body, EDGE), TABLE if furniture else WALL)


def _body(body: Body, radius: float) -> Triangles:
    """A body's mesh, or all its solids, in its frame."""
    if body.mesh is not None:
        return body.mesh.vertices, np.asarray(body.mesh.faces, dtype=np.int64)
    vertices, faces, count = [], [], 0
    for part in body.parts:
        points, corners = of_solid(part.solid, radius if len(body.parts) == 1 else 0.002)
        vertices.append(apply(part.pose, points))
        faces.append(corners + count)
        count += len(points)
    return np.concatenate(vertices), np.concatenate(faces)


def _solids(trace: Trace) -> Iterator[Part]:
    """The robot as the planner sees it."""
    for link, shapes in trace.robot.urdf.shapes.items():
        for shape in shapes:
            vertices, faces = of_solid(shape.solid, 0.0)
            yield Part(
                Node("link", link), apply(shape.pose, vertices), faces, (0.9, 0.3, 0.25), "solids"
            )
