"""What stands around a robot as markers (`visualization_msgs/msg/Marker`), as plain data."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from runtime.export.shapes import BOX, CYLINDER, lifted, pose_dict, primitives
from runtime.show.colours import TABLE, WALL, Colour, of_object
from runtime.show.meshes import triangles
from runtime.trace.model import Trace
from runtime.world.body import Body
from runtime.world.goals import AnyOf, Goal, IsHeld
from runtime.world.quaternions import pose_of
from runtime.world.world import Support

CUBE, SPHERE, CYLINDER_MARKER, TEXT, TRIANGLES = 1, 2, 3, 9, 11
"""Types of markers."""

GOAL: Colour = (0.25, 0.75, 0.35)
LABEL_HEIGHT = 0.06


def markers(trace: Trace, frames: dict[str, str], frame: str) -> list[dict[str, Any]]:
    """Markers of everything but the robot, each in the frame of its thing (`frames`, by name),
    or in the scene's: they move as the frames do."""
    found: list[dict[str, Any]] = []
    furniture = {support.owner for support in trace.world.supports}
    for fixed in trace.world.fixed:
        colour = TABLE if fixed.name in furniture else WALL
        own = frames.get(fixed.name)
        pose = np.eye(4) if own else np.vstack([fixed.pose, [0, 0, 0, 1.0]])
        found += _body(fixed.name, fixed.body, pose, own or frame, colour)
    for thing in trace.world.movables:
        own, at = frames[thing.name], np.eye(4)
        found += _body(thing.name, thing.body, at, own, of_object(thing))
        if thing.label is not None:
            at[2, 3] = thing.body.bounds[1][2] + LABEL_HEIGHT
            found.append(
                {
                    **_marker(thing.name, TEXT, pose_dict(pose_of(at)), own, (0.1, 0.1, 0.1)),
                    "scale": {"x": 0.0, "y": 0.0, "z": LABEL_HEIGHT},
                    "text": thing.label,
                }
            )
    wanted = {name for goal in trace.world.goals for name in _supports(goal)}
    found += [
        _region(support, frames.get(support.owner, frame))
        for support in trace.world.supports
        if support.name in wanted
    ]
    for number, marker in enumerate(found):
        marker["id"] = number
    return found


def _supports(goal: Goal) -> Iterator[str]:
    if isinstance(goal, AnyOf):
        for each in goal.goals:
            yield from _supports(each)
    elif not isinstance(goal, IsHeld):
        yield goal.support


def _region(support: Support, frame: str) -> dict[str, Any]:
    pose = pose_dict(lifted(support.pose, 0.002))
    x, y = support.half
    return {
        **_marker(support.name, CUBE, pose, frame, GOAL, 0.35),
        "scale": {"x": 2 * x, "y": 2 * y, "z": 0.002},
    }


def _body(name: str, body: Body, pose: Any, frame: str, colour: Colour) -> Iterator[dict[str, Any]]:
    for part in body.parts:
        here = pose @ np.vstack([part.pose, [0, 0, 0, 1.0]])
        simple = primitives(part.solid)
        for kind, size, height in simple:
            at = pose_dict(lifted(here, height))
            if kind == BOX:
                marker, scale = CUBE, size
            elif kind == CYLINDER:
                marker, scale = CYLINDER_MARKER, [2 * size[1], 2 * size[1], size[0]]
            else:
                marker, scale = SPHERE, [2 * size[0]] * 3
            yield {
                **_marker(name, marker, at, frame, colour),
                "scale": dict(zip("xyz", map(float, scale), strict=True)),
            }
        if not simple:
            vertices, faces = triangles(part.solid)
            points = vertices[faces].reshape(-1, 3).tolist()
            yield {
                **_marker(name, TRIANGLES, pose_dict(pose_of(here)), frame, colour),
                "scale": {"x": 1.0, "y": 1.0, "z": 1.0},
                "points": [dict(zip("xyz", point, strict=True)) for point in points],
            }


def _marker(
    name: str, kind: int, pose: dict[str, Any], frame: str, colour: Colour, alpha: float = 1.0
) -> dict[str, Any]:
    return {
        "header": {"frame_id": frame},
        "ns": name,
        "type": kind,
        "pose": pose,
        "color": {**dict(zip("rgb", colour, strict=True)), "a": alpha},
        "frame_locked": True,
    }
