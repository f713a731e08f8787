"""Read the part of URDF that planning needs: joints, limits, box collision shapes.

Other shapes are refused, with the link named: a collision shape that is silently left out
would make plans that collide.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from runtime.world.poses import Pose, identity, rotation_from_rpy
from sketchlang.errors import InputError
from sketchlang.reading import read_xml

JOINT_TYPES = ("fixed", "revolute", "continuous", "prismatic")


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
    """A tree of links with their collision boxes; joints by the name of their child link."""

    name: str
    root: str
    boxes: dict[str, tuple[Box, ...]]
    joints: dict[str, Joint] = field(default_factory=dict)

    def chain(self, tip: str) -> list[Joint]:
        """The joints from the root to link `tip`, in order."""
        joints: list[Joint] = []
        link = tip
        while link in self.joints:
            joints.append(self.joints[link])
            link = self.joints[link].parent
        return joints[::-1]


def read_urdf(path: Path) -> Urdf:
    """Parse a URDF file.

    Raises:
        InputError: the file cannot be read, is not XML, is not a tree of links, or holds
            shapes other than boxes.
    """
    root = read_xml(path)
    try:
        return _read(root, path.stem)
    except InputError as error:
        raise InputError(error.message, place=str(path), hint=error.hint) from None


def _read(robot: ElementTree.Element, name: str) -> Urdf:
    boxes = {
        link.get("name", ""): tuple(
            _read_box(link.get("name", ""), i, collision)
            for i, collision in enumerate(link.findall("collision"))
        )
        for link in robot.findall("link")
    }
    joints: dict[str, Joint] = {}
    for element in robot.findall("joint"):
        joint = _read_joint(element)
        for end in (joint.parent, joint.child):
            if end not in boxes:
                raise InputError(f"joint {joint.name!r} names an unknown link {end!r}")
        if joint.child in joints:
            other = joints[joint.child].name
            raise InputError(f"link {joint.child!r} hangs on two joints: {other!r}, {joint.name!r}")
        joints[joint.child] = joint
    return Urdf(robot.get("name", name), _root(boxes, joints), boxes, joints)


def _root(links: Iterable[str], joints: Mapping[str, Joint]) -> str:
    """The link that all others hang on."""
    roots = [link for link in links if link not in joints]
    if len(roots) != 1:
        found = ", ".join(map(repr, roots)) or "none"
        raise InputError(f"the links must hang on one root; links without a parent: {found}")
    reached = set(roots)
    pending = list(joints.values())
    while pending:
        hanging = [joint for joint in pending if joint.parent in reached]
        if not hanging:
            loose = ", ".join(repr(joint.child) for joint in pending)
            raise InputError(f"these links hang in a circle and not on {roots[0]!r}: {loose}")
        reached |= {joint.child for joint in hanging}
        pending = [joint for joint in pending if joint.child not in reached]
    return roots[0]


def _numbers(text: str | None, count: int) -> list[float]:
    if text is None:
        return [0.0] * count
    values = [float(word) for word in text.split()]
    if len(values) != count or not all(map(math.isfinite, values)):
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


def _read_box(link: str, index: int, element: ElementTree.Element) -> Box:
    box = element.find("geometry/box")
    if box is None:
        raise InputError(
            f"link {link!r} has a collision shape that is not a box",
            hint="cover the link with boxes; meshes and cylinders are not supported",
        )
    name = element.get("name") or (link if index == 0 else f"{link}_{index}")
    try:
        size = _numbers(box.get("size"), 3)
        if min(size) <= 0:
            raise ValueError(f"needs a size of three positive numbers, found {box.get('size')!r}")
        return Box(name, _read_origin(element), np.array(size) / 2)
    except ValueError as error:
        raise InputError(f"collision shape of link {link!r}: {error}") from None


def _read_joint(element: ElementTree.Element) -> Joint:
    name = element.get("name", "")
    kind = element.get("type", "")
    if kind not in JOINT_TYPES:
        known = ", ".join(JOINT_TYPES)
        raise InputError(f"joint {name!r} is of type {kind!r}", hint=f"supported: {known}")
    parent, child = element.find("parent"), element.find("child")
    if parent is None or child is None:
        raise InputError(f"joint {name!r} lacks its parent or child link")
    axis = element.find("axis")
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
            *_read_limits(kind, element.find("limit")),
        )
    except ValueError as error:
        raise InputError(f"joint {name!r}: {error}") from None


def _read_limits(kind: str, limit: ElementTree.Element | None) -> tuple[float, float, float]:
    """Lower and upper limit, and velocity."""
    if kind == "fixed":
        return 0.0, 0.0, 0.0
    if limit is None:
        raise ValueError("a joint that moves needs a <limit>")
    (velocity,) = _numbers(limit.get("velocity"), 1)
    if velocity <= 0:
        raise ValueError("its limit needs a positive velocity")
    if kind == "continuous":
        return -math.pi, math.pi, velocity
    (lower,), (upper,) = _numbers(limit.get("lower"), 1), _numbers(limit.get("upper"), 1)
    if not lower <= upper:
        raise ValueError(f"its lower limit {lower:g} is above its upper limit {upper:g}")
    return lower, upper, velocity
