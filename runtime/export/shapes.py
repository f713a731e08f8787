"""Solids as the messages and files of others have them."""

from __future__ import annotations

from typing import Any

from runtime.robot.model import Floats
from runtime.show.meshes import triangles
from runtime.trace.write_world import rounded
from runtime.world.quaternions import pose_of
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere

BOX, SPHERE, CYLINDER = 1, 2, 3
"""Types of `shape_msgs/msg/SolidPrimitive`."""


def primitives(solid: Solid) -> list[tuple[int, list[float], float]]:
    """A solid as primitives: type, dimensions, height of its middle along z of the solid's frame.
    A hull has none: it is a mesh. A capsule is a cylinder and two spheres."""
    match solid:
        case Box(size):
            return [(BOX, list(size), 0.0)]
        case Sphere(radius):
            return [(SPHERE, [radius], 0.0)]
        case Cylinder(radius, height):
            return [(CYLINDER, [height, radius], 0.0)]
        case Capsule(radius, height):
            ends = [(SPHERE, [radius], side * height / 2) for side in (-1, 1)]
            return [(CYLINDER, [height, radius], 0.0), *ends]
        case Hull():
            return []


def pose_dict(pose: Floats) -> dict[str, Any]:
    """`geometry_msgs/msg/Pose` of x, y, z and a quaternion x, y, z, w."""
    x, y, z, *turn = rounded(pose)
    return {
        "position": {"x": x, "y": y, "z": z},
        "orientation": dict(zip("xyzw", turn, strict=True)),
    }


def lifted(pose: Floats, height: float) -> Floats:
    """A pose (3, 4) moved along its own z, as x, y, z and a quaternion."""
    moved = pose.copy()
    moved[:3, 3] += height * pose[:3, 2]
    return pose_of(moved)


def mesh_dict(solid: Solid) -> dict[str, Any]:
    """`shape_msgs/msg/Mesh` of a solid."""
    vertices, faces = triangles(solid)
    return {
        "triangles": [{"vertex_indices": face} for face in faces.tolist()],
        "vertices": [dict(zip("xyz", point, strict=True)) for point in rounded(vertices)],
    }
