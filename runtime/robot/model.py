"""A mobile manipulator as the planner sees it: a chain, its boxes, a gripper, a base."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runtime.kernels import arm
from runtime.kernels.convex import EXACT, NO_SHAPES, Shapes
from runtime.robot.urdf import Box, Urdf
from runtime.world.poses import Pose, compose

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Chain(NamedTuple):
    """Arrays of a serial chain, as `runtime.kernels.arm` takes them."""

    origins: Floats  # (n, 3, 4)
    prismatic: NDArray[np.bool_]  # (n,)


class Body(NamedTuple):
    """Parts fixed to the frames of a chain, as `runtime.kernels.arm` takes them: a box around
    each, and the index of its shape, or `runtime.kernels.convex.EXACT` for a box."""

    frame: Ints  # (m,)
    pose: Floats  # (m, 3, 4)
    half: Floats  # (m, 3)
    radius: Floats  # (m,)
    pairs: Ints  # (k, 2)
    shape: Ints  # (m,)
    shapes: Shapes


HELD_EXTENT = 0.3
"""Metres from the tool frame to the farthest corner of a held object, at most."""


@dataclass(frozen=True)
class PlacedBox:
    """A collision box, the frame it moves with and the link it belongs to."""

    link: str
    frame: int
    box: Box


@dataclass(frozen=True)
class Gripper:
    """A parallel gripper. Fingers close along y of the tool frame and approach along x.

    `fingers` are (box index, direction of opening along y: +1 or -1). Lengths in metres.
    """

    fingers: tuple[tuple[int, float], ...]
    max_opening: float
    clearance: float
    time: float
    links: frozenset[str]
    joints: tuple[str, ...]


@dataclass(frozen=True)
class MobileBase:
    """Speed limits of a differential-drive base, m/s, m/s^2, rad/s, rad/s^2."""

    velocity: float
    acceleration: float
    angular_velocity: float
    angular_acceleration: float


@dataclass(frozen=True)
class ArmWorkspace:
    """The annulus of InArmWorkspace (paper, Executability) around the shoulder axis, in the
    base frame. It bounds the wrist, `wrist_offset` behind the grasp centre. Metres."""

    centre: tuple[float, float]
    wrist_offset: float
    inner: float
    outer: float


@dataclass(frozen=True)
class Strip:
    """What a horizontal approach sweeps in the plane, from the grasp centre: metres.

    Fingers from `finger_back` behind to `finger_tip` in front, `finger_width` wide on each
    side of the object; behind them palm, wrist and forearm to `arm_length`.
    """

    finger_back: float
    finger_tip: float
    finger_width: float
    arm_length: float
    arm_half_width: float


@dataclass(frozen=True, eq=False)
class RobotModel:
    """A robot: planning joints (lift and arm) in chain order, boxes, gripper, base.

    `tool` is the grasp frame in the last frame of the chain. `home` is the posture in which
    the robot drives. Limits in rad or m, velocities and accelerations a second. `ignored`
    are pairs of links that may touch, `fixed` the values of movable joints outside the
    planning group, `urdf_tool` the link whose frame is the tool.
    """

    name: str
    joints: tuple[str, ...]
    lower: Floats
    upper: Floats
    velocity: Floats
    acceleration: Floats
    chain: Chain
    tool: Pose
    boxes: tuple[PlacedBox, ...]
    pairs: tuple[tuple[int, int], ...]
    gripper: Gripper
    base: MobileBase
    workspace: ArmWorkspace
    strip: Strip
    home: Floats
    ignored: frozenset[frozenset[str]]
    fixed: dict[str, float]
    urdf: Urdf
    urdf_tool: str
    digest: str

    def body(self, opening: float, held: Box | None = None) -> Body:
        """The robot's boxes with the fingers `opening` metres apart, holding a box or not.

        The held box is given in the tool frame. It may touch the gripper, nothing else.
        """
        frames = [b.frame for b in self.boxes]
        poses = [b.box.pose for b in self.boxes]
        halves = [b.box.half for b in self.boxes]
        pairs = list(self.pairs)
        for index, direction in self.gripper.fingers:
            poses[index] = self._finger_pose(index, direction * opening / 2)
        if held is not None:
            last = len(self.joints)
            pairs += [
                (i, len(frames))
                for i, placed in enumerate(self.boxes)
                if placed.link not in self.gripper.links
            ]
            frames.append(last)
            poses.append(compose(self.tool, held.pose))
            halves.append(held.half)
        half = np.array(halves)
        return Body(
            np.array(frames, dtype=np.int64),
            np.array(poses),
            half,
            np.linalg.norm(half, axis=1),
            np.array(pairs, dtype=np.int64).reshape(-1, 2),
            np.full(len(frames), EXACT),
            NO_SHAPES,
        )

    def _finger_pose(self, index: int, offset: float) -> Pose:
        pose = self.boxes[index].box.pose.copy()
        pose[:, 3] += self.tool[:, 1] * offset
        return pose

    @cached_property
    def sweep(self) -> Floats:
        """How far any point of a frame's boxes, a held object included, moves at most for
        one unit (rad, m) of each planning joint, shape (n + 1, n); 0 for joints further out."""
        n = len(self.joints)
        lengths = np.linalg.norm(self.chain.origins[:, :, 3], axis=1)
        travel = np.maximum(np.abs(self.lower), np.abs(self.upper))
        extension = np.where(self.chain.prismatic, travel, 0.0)
        out = np.zeros((n + 1, n))
        for frame in range(1, n + 1):
            corners = [
                float(np.linalg.norm(placed.box.pose[:, 3]) + np.linalg.norm(placed.box.half))
                for placed in self.boxes
                if placed.frame == frame
            ]
            extent = max(corners, default=0.0)
            if frame == n:
                extent = max(extent, float(np.linalg.norm(self.tool[:, 3])) + HELD_EXTENT)
            for joint in range(frame):
                if self.chain.prismatic[joint]:
                    out[frame, joint] = 1.0
                else:
                    # From the joint along the chain to the frame, and on to its corners.
                    between = slice(joint + 1, frame)
                    out[frame, joint] = extent + float((lengths + extension)[between].sum())
        return out

    def frames(self, q: Floats) -> Floats:
        """Poses (n + 1, 3, 4) of all frames in the base frame."""
        out = np.empty((len(self.joints) + 1, 3, 4))
        arm.forward(self.chain.origins, self.chain.prismatic, q, out)
        return out

    def tool_pose(self, q: Floats) -> Pose:
        """Pose of the tool frame in the base frame."""
        return compose(self.frames(q)[-1], self.tool)
