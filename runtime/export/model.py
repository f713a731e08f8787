"""The scene and the robot at one time as GLB, the binary form of glTF."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from runtime.robot.model import Floats
from runtime.robot.urdf import Joint
from runtime.show.colours import TABLE, WALL, Colour, of_links, of_object
from runtime.trace.kinematics import Tree, links_at, object_at
from runtime.trace.model import Trace, TraceRobot
from runtime.world.poses import upright
from sketchlang.escape import visible

Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""glTF has y upwards, scenes have z."""


def boxes(trace: Trace, time: float) -> Iterator[tuple[str, Floats, Floats, Colour]]:
    """Name, size (3,), world pose (4, 4) of the middle and colour of every box at a time."""
    tables = {surface.name for surface in trace.scene.surfaces}
    for obstacle in trace.scene.obstacles:
        box, colour = obstacle.box, TABLE if obstacle.name in tables else WALL
        yield (
            obstacle.name,
            np.array(box.size),
            np.vstack([upright(*box.centre, box.yaw), [0, 0, 0, 1.0]]),
            colour,
        )
    links = links_at(trace, Tree(trace.robot), time)
    for index, thing in enumerate(trace.scene.objects):
        pose = object_at(trace, links, index, time).copy()
        pose[:3, 3] += pose[:3, 2] * thing.size[2] / 2
        yield thing.name, np.array(thing.size), pose, of_object(thing)
    colours = of_links(trace.robot)
    for link, shapes in trace.robot.urdf.boxes.items():
        for number, shape in enumerate(shapes):
            pose = links[link] @ np.vstack([shape.pose, [0, 0, 0, 1.0]])
            yield f"{link}_{number}", 2 * shape.half, pose, colours[link]

    for joint in trace.robot.urdf.joints.values():
        column = _column(trace.robot, joint)
        if column is not None:
            size, below = column
            yield f"{joint.child}_column", size, links[joint.child] @ below, WALL


def _column(robot: TraceRobot, joint: Joint) -> tuple[Floats, Floats] | None:
    """Size (3,) and pose (4, 4) in the link of a column below what a lift raises: collision
    boxes alone would leave it floating."""
    shapes = robot.urdf.boxes[joint.child]
    lifts = joint.type == "prismatic" and joint.name in robot.joints and joint.axis[2] > 0.99
    if not lifts or not shapes:
        return None
    length, below = joint.upper - joint.lower, np.eye(4)
    below[:3, 3] = shapes[0].pose[:, 3]
    below[2, 3] -= shapes[0].half[2] + length / 2
    return np.array([shapes[0].half[0], shapes[0].half[1], length]), below


def glb(trace: Trace, time: float) -> bytes:
    """The GLB file; nodes have the names of objects, tables, walls and links."""
    import trimesh

    scene = trimesh.Scene()
    for name, size, pose, colour in boxes(trace, time):
        shown, mesh = visible(name), trimesh.creation.box(extents=size)
        material = trimesh.visual.material.PBRMaterial(
            baseColorFactor=[*colour, 1.0], metallicFactor=0.0, roughnessFactor=0.8
        )
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(mesh, node_name=shown, geom_name=shown, transform=Y_UP @ pose)
    data: bytes = scene.export(file_type="glb")
    return data
