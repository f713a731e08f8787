"""Where the gripper of a robot is: its joints, its links, and the frame of its tool."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runtime.robot.outline import points_of
from runtime.robot.tree import link_poses, with_mimics
from runtime.robot.urdf import MOVING, Joint, Urdf
from runtime.world.poses import Pose, apply, compose, invert
from runtime.world.solids import Floats

SNAP = 0.25
"""Radians by which a found axis may differ from one of the tool link or the palm to be taken
for it."""

TIP = 0.01
"""Metres by which links that make up the tips may differ in how far they reach."""

DEPTH = 0.015
"""Metres from the tips of the fingers back to the grasp centre."""

WITHIN = 0.025
"""The tool link's own origin is the grasp centre if it is not further behind the tips."""


@dataclass(frozen=True, eq=False)
class ProposedHand:
    """A gripper: the joints with a motor, the links that belong to it, and the pose (3, 4) of
    the tool frame in the tool link, None where it is the link's own frame."""

    fingers: tuple[str, ...]
    links: tuple[str, ...]
    tool: Pose | None


def wrist_links(urdf: Urdf, tool_link: str) -> tuple[str, ...]:
    """The links that move with the tool as one, from the last joint of the arm on."""
    joints = [joint for joint in urdf.chain(tool_link) if joint.type in MOVING]
    first = joints[-1].child if joints else urdf.root
    found = [first]
    for link in found:
        found += [
            joint.child
            for joint in urdf.joints.values()
            if joint.parent == link and joint.type not in MOVING
        ]
    return tuple(found)


def finger_joints(urdf: Urdf, tool_link: str) -> list[Joint]:
    """The joints beyond the arm's last one that move, but not on the way to the tool."""
    wrist = wrist_links(urdf, tool_link)
    below = urdf.below(wrist[0])
    return [j for j in urdf.joints.values() if j.parent in below and j.type in MOVING]


def propose_hand(urdf: Urdf, tool_link: str) -> ProposedHand | None:
    """The gripper at a tool link, or None where nothing moves there."""
    joints = finger_joints(urdf, tool_link)
    driven = tuple(joint.name for joint in joints if joint.mimic is None)
    if not driven:
        return None
    wrist = wrist_links(urdf, tool_link)
    moving = {link for joint in joints for link in urdf.below(joint.child)}
    on_hand = {joint.parent for joint in joints} & set(wrist)
    links = [link for link in (*wrist, *sorted(moving)) if link in moving | on_hand]
    return ProposedHand(driven, tuple(links), _tool_frame(urdf, tool_link, joints))


def _tool_frame(urdf: Urdf, tool_link: str, joints: Sequence[Joint]) -> Pose | None:
    middle = {j.name: (j.lower + j.upper) / 2 for j in joints if j.mimic is None}
    poses = link_poses(urdf, with_mimics(urdf, middle))
    back = invert(poses[tool_link])
    clouds = {
        link: np.vstack([points_of(s, compose(back, poses[link])) for s in urdf.shapes[link]])
        for joint in joints
        for link in urdf.below(joint.child)
        if urdf.shapes[link]
    }
    if len(clouds) < 2:
        return None
    start = apply(back, poses[wrist_links(urdf, tool_link)[0]][:, 3][None])[0]
    palms = {joint.parent for joint in joints if joint.parent in poses}
    axes = np.hstack([compose(back, poses[link])[:, :3] for link in (tool_link, *sorted(palms))])
    middle_of_all = np.mean([_middle(cloud) for cloud in clouds.values()], axis=0)
    forward = _snapped(middle_of_all - start, axes)
    reach = {link: float((cloud @ forward).max()) for link, cloud in clouds.items()}
    tips = [link for link in clouds if reach[link] > max(reach.values()) - TIP]
    if len(tips) < 2:
        tips = sorted(clouds, key=lambda link: -reach[link])[:2]
    middles = np.array([_middle(clouds[link]) for link in tips])
    apart = np.linalg.norm(middles[:, None] - middles[None], axis=2)
    i, j = np.unravel_index(int(apart.argmax()), apart.shape)
    side = middles[i] - middles[j]
    side = side - (side @ forward) * forward
    if np.linalg.norm(side) < 1e-6:
        return None
    side = _snapped(side, axes)
    side = side - (side @ forward) * forward
    side /= np.linalg.norm(side)
    rotation = np.column_stack([forward, side, np.cross(forward, side)])
    tip = min(reach[tips[i]], reach[tips[j]])
    centre = rotation.T @ ((middles[i] + middles[j]) / 2)
    own = 0.0 - tip  # the link's origin, seen from the tips
    near = abs(centre[1]) < 0.01 and abs(centre[2]) < 0.02
    if near and -WITHIN < own < -0.004:
        centre = np.zeros(3)
    else:
        centre[0] = tip - DEPTH
    pose = np.column_stack([rotation, rotation @ centre])
    return None if np.allclose(pose, np.eye(3, 4), atol=1e-6) else pose


def _middle(cloud: Floats) -> Floats:
    """The middle of the box around points."""
    middle: Floats = (cloud.min(axis=0) + cloud.max(axis=0)) / 2
    return middle


def _snapped(direction: Floats, axes: Floats) -> Floats:
    """A unit vector along a direction, or along that of some axes (3, k), either way, which is
    nearly the same."""
    unit: Floats = direction / np.linalg.norm(direction)
    along = unit @ axes
    best = int(np.abs(along).argmax())
    nearest: Floats = axes[:, best] * np.sign(along[best])
    return nearest if abs(along[best]) > np.cos(SNAP) else unit
