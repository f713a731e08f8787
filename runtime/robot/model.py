"""A robot as the planner sees it: a chain, its parts, a gripper, a base."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runtime.kernels import arm
from runtime.kernels.convex import EXACT, NO_SHAPES, Shapes
from runtime.robot.approach import USUAL, Approach, Derived, Family
from runtime.robot.controllers import Controller
from runtime.robot.gripper import FingerPart, Gripper
from runtime.robot.shapes import Shape
from runtime.robot.urdf import Box, Urdf
from runtime.world import solids
from runtime.world.body import Part
from runtime.world.packed import pack_shapes
from runtime.world.poses import Pose, compose
from runtime.world.solids import Solid

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


BOLTED = 5e-3
"""Metres that the foot of a fixed robot may be deep in what it is bolted to: meshes do not end
exactly at the plane that they are mounted on."""


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


JERK = 20.0
"""Where a robot file gives no jerk it is so many times the acceleration a second: full
acceleration within a twentieth of a second."""

OPENINGS = 256
"""Openings of the fingers for which the poses of their parts are remembered; as many bodies that
hold something are."""

HELD_EXTENT = 0.3
"""Metres from the tool frame to the farthest corner of a held object, at most."""


@dataclass(frozen=True, eq=False)
class PlacedShape:
    """A collision shape in the frame it moves with, and the link it belongs to. Fingers are at
    their closed ends."""

    link: str
    frame: int
    shape: Shape


@dataclass(frozen=True)
class MobileBase:
    """How the base moves: `"differential"` (turns and straight lines), `"holonomic"` (any
    direction at any heading) or `"fixed"`; speed limits in m/s, m/s^2, rad/s, rad/s^2, m/s^3 and
    rad/s^3, all 0 for a fixed one."""

    velocity: float
    acceleration: float
    angular_velocity: float
    angular_acceleration: float
    type: str = "differential"
    jerk: float = 0.0
    angular_jerk: float = 0.0


@dataclass(frozen=True, eq=False)
class RobotModel:
    """A robot: planning joints (lift and arm) in chain order, its parts, gripper, base.

    `tool` is the grasp frame in the last frame of the chain: x is the direction of approach,
    y the one in which the fingers close. `home` is the posture in which the robot drives.
    Limits in rad or m, velocities and accelerations a second. `pairs` are the parts that are
    tested against each other, `ignored` pairs of links that may touch, `fixed` the values of
    movable joints outside the planning group, `urdf_tool` the link whose frame is the tool.
    `derive` is asked once for what follows from all this. `controllers` move the real robot.
    `source` is what the robot was asked for by: its name, or the path of its file.
    """

    name: str
    joints: tuple[str, ...]
    lower: Floats
    upper: Floats
    velocity: Floats
    acceleration: Floats
    jerk: Floats
    chain: Chain
    tool: Pose
    parts: tuple[PlacedShape, ...]
    pairs: tuple[tuple[int, int], ...]
    gripper: Gripper
    finger_parts: tuple[FingerPart, ...]
    base: MobileBase
    home: Floats
    ignored: frozenset[frozenset[str]]
    fixed: dict[str, float]
    urdf: Urdf
    urdf_tool: str
    digest: str
    derive: Callable[[RobotModel, tuple[Family, ...]], Derived]
    controllers: tuple[Controller, ...] = ()
    source: str = ""

    @cached_property
    def derived(self) -> Derived:
        """What kinematics says of the robot."""
        return self.derive(self, USUAL)

    @cached_property
    def _aslant(self) -> Derived:
        """The same of hands that come aslant, which few scenes ask for."""
        return self.derive(self, (Family.SLANT,))

    def approach(self, family: Family) -> Approach:
        """What a hand that comes in by a family sweeps."""
        derived = self.derived if family in USUAL else self._aslant
        return derived.approaches[family]

    def workspace(self, family: Family, height: float) -> tuple[float, float, float]:
        """How far the wrist has to be from the shoulder's axis for a grasp centre at a height
        above the floor, at least and at most, and how far behind the grasp centre it is. The
        interval is empty (0, 0) where there is none."""
        derived = self.derived if family in USUAL else self._aslant
        return derived.workspaces[family].at(height)

    @property
    def centre(self) -> tuple[float, float]:
        """The shoulder's axis in the base frame, x and y."""
        return self.derived.centre

    def body(self, opening: float, held: Box | Sequence[Part] | None = None) -> Body:
        """The robot's parts with the fingers `opening` metres apart, holding something or not.

        What is held is given in the tool frame, as a box or as the solids of a body. It may
        touch the gripper, nothing else.
        """
        own, poses = self._own, self._opened.get(opening)
        if poses is None:
            poses = own.pose.copy()
            values = np.array([*self.gripper.joint_values(opening).values()])
            for finger in self.finger_parts:
                poses[finger.part] = finger.pose(values)
            if len(self._opened) < OPENINGS:
                self._opened[opening] = poses
        more = _held_parts(held)
        if not more:
            return own._replace(pose=poses)
        key = (opening, *((part.solid, part.pose.tobytes()) for part in more))
        if key not in self._holding:
            self._holding[key] = self._with(poses, more)
            if len(self._holding) > OPENINGS:
                self._holding.popitem(last=False)
        return self._holding[key]

    def _with(self, poses: Floats, more: Sequence[Part]) -> Body:
        """The body whose own parts are at some poses, with parts that are held."""
        own = self._own
        n, count = len(self.parts), len(more)
        half = np.vstack([own.half, [part.solid.half for part in more]])
        apart = np.flatnonzero([part.link not in self.gripper.links for part in self.parts])
        pairs = [np.column_stack([apart, np.full(len(apart), n + i)]) for i in range(count)]
        shape, shapes = np.append(own.shape, np.full(count, EXACT)), own.shapes
        if not all(isinstance(part.solid, solids.Box) for part in more):
            shape, shapes = _pack([p.shape.solid for p in self.parts] + [p.solid for p in more])
        return Body(
            np.append(own.frame, np.full(count, len(self.joints))),
            np.concatenate([poses, [compose(self.tool, part.pose) for part in more]]),
            half,
            np.linalg.norm(half, axis=1),
            np.vstack([own.pairs, *pairs]),
            shape,
            shapes,
        )

    @cached_property
    def _opened(self) -> dict[float, Floats]:
        """The poses of the robot's own parts for openings that were asked for."""
        return {}

    @cached_property
    def _holding(self) -> OrderedDict[object, Body]:
        """Bodies that hold something, for questions that were asked."""
        return OrderedDict()

    @cached_property
    def _own(self) -> Body:
        """The robot's own parts, fingers closed."""
        half = np.array([part.shape.solid.half for part in self.parts])
        return Body(
            np.array([part.frame for part in self.parts], dtype=np.int64),
            np.array([part.shape.pose for part in self.parts]),
            half,
            np.linalg.norm(half, axis=1),
            np.array(self.pairs, dtype=np.int64).reshape(-1, 2),
            *_pack([part.shape.solid for part in self.parts]),
        )

    @cached_property
    def ease(self) -> Floats:
        """How readily each joint (n,) moves: its speed, as a share of that of the fastest."""
        eases: Floats = self.velocity / self.velocity.max()
        return eases

    @cached_property
    def sweep(self) -> Floats:
        """How far any point of a frame's parts, a held object included, moves at most for
        one unit (rad, m) of each planning joint, shape (n + 1, n); 0 for joints further out."""
        n = len(self.joints)
        lengths = np.linalg.norm(self.chain.origins[:, :, 3], axis=1)
        travel = np.maximum(np.abs(self.lower), np.abs(self.upper))
        extension = np.where(self.chain.prismatic, travel, 0.0)
        out = np.zeros((n + 1, n))
        for frame in range(1, n + 1):
            corners = [
                self.reach_of(i, part) for i, part in enumerate(self.parts) if part.frame == frame
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

    def reach_of(self, index: int, part: PlacedShape) -> float:
        """How far a part reaches from the origin of its frame; a finger at any opening."""
        places = [part.shape.pose]
        for finger in self.finger_parts:
            if finger.part == index:
                places = [finger.pose(values) for values in self.gripper.values]
        away = max(float(np.linalg.norm(pose[:, 3])) for pose in places)
        return away + float(np.linalg.norm(part.shape.half))

    def frames(self, q: Floats) -> Floats:
        """Poses (n + 1, 3, 4) of all frames in the base frame."""
        out = np.empty((len(self.joints) + 1, 3, 4))
        arm.forward(self.chain.origins, self.chain.prismatic, q, out)
        return out

    def tool_pose(self, q: Floats) -> Pose:
        """Pose of the tool frame in the base frame."""
        return compose(self.frames(q)[-1], self.tool)


def _held_parts(held: Box | Sequence[Part] | None) -> Sequence[Part]:
    """What is held as solids in the tool frame."""
    if isinstance(held, Box):
        x, y, z = (2 * held.half).tolist()
        return [Part(solids.Box((x, y, z)), held.pose)]
    return held or []


def _pack(those: Sequence[Solid]) -> tuple[Ints, Shapes]:
    """The index of each solid in a table of those that are no boxes, and the table."""
    index = np.full(len(those), EXACT)
    others = [i for i, solid in enumerate(those) if not isinstance(solid, solids.Box)]
    if not others:
        return index, NO_SHAPES
    index[others] = np.arange(len(others))
    return index, pack_shapes([those[i] for i in others])
