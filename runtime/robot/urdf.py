"""Read the part of URDF that planning needs: a tree of links, joints, limits, shapes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from runtime.robot.shapes import (
    Shape,
    Visual,
    numbers,
    read_colour,
    read_origin,
    read_shapes,
    read_visuals,
)
from runtime.world.poses import Pose, identity
from sketchlang.errors import InputError
from sketchlang.reading import read_xml

JOINT_TYPES = ("fixed", "revolute", "continuous", "prismatic", "planar", "floating")

XACRO = "xacro:"
"""The name space of macros."""

MOVING = ("revolute", "continuous", "prismatic")
"""Types of joints with one degree of freedom."""

DEFAULT_VELOCITY = {"prismatic": 0.1, "revolute": 1.0, "continuous": 1.0}
"""m/s, rad/s of joints whose velocity is not given; `Joint.absent` tells of it."""


@dataclass(frozen=True)
class Box:
    """A box in some frame: pose (3, 4), half extents (3,) in metres."""

    name: str
    pose: Pose
    half: NDArray[np.float64]


@dataclass(frozen=True)
class Mimic:
    """A joint follows another one: its value is `multiplier` times that one's, plus `offset`."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Joint:
    """A joint and where it sits in its parent link; unit axis; limits in rad, m, rad/s, m/s.

    `absent` names what the file does not say (`"limits"`, `"velocity"`) and is assumed.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Pose
    axis: NDArray[np.float64]
    lower: float = 0.0
    upper: float = 0.0
    velocity: float = 0.0
    mimic: Mimic | None = None
    absent: tuple[str, ...] = ()


@dataclass(frozen=True)
class Urdf:
    """A tree of links with their collision shapes; joints by the name of their child link."""

    name: str
    root: str
    shapes: Mapping[str, tuple[Shape, ...]]
    joints: Mapping[str, Joint] = field(default_factory=dict)
    visuals: Mapping[str, tuple[Visual, ...]] = field(default_factory=dict)

    @property
    def boxes(self) -> Mapping[str, tuple[Shape, ...]]:
        """The shapes, for those who take each as the box around it (`pose` and `half`)."""
        return self.shapes

    def joint(self, name: str) -> Joint | None:
        """The joint of a name."""
        return next((joint for joint in self.joints.values() if joint.name == name), None)

    def chain(self, tip: str) -> list[Joint]:
        """The joints from the root to link `tip`, in order."""
        joints: list[Joint] = []
        link = tip
        while link in self.joints:
            joints.append(self.joints[link])
            link = self.joints[link].parent
        return joints[::-1]

    def below(self, link: str) -> set[str]:
        """A link and all that hang on it."""
        found = {link}
        pending = list(self.joints.values())
        while True:
            more = {joint.child for joint in pending if joint.parent in found} - found
            if not more:
                return found
            found |= more

    def part(self, root: str) -> Urdf:
        """What hangs on a link, with that link as the root."""
        kept = self.below(root)
        return Urdf(
            self.name,
            root,
            {link: shapes for link, shapes in self.shapes.items() if link in kept},
            {link: joint for link, joint in self.joints.items() if link in kept - {root}},
            {link: visuals for link, visuals in self.visuals.items() if link in kept},
        )

    def free_name(self, wanted: str) -> str:
        """A name for a new link: the wanted one, or with a number where it is taken."""
        tried = (f"{wanted}_{number}" if number > 1 else wanted for number in count(1))
        taken = self.shapes.keys() | {joint.name for joint in self.joints.values()}
        return next(n for n in tried if n not in taken and f"{n}_mount" not in taken)

    def with_frame(self, name: str, parent: str, pose: Pose) -> Urdf:
        """The same with an empty link, fixed to another one."""
        return self.attached(Urdf(name, name, {name: ()}), parent, pose)

    def raised(self, name: str, height: float) -> Urdf:
        """The same on a new root, `height` metres below the old one."""
        pose = identity()
        pose[2, 3] = height
        return Urdf(self.name, name, {name: ()}).attached(self, name, pose)

    def attached(self, other: Urdf, parent: str, pose: Pose) -> Urdf:
        """The same with another tree fixed to one of the links, its root at a pose there.

        Raises:
            InputError: both have a link or a joint of the same name.
        """
        joint = Joint(f"{other.root}_mount", "fixed", parent, other.root, pose, np.eye(3)[0])
        names = {j.name for j in self.joints.values()} & {
            joint.name,
            *(j.name for j in other.joints.values()),
        }
        common = sorted((self.shapes.keys() & other.shapes.keys()) | names)
        if common:
            raise InputError(f"both have a link or joint {common[0]!r}")
        return replace(
            self,
            shapes={**self.shapes, **other.shapes},
            joints={**self.joints, other.root: joint, **other.joints},
            visuals={**self.visuals, **other.visuals},
        )


def read_urdf(path: Path) -> Urdf:
    """Parse a URDF file.

    Raises:
        InputError: the file cannot be read, is not XML, is not a tree of links, or holds
            shapes that cannot be understood.
    """
    root = read_xml(path)
    if any(element.tag.startswith(XACRO) for element in root.iter()):
        raise InputError(
            "the file still has macros of xacro in it",
            place=str(path),
            hint=f"expand them first: `xacro {path.name} > robot.urdf`",
        )
    try:
        return _read(root, path)
    except InputError as error:
        raise InputError(error.message, place=str(path), hint=error.hint) from None


def _read(robot: ElementTree.Element, path: Path) -> Urdf:
    materials = {}
    for element in robot.findall("material"):
        colour = read_colour(element, {})
        if colour is not None:
            materials[element.get("name", "")] = colour
    shapes: dict[str, tuple[Shape, ...]] = {}
    visuals: dict[str, tuple[Visual, ...]] = {}
    for link in robot.findall("link"):
        name = link.get("name", "")
        if name in shapes:
            raise InputError(f"two links have the name {name!r}")
        shapes[name] = read_shapes(name, link, path.parent)
        visuals[name] = read_visuals(link, path.parent, materials)
    joints: dict[str, Joint] = {}
    names: set[str] = set()
    for element in robot.findall("joint"):
        joint = _read_joint(element)
        for end in (joint.parent, joint.child):
            if end not in shapes:
                raise InputError(f"joint {joint.name!r} names an unknown link {end!r}")
        if joint.child in joints:
            other = joints[joint.child].name
            raise InputError(f"link {joint.child!r} hangs on two joints: {other!r}, {joint.name!r}")
        if joint.name in names:
            raise InputError(f"two joints have the name {joint.name!r}")
        names.add(joint.name)
        joints[joint.child] = joint
    _check_mimics(joints.values())
    root = _root(shapes, joints)
    return Urdf(robot.get("name", path.stem), root, shapes, joints, visuals)


def _check_mimics(joints: Iterable[Joint]) -> None:
    """Mimicked joints exist and follow no one in a circle."""
    follows = {joint.name: joint.mimic.joint for joint in joints if joint.mimic is not None}
    names = {joint.name for joint in joints}
    for name, leader in follows.items():
        seen = {name}
        while True:
            if leader not in names:
                raise InputError(f"joint {name!r} mimics an unknown joint {leader!r}")
            if leader in seen:
                raise InputError(f"joint {name!r} mimics itself")
            seen.add(leader)
            if leader not in follows:
                break
            leader = follows[leader]


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
        direction = np.array(numbers(axis.get("xyz"), 3) if axis is not None else [1.0, 0.0, 0.0])
        length = float(np.linalg.norm(direction))
        if length == 0.0:
            if kind in MOVING:
                raise ValueError("its axis has no direction")
            direction, length = np.eye(3)[0], 1.0  # joints that do not turn need none
        return Joint(
            name,
            kind,
            parent.get("link", ""),
            child.get("link", ""),
            read_origin(element),
            direction / length,
            *_read_limits(kind, element.find("limit")),
            mimic=_read_mimic(element.find("mimic")),
            absent=_absent(kind, element.find("limit")),
        )
    except ValueError as error:
        raise InputError(f"joint {name!r}: {error}") from None


def _read_mimic(element: ElementTree.Element | None) -> Mimic | None:
    if element is None:
        return None
    (multiplier,) = numbers(element.get("multiplier"), 1, 1.0)
    (offset,) = numbers(element.get("offset"), 1)
    return Mimic(element.get("joint", ""), multiplier, offset)


def _absent(kind: str, limit: ElementTree.Element | None) -> tuple[str, ...]:
    """What a joint that moves should say and does not."""
    if kind not in MOVING:
        return ()
    given = {} if limit is None else limit.attrib
    absent = []
    if kind != "continuous" and not {"lower", "upper"} & given.keys():
        absent.append("limits")
    if numbers(given.get("velocity"), 1)[0] == 0.0:
        absent.append("velocity")
    return tuple(absent)


def _read_limits(kind: str, limit: ElementTree.Element | None) -> tuple[float, float, float]:
    """Lower and upper limit, and velocity; assumed where they are absent."""
    if kind not in MOVING:
        return 0.0, 0.0, 0.0
    absent = _absent(kind, limit)
    given = {} if limit is None else limit.attrib
    (velocity,) = numbers(given.get("velocity"), 1)
    if velocity < 0:
        raise ValueError("its limit needs a positive velocity")
    if "velocity" in absent:
        velocity = DEFAULT_VELOCITY[kind]
    if kind == "continuous" or ("limits" in absent and kind == "revolute"):
        return -math.pi, math.pi, velocity
    (lower,), (upper,) = numbers(given.get("lower"), 1), numbers(given.get("upper"), 1)
    if not lower <= upper:
        raise ValueError(f"its lower limit {lower:g} is above its upper limit {upper:g}")
    return lower, upper, velocity
