"""A gripper whose fingers slide or turn: how far its pads are apart at which joint values.

Fingers close along y of the tool frame and approach along x. All finger joints move together,
from their closed to their open ends; joints that mimic others follow. The opening is measured
at the pads: the foremost part of the foremost link on either side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runtime.robot.outline import points_of
from runtime.robot.tree import joint_motion, link_poses, with_mimics
from runtime.robot.urdf import MOVING, Joint, Urdf
from runtime.world.poses import Pose, compose, invert
from runtime.world.solids import Floats

PAD = 0.02
"""Metres from the tips of the fingers in which the pads are looked for."""

SAME_REACH = 0.005
"""Metres by which links that make up a pad may differ in how far they reach."""

SAMPLES = 33
"""Openings that are measured where fingers turn; sliding fingers need two."""


@dataclass(frozen=True, eq=False)
class Gripper:
    """A parallel gripper. Fingers close along y of the tool frame and approach along x.

    `fingers` are (index of the part, side: +1 or -1 along y). `openings` (k,) rise from the
    least to the largest distance of the pads in metres, `values` (k, m) are those of the
    `joints` there; in between both are interpolated. `links` are the links that may touch what
    is held. Limits that are not known are None: `max_force` in N along the closing direction,
    `max_torque` in N m about it, `payload` in kg. `opens_fully`: it knows no width in between, as
    pneumatic grippers do not.
    """

    fingers: tuple[tuple[int, float], ...]
    clearance: float
    time: float
    links: frozenset[str]
    joints: tuple[str, ...]
    openings: Floats
    values: Floats
    max_force: float | None = None
    max_torque: float | None = None
    payload: float | None = None
    opens_fully: bool = False

    @property
    def min_opening(self) -> float:
        """Metres between the pads when closed as far as they go."""
        return float(self.openings[0])

    @property
    def max_opening(self) -> float:
        """Metres between the pads when open as far as they go."""
        return float(self.openings[-1])

    def opening_for(self, width: float) -> float:
        """Metres between the pads before they close on something of a width."""
        if self.opens_fully:
            return self.max_opening
        return min(width + 2 * self.clearance, self.max_opening)

    def joint_values(self, opening: float | Floats) -> dict[str, Floats]:
        """Values of the finger joints for one opening or an array of them."""
        return {
            name: np.asarray(np.interp(opening, self.openings, self.values[:, i]))
            for i, name in enumerate(self.joints)
        }


class Hand:
    """The moving part of a gripper while it is being described: joints, links, geometry.

    `driven` are the joints that have a motor; what mimics them belongs to the hand too.
    """

    def __init__(self, urdf: Urdf, tool: str, driven: Sequence[str]) -> None:
        last = [joint.child for joint in urdf.chain(tool) if joint.type in MOVING][-1:]
        if last:  # the gripper hangs on the last link of the arm: leave the rest out
            names = {joint.name for joint in urdf.part(last[0]).joints.values()}
            if names.issuperset(driven):
                urdf = urdf.part(last[0])
        self.urdf = urdf
        self.tool = tool
        self.driven = [j for j in map(urdf.joint, driven) if j is not None and j.mimic is None]
        moved = with_mimics(urdf, dict.fromkeys(driven, 0.0))
        self.joints = [joint for joint in urdf.joints.values() if joint.name in moved]
        self.links = sorted({link for joint in self.joints for link in urdf.below(joint.child)})

    def poses(self, values: Mapping[str, float]) -> dict[str, Pose]:
        """Poses of all links in the tool frame for values of the driven joints."""
        found = link_poses(self.urdf, with_mimics(self.urdf, values))
        back = invert(found[self.tool])
        return {link: compose(back, pose) for link, pose in found.items()}

    def points(self, values: Mapping[str, float]) -> dict[str, Floats]:
        """Outlines of the links that move with the fingers, in the tool frame."""
        poses = self.poses(values)
        return {
            link: np.vstack([points_of(shape, poses[link]) for shape in self.urdf.shapes[link]])
            for link in self.links
            if self.urdf.shapes[link]
        }

    def ends(self) -> tuple[dict[str, float], dict[str, float]]:
        """Values of the driven joints at their closed and their open ends: each joint is open
        at that limit at which the links that it moves are further from the middle."""
        closed: dict[str, float] = {}
        opened: dict[str, float] = {}
        middle = {j.name: (j.lower + j.upper) / 2 for j in self.driven}
        for joint in self.driven:
            low, high = (
                self._spread(joint, {**middle, joint.name: value})
                for value in (joint.lower, joint.upper)
            )
            ends = (joint.lower, joint.upper) if high >= low else (joint.upper, joint.lower)
            closed[joint.name], opened[joint.name] = ends
        return closed, opened

    def _spread(self, joint: Joint, values: Mapping[str, float]) -> float:
        """How far the links that a joint moves, with those that follow, are from the middle."""
        moved = with_mimics(self.urdf, {joint.name: 0.0}).keys()
        links = {link for j in self.joints if j.name in moved for link in self.urdf.below(j.child)}
        clouds = self.points(values)
        return sum(abs(float(clouds[link][:, 1].mean())) for link in links & clouds.keys())

    def sides(self) -> dict[str, float]:
        """On which side of the middle each link with a shape is when open: 1.0 or -1.0."""
        clouds = self.points(self.ends()[1])
        return {link: 1.0 if cloud[:, 1].mean() > 0 else -1.0 for link, cloud in clouds.items()}

    def table(self) -> tuple[Floats, Floats]:
        """Openings (k,), strictly rising, and the values (k, m) of all finger joints there.

        Raises:
            ValueError: there are no pads on both sides, or they do not move apart.
        """
        closed, opened = self.ends()
        sides = self.sides()
        if set(sides.values()) != {1.0, -1.0}:
            raise ValueError("no finger with a shape on either side of the tool")
        sliding = all(joint.type == "prismatic" for joint in self.joints)
        found: list[tuple[float, list[float]]] = []
        for share in np.linspace(0.0, 1.0, 5 if sliding else SAMPLES).tolist():
            values = {name: closed[name] + share * (opened[name] - closed[name]) for name in closed}
            left, right = pads(self.points(values), sides)
            opening = gap(left) + gap(right)
            every = with_mimics(self.urdf, values)
            entry = (round(opening, 9) + 0.0, [every[joint.name] for joint in self.joints])
            if found and entry[0] <= found[-1][0]:
                if found[-1][0] > 0 and entry[0] < found[-1][0]:
                    break  # beyond the widest opening, pads that turn come closer again
                continue
            found.append(entry)
        if len(found) < 2 or found[-1][0] <= 0:
            raise ValueError("the pads do not move apart")
        openings = np.array([opening for opening, _ in found])
        values_ = np.array([entry for _, entry in found])
        if openings[0] < 0:  # pads that would overlap touch at 0
            first = np.array([np.interp(0.0, openings, column) for column in values_.T])
            keep = openings > 0
            openings = np.concatenate([[0.0], openings[keep]])
            values_ = np.vstack([first, values_[keep]])
        if sliding:
            return openings[[0, -1]], values_[[0, -1]]
        return openings, values_


def pads(
    points: Mapping[str, Floats], sides: Mapping[str, float]
) -> tuple[list[Floats], list[Floats]]:
    """The foremost parts of the finger links on the left (y > 0) and on the right, mirrored to
    the left: points of each link not further than `PAD` behind the tips."""
    found: list[list[Floats]] = []
    for sign in (1.0, -1.0):
        clouds = [points[link] for link, side in sides.items() if side == sign]
        reach = max(float(cloud[:, 0].max()) for cloud in clouds)
        found.append(
            [
                _front(cloud, reach - PAD) * (1.0, sign, 1.0)
                for cloud in clouds
                if cloud[:, 0].max() > reach - SAME_REACH
            ]
        )
    return found[0], found[1]


def gap(side: Sequence[Floats]) -> float:
    """How far the pads of a side, mirrored to the left, are from the middle."""
    return float(min(cloud[:, 1].min() for cloud in side))


def _front(cloud: Floats, level: float) -> Floats:
    """What of the hull of points has x of at least a level: corners and cut edges."""
    ahead = cloud[:, 0] >= level
    front, behind = cloud[ahead], cloud[~ahead]
    if not len(behind):
        return front
    share = (front[:, None, 0] - level) / (front[:, None, 0] - behind[None, :, 0])
    cuts = front[:, None] + share[:, :, None] * (behind[None] - front[:, None])
    return np.vstack([front, cuts.reshape(-1, 3)])


@dataclass(frozen=True, eq=False)
class FingerPart:
    """How one part of a finger moves: its joints from the last frame of the chain outwards,
    each with the pose of the frame before, and the part's pose after the last of them."""

    part: int
    steps: tuple[tuple[Pose, Joint, int], ...]
    tip: Pose

    def pose(self, values: Floats) -> Pose:
        """Pose in the last frame of the chain for values of the gripper's joints."""
        pose = None
        for origin, joint, column in self.steps:
            here = origin if pose is None else compose(pose, origin)
            pose = compose(here, joint_motion(joint, float(values[column])))
        return self.tip if pose is None else compose(pose, self.tip)
