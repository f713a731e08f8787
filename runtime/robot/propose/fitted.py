"""A gripper fitted to a flange: where, and which way it points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from runtime.robot.file import gripper_path
from runtime.robot.outline import points_of
from runtime.robot.urdf import MOVING, Urdf, read_urdf
from runtime.world.poses import Pose, compose, identity
from runtime.world.solids import Floats

OFF_JOINT = 0.01
"""Metres from the last joint beyond which a flange's place says which way is outwards."""

ALONG_AXIS = 0.966
"""Cosine of the angle within which two directions are the same: 15 degrees."""


@dataclass(frozen=True, eq=False)
class Mount:
    """A gripper that is fitted to a robot: the name or path of its URDF, the link that it is
    fixed to, where, and the root link of the gripper."""

    urdf: str
    link: str
    pose: Pose
    root: str


def fitted(urdf: Urdf, link: str, gripper: str) -> tuple[Mount, Urdf]:
    """The robot with a gripper on a link: its z outwards, its root where the link's shapes end
    that way."""
    other = read_urdf(gripper_path(gripper))
    pose = identity()
    pose[:, :3] = turned = _outwards(urdf, link)
    outward = turned[:, 2]
    ends = [float((points_of(s, identity()) @ outward).max()) for s in urdf.shapes[link]]
    pose[:, 3] = outward * round(max([0.0, *ends]), 4)
    return Mount(gripper, link, pose, other.root), urdf.attached(other, link, pose)


def _outwards(urdf: Urdf, link: str) -> Floats:
    """The rotation (3, 3) in a flange whose z points outwards. Flanges lie on the last joint's
    axis, away from it: where the link's origin is so, that way is outwards, whichever axis of
    the link it is; otherwise it is the link's z, as for most."""
    joints = urdf.chain(link)
    last = max((k for k, joint in enumerate(joints) if joint.type in MOVING), default=0)
    pose = identity()
    for joint in joints[last + 1 :]:
        pose = compose(pose, joint.origin)
    away = pose[:, 3]
    length = float(np.linalg.norm(away))
    if length < OFF_JOINT:
        return np.eye(3)
    axis = np.abs(joints[last].axis @ away) / length
    if joints[last].type == "prismatic" or axis < ALONG_AXIS:
        return np.eye(3)
    outward = pose[:, :3].T @ away / length
    main = int(np.abs(outward).argmax())
    if abs(outward[main]) < ALONG_AXIS:
        return np.eye(3)
    sign = float(np.sign(outward[main]))
    z = sign * np.eye(3)[main]
    y = np.eye(3)[1] if main != 1 else np.eye(3)[0]
    return np.column_stack([np.cross(y, z), y, z])
