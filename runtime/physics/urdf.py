"""Robots and bodies as URDF with masses, for PyBullet to read."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as Xml

import numpy as np

from runtime.robot.urdf import Joint
from runtime.trace.kinematics import joint_motion
from runtime.trace.model import TraceRobot
from runtime.trace.write_world import hull_faces
from runtime.world.body import Body, Part
from runtime.world.poses import Floats, Pose
from runtime.world.solids import Box, Capsule, Cylinder, Hull, Solid, Sphere

LINK_DENSITY = 400.0
"""kg/m^3 of the robot's solids: about 100 kg for the built-in robot."""

LEAST_MASS = 0.2
"""kg of a link, so that light links at the end of a chain do not make it stiff."""

FRAME_MASS = 0.001
"""kg of a link without a body: physics has no links without mass."""

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
"""Joints between the world and the robot's root: the base drives in the plane. Links and joints
of the robot itself may have any name, `world` is a common one: `own_name` keeps them apart."""


def robot_urdf(robot: TraceRobot, folder: Path) -> str:
    """The robot as URDF with masses, on a base that three joints move in the plane. Hulls are
    written into a folder as meshes."""
    root = Xml.Element("robot", name=robot.name)
    kinds = ("prismatic", "prismatic", "continuous")
    above = [own_name(robot, name) for name in ("world", "base_x_link", "base_y_link")]
    links = [*above, robot.urdf.root]
    for link in above:
        _link(root, link, (), folder)
    axes = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    for i, name in enumerate(BASE_JOINTS):
        called, pose = own_name(robot, name), np.eye(3, 4)
        joint = Joint(called, kinds[i], links[i], links[i + 1], pose, axes[i], -1e3, 1e3, 10)
        _joint(root, joint)
    for link, shapes in robot.urdf.shapes.items():
        _link(root, link, [Part(shape.solid, shape.pose) for shape in shapes], folder)
    moving = {*robot.joints, *robot.fingers}
    for joint in robot.urdf.joints.values():
        if joint.name in moving:
            _joint(root, joint)
        else:
            held = joint.origin @ joint_motion(joint, robot.fixed.get(joint.name, 0.0))
            _joint(root, replace(joint, origin=held, type="fixed"))
    return _text(root)


def own_name(robot: TraceRobot, name: str) -> str:
    """A name of what stands above the robot's root, unlike any of its links and joints."""
    taken = robot.urdf.shapes.keys() | {joint.name for joint in robot.urdf.joints.values()}
    while name in taken:
        name = f"{name}_"
    return name


def body_urdf(body: Body, fixed: bool, folder: Path) -> str:
    """A body as URDF, with its mass and centre of mass."""
    root = Xml.Element("robot", name="body")
    link = Xml.SubElement(root, "link", name="body")
    volume = sum(part.solid.volume for part in body.parts)
    density = body.mass / volume if volume > 0 else 0.0
    _, _, inertia = _inertia(body.parts, density, np.array(body.centre))
    _inertial(link, 0.0 if fixed else body.mass, np.array(body.centre), inertia)
    _shapes(link, body.parts, folder)
    return _text(root)


def _text(root: Xml.Element) -> str:
    Xml.indent(root)  # PyBullet reads files in lines of a thousand characters at most
    return Xml.tostring(root, encoding="unicode")


def _numbers(values: Floats | Sequence[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _rpy(rotation: Floats) -> Floats:
    """Fixed-axis roll, pitch, yaw of a rotation (3, 3)."""
    sine = min(1.0, max(-1.0, -rotation[2, 0]))
    if abs(sine) > 1 - 1e-9:  # roll and yaw turn about the same axis
        return np.array([0.0, math.asin(sine), math.atan2(-rotation[0, 1], rotation[1, 1])])
    return np.array(
        [
            math.atan2(rotation[2, 1], rotation[2, 2]),
            math.asin(sine),
            math.atan2(rotation[1, 0], rotation[0, 0]),
        ]
    )


def _origin(parent: Xml.Element, pose: Pose) -> None:
    Xml.SubElement(parent, "origin", xyz=_numbers(pose[:, 3]), rpy=_numbers(_rpy(pose[:, :3])))


def _link(root: Xml.Element, name: str, parts: Sequence[Part], folder: Path) -> None:
    link = Xml.SubElement(root, "link", name=name)
    mass, centre, inertia = _inertia(parts, LINK_DENSITY)
    if mass <= 0:
        mass, inertia = FRAME_MASS, np.eye(3) * FRAME_MASS * 1e-3
    else:
        # No principal inertia below that of a ball of 3 cm: Bullet's solver wants no needles.
        scale = max(1.0, LEAST_MASS / mass)
        mass, inertia = mass * scale, (inertia + 0.4 * mass * 0.03**2 * np.eye(3)) * scale
    _inertial(link, mass, centre, inertia)
    _shapes(link, parts, folder)


def _inertial(link: Xml.Element, mass: float, centre: Floats, inertia: Floats) -> None:
    inertial = Xml.SubElement(link, "inertial")
    Xml.SubElement(inertial, "origin", xyz=_numbers(centre), rpy="0 0 0")
    Xml.SubElement(inertial, "mass", value=f"{mass:.9g}")
    keys = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2)}
    values = {key: f"{inertia[i]:.9g}" for key, i in {**keys, "izz": (2, 2)}.items()}
    Xml.SubElement(inertial, "inertia", values)


def _shapes(link: Xml.Element, parts: Sequence[Part], folder: Path) -> None:
    for part in parts:
        for tag in ("collision", "visual"):
            shape = Xml.SubElement(link, tag)
            _origin(shape, part.pose)
            _geometry(Xml.SubElement(shape, "geometry"), part.solid, folder)


def _geometry(parent: Xml.Element, solid: Solid, folder: Path) -> None:
    match solid:
        case Box():
            Xml.SubElement(parent, "box", size=_numbers(solid.size))
        case Sphere():
            Xml.SubElement(parent, "sphere", radius=f"{solid.radius:.9g}")
        case Cylinder() | Capsule():
            kind = "cylinder" if isinstance(solid, Cylinder) else "capsule"
            sizes = {"radius": f"{solid.radius:.9g}", "length": f"{solid.height:.9g}"}
            Xml.SubElement(parent, kind, sizes)
        case Hull():
            Xml.SubElement(parent, "mesh", filename=_mesh(solid, folder).name)


def _mesh(hull: Hull, folder: Path) -> Path:
    """A hull as a file that PyBullet takes for the hull of its corners."""
    path = folder / f"hull{len(list(folder.iterdir()))}.obj"
    lines = [f"v {_numbers(corner)}" for corner in hull.corners]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in hull_faces(hull.points)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _inertia(
    parts: Sequence[Part], density: float, about: Floats | None = None
) -> tuple[float, Floats, Floats]:
    """Mass, centre of mass and inertia (3, 3), about it or another point; a hull has that of
    the box around it, with its own mass."""
    masses = np.array([part.solid.volume * density for part in parts])
    total = float(masses.sum())
    if total <= 0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    centres = np.array([part.pose[:, 3] for part in parts])
    centre = (masses[:, None] * centres).sum(axis=0) / total
    inertia = np.zeros((3, 3))
    for part, mass in zip(parts, masses, strict=True):
        offset = part.pose[:, 3] - (centre if about is None else about)
        rotation = part.pose[:, :3]
        inertia += rotation @ np.diag(_squares(part.solid) * mass) @ rotation.T
        inertia += mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return total, centre, inertia


def _squares(solid: Solid) -> Floats:
    """Principal inertias (3,) of a solid for a mass of 1."""
    match solid:
        case Sphere():
            return np.full(3, 0.4 * solid.radius**2)
        case Cylinder() | Capsule():
            length = solid.height + (solid.radius if isinstance(solid, Capsule) else 0.0)
            across = (3 * solid.radius**2 + length**2) / 12
            return np.array([across, across, solid.radius**2 / 2])
        case _:
            square = np.array(solid.half) ** 2
            box: Floats = (square.sum() - square) / 3
            return box


def _joint(root: Xml.Element, joint: Joint) -> None:
    element = Xml.SubElement(root, "joint", name=joint.name, type=joint.type)
    Xml.SubElement(element, "parent", link=joint.parent)
    Xml.SubElement(element, "child", link=joint.child)
    _origin(element, joint.origin)
    if joint.type != "fixed":
        Xml.SubElement(element, "axis", xyz=_numbers(joint.axis))
        limits = {"lower": joint.lower, "upper": joint.upper, "velocity": joint.velocity}
        Xml.SubElement(
            element, "limit", {key: f"{v:.9g}" for key, v in limits.items()} | {"effort": "10000"}
        )
