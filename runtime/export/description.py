"""The robot of a trace as a URDF for those who show it, with the mesh files that it needs."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace
from xml.etree import ElementTree as Xml

from runtime.robot.propose.reduced import reduced
from runtime.robot.shapes import Shape
from runtime.robot.urdf import Urdf
from runtime.show.meshes import triangles
from runtime.world.solids import Capsule, Hull


def description(urdf: Urdf, folder: str) -> tuple[str, Mapping[str, str]]:
    """The text of the URDF, and the files, by their path in a folder, that it refers to there:
    `folder` is a URI that ends in no slash.

    Links that only have shapes to collide with are shown as these, and capsules, which URDFs
    do not have, as meshes.
    """
    plain = {link: tuple(map(_without_capsule, shapes)) for link, shapes in urdf.shapes.items()}
    text, files = reduced(replace(urdf, shapes=plain))
    root = Xml.fromstring(text)
    for link in root.iter("link"):
        if link.find("visual") is None:
            for collision in link.findall("collision"):
                seen = deepcopy(collision)
                seen.tag = "visual"
                link.append(seen)
    for mesh in root.iter("mesh"):
        mesh.set("filename", f"{folder}/{mesh.get('filename')}")
    Xml.indent(root)
    return Xml.tostring(root, encoding="unicode") + "\n", files


def _without_capsule(shape: Shape) -> Shape:
    if not isinstance(shape.solid, Capsule):
        return shape
    points = triangles(shape.solid)[0]
    return Shape(shape.name, shape.pose, Hull(tuple(map(tuple, points.tolist()))))
