"""Kinematics of the whole robot for many configurations at once, straight from the URDF."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from runtime.judge.contacts import Track
from runtime.judge.extents import homogeneous
from runtime.robot.model import RobotModel
from runtime.robot.urdf import Joint
from runtime.world.poses import Floats
from runtime.world.solids import Solid

Transforms = Floats
"""Poses (N, 4, 4)."""


@dataclass(frozen=True, eq=False)
class LinkSolid:
    """A collision solid of a link and its pose (4, 4) there."""

    link: str
    solid: Solid
    pose: Floats


class Skeleton:
    """Links, joints and solids of a robot in tree order."""

    def __init__(self, robot: RobotModel) -> None:
        self.robot = robot
        urdf = robot.urdf
        self.solids = [
            LinkSolid(link, shape.solid, homogeneous(shape.pose))
            for link, shapes in urdf.shapes.items()
            for shape in shapes
        ]
        self.order: list[Joint] = []
        self.root = urdf.root
        reached = {self.root}
        pending = list(urdf.joints.values())
        while pending:
            ready = [joint for joint in pending if joint.parent in reached]
            self.order += ready
            reached |= {joint.child for joint in ready}
            pending = [joint for joint in pending if joint not in ready]
        self.rigid = self._rigid_groups()

    def _rigid_groups(self) -> dict[str, int]:
        """Links with the same number never move against each other; that of the root is 0."""
        moving = set(self.robot.joints) | set(self.robot.gripper.joints)
        group = {self.root: 0}
        for joint in self.order:
            group[joint.child] = len(group) if joint.name in moving else group[joint.parent]
        return group

    @property
    def fingers(self) -> frozenset[str]:
        """Links that the finger joints move."""
        hand = self.rigid[self.robot.urdf_tool]
        return frozenset(n for n in self.robot.gripper.links if self.rigid[n] != hand)

    def may_touch(self, a: str, b: str) -> bool:
        """Whether contact of two links is no collision."""
        return self.rigid[a] == self.rigid[b] or frozenset((a, b)) in self.robot.ignored

    def tracks(self, links: dict[str, Transforms]) -> list[Track]:
        """The robot's solids with the links at poses."""
        return [Track(s.link, s.solid, links[s.link] @ s.pose) for s in self.solids]

    def transforms(self, base: Floats, q: Floats, opening: float | Floats) -> dict[str, Transforms]:
        """World poses (N, 4, 4) of all links for base poses (N, 3), configurations (N, n),
        and one opening of the gripper or N of them."""
        count = len(base)
        c, s = np.cos(base[:, 2]), np.sin(base[:, 2])
        root = np.tile(np.eye(4), (count, 1, 1))
        root[:, 0, 0], root[:, 0, 1], root[:, 0, 3] = c, -s, base[:, 0]
        root[:, 1, 0], root[:, 1, 1], root[:, 1, 3] = s, c, base[:, 1]
        values = {name: q[:, i] for i, name in enumerate(self.robot.joints)}
        values |= self.robot.gripper.joint_values(np.broadcast_to(opening, count))
        for name, value in self.robot.fixed.items():
            values[name] = np.full(count, value)
        links = {self.root: root}
        for joint in self.order:
            here = links[joint.parent] @ homogeneous(joint.origin)
            if joint.name in values:
                here = here @ _joint_motion(joint, values[joint.name])
            links[joint.child] = here
        return links


def _joint_motion(joint: Joint, value: Floats) -> Transforms:
    """Motion (N, 4, 4) of a joint for its values (N,), by Rodrigues' formula."""
    motion = np.tile(np.eye(4), (len(value), 1, 1))
    x, y, z = joint.axis
    if joint.type == "prismatic":
        motion[:, :3, 3] = value[:, None] * joint.axis
        return motion
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sine, cosine = np.sin(value)[:, None, None], np.cos(value)[:, None, None]
    motion[:, :3, :3] = np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross)
    return motion
