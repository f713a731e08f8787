"""Kinematics of a tree of links: where links are, and a chain with fixed joints folded away."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runtime.robot.urdf import Joint, Urdf
from runtime.world.poses import Pose, compose, identity, invert
from runtime.world.solids import Floats


def joint_motion(joint: Joint, value: float) -> Pose:
    """What a joint does to its child at a value, in the joint's frame."""
    motion = identity()
    if joint.type == "prismatic":
        motion[:, 3] = joint.axis * value
    elif joint.type in {"revolute", "continuous"} and value:
        x, y, z = joint.axis
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        motion[:, :3] += math.sin(value) * k + (1 - math.cos(value)) * (k @ k)
    return motion


def with_mimics(urdf: Urdf, values: Mapping[str, float]) -> dict[str, float]:
    """Values of all joints that are given or follow, directly or not, one that is given."""
    found = dict(values)
    pending = [j for j in urdf.joints.values() if j.mimic is not None and j.name not in found]
    while pending:
        ready = [j for j in pending if j.mimic is not None and j.mimic.joint in found]
        for joint in ready:
            assert joint.mimic is not None
            leader = found[joint.mimic.joint]
            found[joint.name] = joint.mimic.multiplier * leader + joint.mimic.offset
        if not ready:
            break
        pending = [joint for joint in pending if joint not in ready]
    return found


def link_poses(urdf: Urdf, values: Mapping[str, float]) -> dict[str, Pose]:
    """Poses of all links in the root's frame; joints without a value are at 0."""
    found = {urdf.root: identity()}
    pending = list(urdf.joints.values())
    while pending:
        ready = [joint for joint in pending if joint.parent in found]
        for joint in ready:
            here = compose(found[joint.parent], joint.origin)
            found[joint.child] = compose(here, joint_motion(joint, values.get(joint.name, 0.0)))
        pending = [joint for joint in pending if joint not in ready]
    return found


@dataclass(frozen=True, eq=False)
class Folded:
    """A chain as the kernels take it: `origins` (n, 3, 4) of its moving joints, each about its
    own z axis; for every link, the frame it moves with and its pose there."""

    origins: Floats
    frames: Mapping[str, tuple[int, Pose]]


def _align_z(axis: Floats) -> Pose:
    """A rotation that takes z to the given axis: kernels turn every joint about z."""
    pose = identity()
    z = axis / np.linalg.norm(axis)
    if abs(z[2]) < 1 - 1e-12:
        x = np.cross([0.0, 0.0, 1.0], z)
        x /= np.linalg.norm(x)
        pose[:, :3] = np.column_stack([x, np.cross(z, x), z])
    elif z[2] < 0:
        pose[:, :3] = np.diag([1.0, -1.0, -1.0])
    return pose


def fold(
    urdf: Urdf, chain: Sequence[Joint], moving: Sequence[str], held: Mapping[str, float]
) -> Folded:
    """Fold away every joint but the moving ones of a chain: the others are held at their
    values, or at 0."""
    origins: list[Pose] = []
    in_chain = {joint.child for joint in chain}
    frames: dict[str, tuple[int, Pose]] = {urdf.root: (0, identity())}
    for joint in chain:
        index, pose = frames[joint.parent]
        here = compose(pose, joint.origin)
        if joint.name not in moving:
            motion = joint_motion(joint, held.get(joint.name, 0.0))
            frames[joint.child] = (index, compose(here, motion))
        else:
            align = _align_z(joint.axis)
            origins.append(compose(here, align))
            frames[joint.child] = (len(origins), invert(align))
    pending = [joint for joint in urdf.joints.values() if joint.child not in in_chain]
    while pending:
        ready = [joint for joint in pending if joint.parent in frames]
        for joint in ready:
            index, pose = frames[joint.parent]
            motion = joint_motion(joint, held.get(joint.name, 0.0))
            frames[joint.child] = (index, compose(compose(pose, joint.origin), motion))
        pending = [joint for joint in pending if joint not in ready]
    return Folded(np.array(origins).reshape(-1, 3, 4), frames)
