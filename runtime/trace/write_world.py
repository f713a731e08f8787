"""Worlds, bodies and solids as plain data; `docs/trace-format.md` is the reference."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from runtime.world.body import Body
from runtime.world.goals import AnyOf, Goal, IsHeld, RestsAt, RestsOn, Spelled
from runtime.world.poses import Floats
from runtime.world.quaternions import pose_of
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere
from runtime.world.world import Fixed, World


def rounded(array: Floats) -> list[Any]:
    """Plain lists, to six places: micrometres and microradians, and no negative zeros."""
    plain: list[Any] = (np.round(np.asarray(array, dtype=np.float64), 6) + 0.0).tolist()
    return plain


def world_to_json(world: World) -> dict[str, Any]:
    """A world as plain data."""
    return {
        "name": world.name,
        "digest": world.digest,
        "robot_start": rounded(np.array(world.robot_start)),
        "fixed": [_fixed(thing) for thing in world.fixed],
        "objects": [
            {
                "name": thing.name,
                "pose": rounded(pose_of(thing.pose)),
                "colour": thing.colour,
                "label": thing.label,
                **_body(thing.body),
            }
            for thing in world.movables
        ],
        "supports": [
            {
                "name": support.name,
                "owner": support.owner,
                "pose": rounded(pose_of(support.pose)),
                "half": rounded(np.array(support.half)),
                "clearance": None if math.isinf(support.clearance) else round(support.clearance, 6),
            }
            for support in world.supports
        ],
        "goals": [_goal(goal) for goal in world.goals],
    }


def solid_to_json(solid: Solid) -> dict[str, Any]:
    """A solid as plain data; of a hull also the faces, for those who draw it."""
    match solid:
        case Box():
            return {"type": "box", "size": rounded(np.array(solid.size))}
        case Cylinder():
            return {
                "type": "cylinder",
                "radius": round(solid.radius, 6),
                "height": round(solid.height, 6),
            }
        case Sphere():
            return {"type": "sphere", "radius": round(solid.radius, 6)}
        case Capsule():
            return {
                "type": "capsule",
                "radius": round(solid.radius, 6),
                "height": round(solid.height, 6),
            }
        case Hull():
            points = np.array(rounded(solid.points))
            return {"type": "hull", "points": points.tolist(), "faces": hull_faces(points)}


def hull_faces(points: Floats) -> list[list[int]]:
    """Triangles of the hull of points, counter-clockwise from outside."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    faces = []
    for corners, normal in zip(hull.simplices.tolist(), hull.equations[:, :3], strict=True):
        a, b, c = corners
        if np.cross(points[b] - points[a], points[c] - points[a]) @ normal < 0:
            b, c = c, b
        faces.append([a, b, c])
    return faces


def _fixed(thing: Fixed) -> dict[str, Any]:
    data = {"name": thing.name, "pose": rounded(pose_of(thing.pose)), **_body(thing.body)}
    if thing.guide is not None:
        data["guide"] = {
            "type": thing.guide.type,
            "axis": rounded(np.array(thing.guide.axis)),
            "origin": rounded(np.array(thing.guide.origin)),
            "limits": rounded(np.array([thing.guide.lower, thing.guide.upper])),
        }
    return data


def _body(body: Body) -> dict[str, Any]:
    data: dict[str, Any] = {
        "mass": round(body.mass, 6),
        "centre": rounded(np.array(body.centre)),
        "solids": [
            {"pose": rounded(pose_of(part.pose)), **solid_to_json(part.solid)}
            for part in body.parts
        ],
    }
    if body.mesh is not None:
        faces = np.asarray(body.mesh.faces, dtype=np.int64).tolist()
        data["mesh"] = {"vertices": rounded(body.mesh.vertices), "faces": faces}
    return data


def _goal(goal: Goal) -> dict[str, Any]:
    match goal:
        case RestsOn(body, support):
            return {"kind": "on", "body": body, "support": support}
        case RestsAt():
            data = {
                "kind": "at",
                "body": goal.body,
                "support": goal.support,
                "at": rounded(np.array([goal.x, goal.y])),
                "tolerance": round(goal.tolerance, 6),
            }
            if goal.yaw is not None:
                data["yaw"] = round(goal.yaw, 6)
                data["yaw_tolerance"] = round(goal.yaw_tolerance, 6)
                data["symmetry"] = goal.symmetry
            return data
        case IsHeld(body):
            return {"kind": "held", "body": body}
        case Spelled():
            return {
                "kind": "word",
                "word": goal.word,
                "support": goal.support,
                "pitch": round(goal.pitch, 6),
                "tolerance": round(goal.tolerance, 6),
            }
        case AnyOf(goals):
            return {"kind": "any", "goals": [_goal(each) for each in goals]}
