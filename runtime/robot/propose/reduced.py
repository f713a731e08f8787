"""A URDF written anew, with what it needs and no more: small hulls, coarse meshes to look at."""

from __future__ import annotations

import math
from xml.etree import ElementTree as Xml

import numpy as np

from runtime.robot.shapes import Shape, Visual, hull_as_obj, triangles
from runtime.robot.urdf import MOVING, Joint, Urdf
from runtime.world.body import Mesh
from runtime.world.poses import Pose, identity
from runtime.world.solids import Box, Capsule, Cylinder, Floats, Hull, Solid, Sphere

MAX_FACES = 1500
"""Triangles of a mesh to look at."""


def reduced(urdf: Urdf) -> tuple[str, dict[str, str]]:
    """The text of the URDF, and the mesh files that it names, by path from its folder."""
    root = Xml.Element("robot", name=urdf.name)
    files: dict[str, str] = {}
    for name, shapes in urdf.shapes.items():
        link = Xml.SubElement(root, "link", name=name)
        for number, visual in enumerate(urdf.visuals.get(name, ())):
            _visual(link, visual, f"meshes/{_file_name(name)}_visual_{number}.obj", files)
        for number, shape in enumerate(shapes):
            _collision(link, shape, f"meshes/{_file_name(name)}_{number}.obj", files)
    for joint in urdf.joints.values():
        _joint(root, joint)
    Xml.indent(root)
    return Xml.tostring(root, encoding="unicode") + "\n", files


def _file_name(link: str) -> str:
    return "".join(c if c.isalnum() or c in "-_" else "_" for c in link)


def _collision(link: Xml.Element, shape: Shape, path: str, files: dict[str, str]) -> None:
    element = Xml.SubElement(link, "collision", name=shape.name)
    if isinstance(shape.solid, Hull):
        files[path] = hull_as_obj(shape)
        _origin(element, identity())
        Xml.SubElement(Xml.SubElement(element, "geometry"), "mesh", filename=path)
    else:
        _origin(element, shape.pose)
        _primitive(Xml.SubElement(element, "geometry"), shape.solid)


def _visual(link: Xml.Element, visual: Visual, path: str, files: dict[str, str]) -> None:
    mesh = triangles(visual)
    if mesh is None and (visual.solid is None or isinstance(visual.solid, Hull)):
        return
    element = Xml.SubElement(link, "visual")
    if mesh is not None:
        files[path] = _obj(coarser(mesh, MAX_FACES))
        _origin(element, identity())
        Xml.SubElement(Xml.SubElement(element, "geometry"), "mesh", filename=path)
    elif visual.solid is not None:
        _origin(element, visual.pose)
        _primitive(Xml.SubElement(element, "geometry"), visual.solid)
    if visual.colour is not None:
        material = Xml.SubElement(element, "material", name="")
        rgba = " ".join(f"{value:.3g}" for value in (*visual.colour, 1.0))
        Xml.SubElement(material, "color", rgba=rgba)


def _primitive(geometry: Xml.Element, solid: Solid) -> None:
    match solid:
        case Box():
            Xml.SubElement(geometry, "box", size=_numbers(np.array(solid.size)))
        case Sphere():
            Xml.SubElement(geometry, "sphere", radius=f"{solid.radius:.9g}")
        case Cylinder() | Capsule():
            tag = "cylinder" if isinstance(solid, Cylinder) else "capsule"
            sizes = {"radius": f"{solid.radius:.9g}", "length": f"{solid.height:.9g}"}
            Xml.SubElement(geometry, tag, sizes)


def _joint(root: Xml.Element, joint: Joint) -> None:
    element = Xml.SubElement(root, "joint", name=joint.name, type=joint.type)
    Xml.SubElement(element, "parent", link=joint.parent)
    Xml.SubElement(element, "child", link=joint.child)
    _origin(element, joint.origin)
    if joint.type not in MOVING:
        return
    Xml.SubElement(element, "axis", xyz=_numbers(joint.axis))
    limits: dict[str, str] = {}
    if "limits" not in joint.absent and joint.type != "continuous":
        limits |= {"lower": f"{joint.lower:.9g}", "upper": f"{joint.upper:.9g}"}
    if "velocity" not in joint.absent:
        limits["velocity"] = f"{joint.velocity:.9g}"
    Xml.SubElement(element, "limit", {**limits, "effort": "0"})
    if joint.mimic is not None:
        follows = {
            "joint": joint.mimic.joint,
            "multiplier": f"{joint.mimic.multiplier:.9g}",
            "offset": f"{joint.mimic.offset:.9g}",
        }
        Xml.SubElement(element, "mimic", follows)


def _origin(parent: Xml.Element, pose: Pose) -> None:
    xyz, rpy = _numbers(pose[:, 3]), _numbers(rpy_of(pose[:, :3]))
    Xml.SubElement(parent, "origin", xyz=xyz, rpy=rpy)


def _numbers(values: Floats) -> str:
    return " ".join(f"{value:.9g}" for value in (values + 0.0).tolist())


def rpy_of(rotation: Floats) -> Floats:
    """Fixed-axis roll, pitch, yaw of a rotation (3, 3)."""
    sine = min(1.0, max(-1.0, -float(rotation[2, 0])))
    if abs(sine) > 1 - 1e-9:  # roll and yaw turn about the same axis
        yaw = math.atan2(-rotation[0, 1], rotation[1, 1])
        return np.array([0.0, math.asin(sine), yaw])
    roll = math.atan2(rotation[2, 1], rotation[2, 2])
    return np.array([roll, math.asin(sine), math.atan2(rotation[1, 0], rotation[0, 0])])


def coarser(mesh: Mesh, faces: int) -> Mesh:
    """A mesh of at most so many triangles: vertices that share a cell of a grid become one."""
    vertices, triangles_ = mesh.vertices, np.asarray(mesh.faces)
    size = float(np.ptp(vertices, axis=0).max()) / 400 or 1e-6
    while len(triangles_) > faces:
        cells = np.floor(mesh.vertices / size).astype(np.int64)
        _, index = np.unique(cells, axis=0, return_inverse=True)
        index = index.reshape(-1)
        count = int(index.max()) + 1
        total = np.zeros((count, 3))
        np.add.at(total, index, mesh.vertices)
        vertices = total / np.bincount(index, minlength=count)[:, None]
        triangles_ = index[np.asarray(mesh.faces)]
        a, b, c = triangles_.T
        triangles_ = triangles_[(a != b) & (b != c) & (c != a)]
        triangles_ = np.unique(triangles_, axis=0) if len(triangles_) else triangles_
        size *= 1.3
    return Mesh(vertices, triangles_)


def _obj(mesh: Mesh) -> str:
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in np.asarray(mesh.faces).tolist()]
    return "\n".join(lines) + "\n"
