"""The world of a trace file."""

from __future__ import annotations

import math

import numpy as np

from runtime.plan.node import Node, name_of, one_pose_of
from runtime.world.body import Body, Mesh, Part
from runtime.world.goals import AnyOf, Goal, IsHeld, RestsAt, RestsOn, Spelled
from runtime.world.poses import Pose
from runtime.world.quaternions import matrix
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from runtime.world.world import FLOOR, Fixed, Guide, Movable, Support, World


def world_of(node: Node) -> World:
    """The world that a node of a trace file describes."""
    fixed = tuple(_fixed(entry) for entry in node["fixed"].each())
    movables = tuple(_movable(entry) for entry in node["objects"].each())
    names = [thing.name for thing in movables]
    for entry in node["objects"].each():
        if names.count(entry["name"].text()) > 1:
            raise entry["name"].fail("two objects have this name")
    owners = [*names, *(thing.name for thing in fixed), FLOOR]
    supports = tuple(_support(entry, owners) for entry in node["supports"].each())
    regions = [support.name for support in supports]
    start = node["robot_start"].numbers((3,)).tolist()
    return World(
        name=node["name"].text(),
        digest=node["digest"].text(),
        robot_start=(start[0], start[1], start[2]),
        fixed=fixed,
        movables=movables,
        supports=supports,
        goals=tuple(_goal(entry, names, regions) for entry in node["goals"].each()),
    )


def solid_of(node: Node) -> Solid:
    """The solid that a node describes."""
    kind = node["type"].choice("box", "cylinder", "sphere", "capsule", "hull")
    if kind == "box":
        size = node["size"].numbers((3,))
        if size.min() <= 0:
            raise node["size"].fail("sizes must be positive")
        a, b, c = size.tolist()
        return Box((a, b, c))
    if kind == "hull":
        points = node["points"].numbers((None, 3))
        if len(points) < 4 or np.linalg.matrix_rank(points - points[0], tol=1e-6) < 3:
            raise node["points"].fail("these points have no hull with a volume")
        return Hull(tuple((x, y, z) for x, y, z in points.tolist()))
    radius = _positive(node["radius"])
    if kind == "sphere":
        return Sphere(radius)
    return (Cylinder if kind == "cylinder" else Capsule)(radius, _positive(node["height"]))


def _positive(node: Node) -> float:
    value = node.number()
    if value <= 0:
        raise node.fail("sizes must be positive")
    return value


def _pose(node: Node) -> Pose:
    return matrix(one_pose_of(node))[:3]


def _fixed(node: Node) -> Fixed:
    found = node.get("guide")
    guide = None
    if found is not None:
        axis, origin = found["axis"].numbers((3,)).tolist(), found["origin"].numbers((3,)).tolist()
        lower, upper = found["limits"].numbers((2,)).tolist()
        kind = found["type"].choice("revolute", "prismatic")
        guide = Guide(
            kind,
            (axis[0], axis[1], axis[2]),
            (origin[0], origin[1], origin[2]),
            lower,
            upper,
        )
    return Fixed(node["name"].text(), _body(node), _pose(node["pose"]), guide)


def _movable(node: Node) -> Movable:
    colour, label = node["colour"].optional(), node["label"].optional()
    return Movable(
        node["name"].text(),
        _body(node),
        _pose(node["pose"]),
        None if colour is None else colour.text(),
        None if label is None else label.text(),
    )


def _body(node: Node) -> Body:
    solids = node["solids"].each()
    if not solids:
        raise node["solids"].fail("a body has at least one solid")
    x, y, z = node["centre"].numbers((3,)).tolist()
    mesh, found = None, node.get("mesh")
    if found is not None:
        vertices = found["vertices"].numbers((None, 3))
        faces = found["faces"].numbers((None, 3))
        if faces.min() < 0 or faces.max() >= len(vertices) or np.any(faces % 1):
            raise found["faces"].fail("a face has a corner that is no vertex")
        mesh = Mesh(vertices, faces.astype(np.int64))
    parts = tuple(Part(solid_of(entry), _pose(entry["pose"])) for entry in solids)
    return Body(parts, node["mass"].number(), (x, y, z), mesh)


def _support(node: Node, owners: list[str]) -> Support:
    half, clearance = node["half"].numbers((2,)).tolist(), node["clearance"].optional()
    if node["owner"].text() not in owners:
        raise node["owner"].fail(f"there is nothing called {node['owner'].text()!r}")
    return Support(
        node["name"].text(),
        node["owner"].text(),
        _pose(node["pose"]),
        (half[0], half[1]),
        math.inf if clearance is None else clearance.number(),
    )


def _goal(node: Node, names: list[str], regions: list[str]) -> Goal:
    kind = node["kind"].choice("on", "at", "held", "word", "any")
    if kind == "any":
        return AnyOf(tuple(_goal(entry, names, regions) for entry in node["goals"].each()))
    if kind == "held":
        return IsHeld(name_of(node["body"], names))
    support = node["support"].text()
    if support not in regions:
        raise node["support"].fail(f"there is no support {support!r}")
    if kind == "word":
        if not node["word"].text():
            raise node["word"].fail("a word has letters")
        numbers = node["pitch"].number(), node["tolerance"].number()
        return Spelled(node["word"].text(), support, *numbers)
    body = name_of(node["body"], names)
    if kind == "on":
        return RestsOn(body, support)
    x, y = node["at"].numbers((2,)).tolist()
    if node.get("yaw") is None:
        return RestsAt(body, support, x, y, node["tolerance"].number())
    symmetry = node["symmetry"].whole()
    turn = node["yaw"].number(), node["yaw_tolerance"].number(), symmetry
    return RestsAt(body, support, x, y, node["tolerance"].number(), *turn)
