"""What physics needs to know that neither plan nor robot file say: masses, friction, forces.

These are this project's own choices, not measurements of a robot (`docs/execution.md`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from xml.etree import ElementTree as Xml

import numpy as np

from runtime.robot.model import Floats
from runtime.robot.shapes import Shape
from runtime.robot.urdf import Joint
from runtime.trace.kinematics import joint_motion
from runtime.trace.model import TraceRobot

LINK_DENSITY = 400.0
"""kg/m^3 of the robot's boxes: about 100 kg for the built-in robot."""

LEAST_MASS = 0.2
"""kg of a link, so that light links at the end of a chain do not make it stiff."""

FRAME_MASS = 0.001
"""kg of a link without a body: physics has no links without mass."""

OBJECT_DENSITY = 500.0
"""kg/m^3, light wood: a stick of 40 x 40 x 200 mm has 0.16 kg."""

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
"""Joints between the world and the robot's root: the base drives in the plane."""


@dataclass(frozen=True)
class Materials:
    """Coefficients of friction (tangential, and torsional in metres), and the force of each
    finger in newtons."""

    friction: float = 0.7
    spinning: float = 0.002
    finger_force: float = 16.0

    @property
    def holding_force(self) -> float:
        """Newtons that two fingers can hold by friction: a grasp breaks above it."""
        return 2 * self.friction * self.finger_force


def robot_urdf(robot: TraceRobot) -> str:
    """The robot as URDF with masses, on a base that three joints move in the plane."""
    root = Xml.Element("robot", name=robot.name)
    kinds = ("prismatic", "prismatic", "continuous")
    links = ["world", "base_x_link", "base_y_link", robot.urdf.root]
    for link in links[:3]:
        _link(root, link, ())
    axes = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    for i, name in enumerate(BASE_JOINTS):
        joint = Joint(name, kinds[i], links[i], links[i + 1], np.eye(3, 4), axes[i], -1e3, 1e3, 10)
        _joint(root, joint)
    for link, boxes in robot.urdf.boxes.items():
        _link(root, link, boxes)
    moving = {*robot.joints, *robot.fingers}
    for joint in robot.urdf.joints.values():
        if joint.name in moving:
            _joint(root, joint)
        else:
            held = joint.origin @ joint_motion(joint, robot.fixed.get(joint.name, 0.0))
            _joint(root, replace(joint, origin=held, type="fixed"))
    Xml.indent(root)  # PyBullet reads files in lines of a thousand characters at most
    return Xml.tostring(root, encoding="unicode")


def _numbers(values: Floats) -> str:
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


def _origin(parent: Xml.Element, pose: Floats) -> None:
    Xml.SubElement(parent, "origin", xyz=_numbers(pose[:, 3]), rpy=_numbers(_rpy(pose[:, :3])))


def _link(root: Xml.Element, name: str, boxes: tuple[Shape, ...]) -> None:
    link = Xml.SubElement(root, "link", name=name)
    mass, centre, inertia = _inertia(boxes)
    inertial = Xml.SubElement(link, "inertial")
    Xml.SubElement(inertial, "origin", xyz=_numbers(centre), rpy="0 0 0")
    Xml.SubElement(inertial, "mass", value=f"{mass:.9g}")
    keys = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2)}
    values = {key: f"{inertia[i]:.9g}" for key, i in {**keys, "izz": (2, 2)}.items()}
    Xml.SubElement(inertial, "inertia", values)
    for box in boxes:
        for tag in ("collision", "visual"):
            shape = Xml.SubElement(link, tag)
            _origin(shape, box.pose)
            geometry = Xml.SubElement(shape, "geometry")
            Xml.SubElement(geometry, "box", size=_numbers(2 * box.half))


def _inertia(boxes: tuple[Shape, ...]) -> tuple[float, Floats, Floats]:
    """Mass, centre of mass and inertia (3, 3) about it, of solid boxes."""
    masses = np.array([8 * float(np.prod(box.half)) * LINK_DENSITY for box in boxes])
    total = float(masses.sum())
    if total <= 0:
        return FRAME_MASS, np.zeros(3), np.eye(3) * FRAME_MASS * 1e-3
    scale = max(1.0, LEAST_MASS / total)
    centres = np.array([box.pose[:, 3] for box in boxes])
    centre = (masses[:, None] * centres).sum(axis=0) / total
    inertia = np.zeros((3, 3))
    for box, mass in zip(boxes, masses, strict=True):
        square = box.half**2
        own = np.diag(square.sum() - square) * mass / 3
        offset = box.pose[:, 3] - centre
        rotation = box.pose[:, :3]
        inertia += rotation @ own @ rotation.T
        inertia += mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    # No principal inertia below that of a ball of 3 cm: Bullet's solver wants no needles.
    least = 0.4 * total * 0.03**2
    return total * scale, centre, (inertia + least * np.eye(3)) * scale


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
