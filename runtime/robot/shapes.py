"""What links are made of: `<geometry>` of a URDF as solids to collide with and to look at."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from runtime.robot.hulls import MAX_CORNERS, enclosing_hulls
from runtime.robot.meshes import find_mesh, read_mesh
from runtime.world.body import Mesh
from runtime.world.poses import Pose, compose, identity, rotation_from_rpy
from runtime.world.solids import Box, Capsule, Cylinder, Floats, Hull, Solid, Sphere
from sketchlang.errors import InputError
from sketchlang.reading import read_bytes


@dataclass(frozen=True, eq=False)
class Shape:
    """A collision solid fixed to a link, and its pose (3, 4) in the link's frame."""

    name: str
    pose: Pose
    solid: Solid

    @cached_property
    def half(self) -> Floats:
        """Half extents (3,) of the box around the solid, along the axes of its pose."""
        return np.array(self.solid.half)


@dataclass(frozen=True, eq=False)
class Visual:
    """What is seen of a link: a solid, or a mesh file and the scale (3,) that makes it metres;
    red, green, blue from 0 to 1 where the file says so."""

    pose: Pose
    solid: Solid | None = None
    mesh: Path | None = None
    scale: Floats = field(default_factory=lambda: np.ones(3))
    colour: tuple[float, float, float] | None = None


def numbers(text: str | None, count: int, default: float = 0.0) -> list[float]:
    """The numbers of an attribute, the default for all of them where it is missing.

    Raises:
        ValueError: others than so many finite numbers.
    """
    if text is None:
        return [default] * count
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        macro = ", which xacro has not expanded" if "$" in text else ""
        raise ValueError(f"expected {count} numbers, found {text!r}{macro}")
    return values


def read_origin(element: ElementTree.Element) -> Pose:
    """The pose that the `<origin>` of an element says."""
    origin = element.find("origin")
    if origin is None:
        return identity()
    pose = np.empty((3, 4))
    pose[:, :3] = rotation_from_rpy(*numbers(origin.get("rpy"), 3))
    pose[:, 3] = numbers(origin.get("xyz"), 3)
    return pose


def read_shapes(link: str, element: ElementTree.Element, folder: Path) -> tuple[Shape, ...]:
    """The collision shapes of a `<link>`; meshes become hulls that enclose them.

    Raises:
        InputError: a shape cannot be understood; the link is named.
    """
    found: list[Shape] = []
    for collision in element.findall("collision"):
        try:
            pose = read_origin(collision)
            for solid, own in _solids(collision.find("geometry"), folder):
                number = len(found)
                name = collision.get("name") or (link if number == 0 else f"{link}_{number}")
                if any(name == shape.name for shape in found):
                    name = f"{name}_{number}"
                found.append(Shape(name, compose(pose, own), solid))
        except ValueError as error:
            raise InputError(f"collision shape of link {link!r}: {error}") from None
        except InputError as error:
            where = f"{error.place}: " if error.place else ""
            raise InputError(
                f"collision shape of link {link!r}: {where}{error.message}", hint=error.hint
            ) from None
    return tuple(found)


def _solids(geometry: ElementTree.Element | None, folder: Path) -> Iterator[tuple[Solid, Pose]]:
    """Solids and their poses in the frame of a `<geometry>`."""
    if geometry is None or not len(geometry):
        raise ValueError("has no geometry")
    kind = geometry[0]
    if kind.tag == "mesh":
        path, scale = _mesh_of(kind, folder)
        few = _few_points(path)
        if few is None:
            yield from enclosing_hulls(read_mesh(path, scale))
        else:
            yield _centred(few * scale)
    else:
        yield _primitive(kind), identity()


def _primitive(kind: ElementTree.Element) -> Solid:
    match kind.tag:
        case "box":
            x, y, z = _sizes(kind, "size", 3)
            return Box((x, y, z))
        case "sphere":
            return Sphere(*_sizes(kind, "radius", 1))
        case "cylinder" | "capsule":
            (radius,), (length,) = _sizes(kind, "radius", 1), _sizes(kind, "length", 1)
            return (Cylinder if kind.tag == "cylinder" else Capsule)(radius, length)
    raise InputError(
        f"{kind.tag!r} is no known shape", hint="known: box, cylinder, sphere, capsule, mesh"
    )


def _sizes(element: ElementTree.Element, key: str, count: int) -> list[float]:
    words = {1: "a positive number", 3: "three positive numbers"}[count]
    values = numbers(element.get(key), count)
    if min(values) <= 0:
        raise ValueError(f"needs a {key} of {words}, found {element.get(key)!r}")
    return values


def _mesh_of(element: ElementTree.Element, folder: Path) -> tuple[Path, Floats]:
    scale = np.array(numbers(element.get("scale"), 3, 1.0))
    if not scale.all():
        raise ValueError(f"needs a scale other than 0, found {element.get('scale')!r}")
    return find_mesh(element.get("filename", ""), folder), scale


def _few_points(path: Path) -> Floats | None:
    """The vertices of a small OBJ file, such as `write_hull` makes: a hull as they are. Any
    other file is left to those who read meshes."""
    if path.suffix.lower() != ".obj" or path.stat().st_size > 20_000:
        return None
    text = read_bytes(path).decode("utf-8", "replace")
    lines = [line.split() for line in text.splitlines()]
    if any(words and words[0] not in {"v", "f", "#", "o"} for words in lines):
        return None
    try:
        points = np.array([numbers(" ".join(w[1:]), 3) for w in lines if w and w[0] == "v"])
    except ValueError:
        return None
    flat = len(points) < 4 or np.linalg.matrix_rank(points - points[0], tol=1e-6) < 3
    return None if flat or len(points) > MAX_CORNERS else points


def _centred(points: Floats) -> tuple[Hull, Pose]:
    pose = identity()
    pose[:, 3] = (points.min(axis=0) + points.max(axis=0)) / 2
    corners = (points - pose[:, 3]).tolist()
    return Hull(tuple((x, y, z) for x, y, z in corners)), pose


def read_visuals(
    element: ElementTree.Element, folder: Path, materials: dict[str, tuple[float, float, float]]
) -> tuple[Visual, ...]:
    """What is seen of a `<link>`. What cannot be understood is left out: nothing depends on it."""
    found: list[Visual] = []
    for visual in element.findall("visual"):
        geometry = visual.find("geometry")
        if geometry is None or not len(geometry):
            continue
        try:
            pose, colour = read_origin(visual), read_colour(visual.find("material"), materials)
            if geometry[0].tag == "mesh":
                path, scale = _mesh_of(geometry[0], folder)
                found.append(Visual(pose, None, path, scale, colour))
            else:
                found.append(Visual(pose, _primitive(geometry[0]), colour=colour))
        except (InputError, ValueError):
            continue
    return tuple(found)


def read_colour(
    material: ElementTree.Element | None, known: dict[str, tuple[float, float, float]]
) -> tuple[float, float, float] | None:
    """Red, green, blue of a `<material>`, by its name where it has no colour of its own."""
    if material is None:
        return None
    colour = material.find("color")
    if colour is None:
        return known.get(material.get("name", ""))
    red, green, blue, _ = (min(1.0, max(0.0, v)) for v in numbers(colour.get("rgba"), 4, 1.0))
    return red, green, blue


def hull_as_obj(shape: Shape) -> str:
    """A collision shape that is a hull, as an OBJ file in the link's frame: corners only, and
    faces for those who look at it."""
    from scipy.spatial import ConvexHull

    assert isinstance(shape.solid, Hull)
    points = shape.solid.points @ shape.pose[:, :3].T + shape.pose[:, 3]
    faces = ConvexHull(points).simplices
    middle = points.mean(axis=0)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in points.tolist()]
    for a, b, c in faces.tolist():
        normal = np.cross(points[b] - points[a], points[c] - points[a])
        b, c = (b, c) if normal @ (points[a] - middle) > 0 else (c, b)
        lines.append(f"f {a + 1} {b + 1} {c + 1}")
    return "\n".join(lines) + "\n"


def triangles(visual: Visual) -> Mesh | None:
    """The triangles of a visual that is a mesh, in the link's frame; None where the file
    cannot be read."""
    if visual.mesh is None:
        return None
    try:
        mesh = read_mesh(visual.mesh, visual.scale)
    except InputError:
        return None
    vertices = mesh.vertices @ visual.pose[:, :3].T + visual.pose[:, 3]
    return Mesh(vertices, mesh.faces)
