"""Read the part of URDF that planning needs: joints, limits, box collision shapes.

Other shapes are refused, with the link named: a collision shape that is silently left out
would make plans that collide.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from runtime.errors import InputError

Pose = NDArray[np.float64]
"""A 3x4 matrix [R | t]."""


@dataclass(frozen=True)
class Box:
    """A box fixed to a link: pose (3, 4) in the link frame, half extents (3,) in metres."""

    name: str
    pose: Pose
    half: NDArray[np.float64]


@dataclass(frozen=True)
class Joint:
    """A joint and where it sits in its parent link; unit axis; limits in rad, m, rad/s, m/s."""

    name: str
    type: str
    parent: str
    child: str
    origin: Pose
    axis: NDArray[np.float64]
    lower: float = 0.0
    upper: float = 0.0
    velocity: float = 0.0


@dataclass(frozen=True)
class Urdf:
    """Links with their collision boxes, and joints by the name of their child link."""

    name: str
    boxes: dict[str, tuple[Box, ...]]
    joints: dict[str, Joint] = field(default_factory=dict)

    def chain(self, root: str, tip: str) -> list[Joint]:
        """The joints from link `root` to link `tip`, in order."""
        joints: list[Joint] = []
        link = tip
        while link != root:
            if link not in self.joints:
                raise InputError(f"link {tip!r} is not connected to link {root!r}")
            joints.append(self.joints[link])
            link = self.joints[link].parent
        return joints[::-1]


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """URDF's fixed-axis roll, pitch, yaw as a rotation matrix (3, 3)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def compose(a: Pose, b: Pose) -> Pose:
    """The pose `a b` of 3x4 matrices."""
    out = np.empty((3, 4))
    out[:, :3] = a[:, :3] @ b[:, :3]
    out[:, 3] = a[:, :3] @ b[:, 3] + a[:, 3]
    return out


def invert(pose: Pose) -> Pose:
    """The inverse of a 3x4 pose."""
    out = np.empty((3, 4))
    out[:, :3] = pose[:, :3].T
    out[:, 3] = -out[:, :3] @ pose[:, 3]
    return out


def identity() -> Pose:
    """The pose that changes nothing."""
    return np.eye(3, 4)


def read_urdf(path: Path) -> Urdf:
    """Parse a URDF file.

    Raises:
        InputError: the file cannot be read, is not XML, or holds shapes other than boxes.
    """
    try:
        root = ElementTree.parse(path).getroot()
    except OSError as error:
        raise InputError(f"cannot read the robot's URDF {path}: {error.strerror}") from None
    except ElementTree.ParseError as error:
        raise InputError(f"{path} is not well-formed XML: {error}") from None
    boxes = {
        link.get("name", ""): tuple(
            _read_box(path, link.get("name", ""), i, collision)
            for i, collision in enumerate(link.findall("collision"))
        )
        for link in root.findall("link")
    }
    joints = {}
    for element in root.findall("joint"):
        joint = _read_joint(path, element)
        for end in (joint.parent, joint.child):
            if end not in boxes:
                raise InputError(f"{path}: joint {joint.name!r} names an unknown link {end!r}")
        joints[joint.child] = joint
    return Urdf(root.get("name", path.stem), boxes, joints)


def _numbers(text: str | None, count: int) -> list[float]:
    if text is None:
        return [0.0] * count
    values = [float(word) for word in text.split()]
    if len(values) != count:
        raise ValueError(f"expected {count} numbers, found {text!r}")
    return values


def _read_origin(element: ElementTree.Element) -> Pose:
    origin = element.find("origin")
    if origin is None:
        return identity()
    pose = np.empty((3, 4))
    pose[:, :3] = rotation_from_rpy(*_numbers(origin.get("rpy"), 3))
    pose[:, 3] = _numbers(origin.get("xyz"), 3)
    return pose


def _read_box(path: Path, link: str, index: int, element: ElementTree.Element) -> Box:
    box = element.find("geometry/box")
    if box is None:
        raise InputError(
            f"{path}: link {link!r} has a collision shape that is not a box",
            hint="cover the link with boxes; meshes and cylinders are not supported",
        )
    name = element.get("name") or (link if index == 0 else f"{link}_{index}")
    try:
        return Box(name, _read_origin(element), np.array(_numbers(box.get("size"), 3)) / 2)
    except ValueError as error:
        raise InputError(f"{path}: collision shape of link {link!r}: {error}") from None


def _read_joint(path: Path, element: ElementTree.Element) -> Joint:
    name = element.get("name", "")
    kind = element.get("type", "")
    parent, child = element.find("parent"), element.find("child")
    if parent is None or child is None:
        raise InputError(f"{path}: joint {name!r} lacks its parent or child link")
    axis, limit = element.find("axis"), element.find("limit")
    try:
        direction = np.array(_numbers(axis.get("xyz"), 3) if axis is not None else [1.0, 0.0, 0.0])
        length = float(np.linalg.norm(direction))
        if length == 0.0:
            raise ValueError("its axis has no direction")
        return Joint(
            name,
            kind,
            parent.get("link", ""),
            child.get("link", ""),
            _read_origin(element),
            direction / length,
            float(limit.get("lower", 0.0)) if limit is not None else -math.inf,
            float(limit.get("upper", 0.0)) if limit is not None else math.inf,
            float(limit.get("velocity", 0.0)) if limit is not None else math.inf,
        )
    except ValueError as error:
        raise InputError(f"{path}: joint {name!r}: {error}") from None
