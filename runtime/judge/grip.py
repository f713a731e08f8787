"""Whether closed fingers hold a body, measured as the fingers feel it.

Lines parallel to the direction in which the fingers close (y of the tool frame) are shot from
finger to finger, a millimetre apart; each tells where a finger's face and the body's side are.
Nothing is assumed of the body or of the direction of the grasp.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from runtime.judge.extents import along_y, homogeneous
from runtime.judge.skeleton import LinkSolid, Skeleton
from runtime.judge.squeeze import FRICTION, Lines, Placed, slip_fault
from runtime.robot.model import RobotModel
from runtime.world.body import Body
from runtime.world.poses import Floats

STEP = 0.001
"""Metres between lines."""

EDGE = 0.00002
"""Metres from the edges of the fingers to the nearest lines."""

BEYOND = 0.005
"""Metres by which lines go beyond the edges of the fingers: how the faces go on that they touch."""

SNUG = 0.002
"""Metres by which a closed finger may be away from the body, or within it."""

GRAVITY = 9.81


def grip_fault(
    skeleton: Skeleton, opening: float, body: Body, name: str, in_tool: Floats
) -> str | None:
    """Why fingers that are `opening` metres apart do not hold a body at a pose (4, 4) in the
    tool frame, None where they do."""
    fingers = _fingers(skeleton, opening)
    left = [f for f in fingers if f[1][1, 3] > 0]
    right = [f for f in fingers if f[1][1, 3] <= 0]
    parts = [(part.solid, in_tool @ homogeneous(part.pose)) for part in body.parts]
    x, z = _lines(left, right)
    low, high = _between(parts, left, right, x, z)
    if not len(x) or not np.isfinite(low).any():
        return f"{name} is not between the fingers when they close"
    face_left, face_right = _interval(left, x, z)[0], _interval(right, x, z)[1]
    gaps = [float(_gap(face_left, high).min()), float(_gap(low, face_right).min())]
    if not np.isfinite(gaps).all():
        return f"{name} is not between the fingers when they close"
    wide, off = sum(gaps), abs(gaps[0] - gaps[1]) / 2
    if abs(wide) > 2 * SNUG:
        how = "narrower" if wide < 0 else "wider"
        return f"the closed fingers do not fit {name}: {1000 * abs(wide):.1f} mm {how}"
    if off > SNUG:
        return f"{name} is {1000 * off:.1f} mm off centre between the fingers"
    return slip_fault(Lines(*_lines(left, right, BEYOND), STEP), left, right, parts, name)


def _gap(far: Floats, near: Floats) -> Floats:
    both = np.isfinite(far) & np.isfinite(near)
    return np.where(both, np.where(both, far, 0.0) - np.where(both, near, 0.0), np.inf)


def load_fault(robot: RobotModel, mass: float, centre: Floats, down: Floats) -> str | None:
    """Why a load of `mass` kg is too much for the gripper; `centre` (3,), its centre of mass,
    and `down` (3,), where it is pulled to, are in the tool frame."""
    gripper = robot.gripper
    payload, force, torque = gripper.payload, gripper.max_force, gripper.max_torque
    if payload is not None and mass > payload:
        return f"{mass:.2f} kg are too heavy for the gripper ({payload:g} kg)"
    weight = mass * GRAVITY * down
    if force is not None and float(np.hypot(weight[0], weight[2])) > 2 * FRICTION * force:
        return f"{mass:.2f} kg slip through the fingers: they push with {force:g} N"
    turning = abs(float(np.cross(centre, weight)[1]))
    if torque is not None and turning > torque:
        return f"it turns between the fingers: {turning:.2f} N m, they bear {torque:g} N m"
    return None


def _fingers(skeleton: Skeleton, opening: float) -> list[Placed]:
    """The solids of the fingers and their poses (4, 4) in the tool frame."""
    robot = skeleton.robot
    links = skeleton.transforms(np.zeros((1, 3)), robot.home[None], opening)
    to_tool = np.linalg.inv(links[robot.urdf_tool][0])
    own: list[LinkSolid] = [s for s in skeleton.solids if s.link in skeleton.fingers]
    return [(s.solid, to_tool @ links[s.link][0] @ s.pose) for s in own]


def _lines(
    left: Sequence[Placed], right: Sequence[Placed], beyond: float = 0.0
) -> tuple[Floats, Floats]:
    """x and z (k,) of lines that may meet fingers on both sides, or pass them by so far."""
    boxes = [_around(side) for side in (left, right) if side]
    if len(boxes) < 2:
        return np.zeros(0), np.zeros(0)
    low = np.maximum(boxes[0][0], boxes[1][0])
    high = np.minimum(boxes[0][1], boxes[1][1])
    if np.any((high <= low)[[0, 2]]):
        return np.zeros(0), np.zeros(0)
    outside = STEP * np.arange(1, round(beyond / STEP) + 1)
    rows = []
    for i in (0, 2):
        # Not along the very edges, where rounding decides.
        count = max(3, math.ceil((high[i] - low[i]) / STEP))
        inside = np.linspace(low[i] + EDGE, high[i] - EDGE, count)
        rows.append(np.concatenate([low[i] - outside[::-1], inside, high[i] + outside]))
    x, z = np.meshgrid(*rows)
    return x.ravel(), z.ravel()


def _around(parts: Sequence[Placed]) -> tuple[Floats, Floats]:
    reach = [np.abs(pose[:3, :3]) @ np.array(solid.half) for solid, pose in parts]
    places = [pose[:3, 3] for _, pose in parts]
    low = np.min([p - r for p, r in zip(places, reach, strict=True)], axis=0)
    high = np.max([p + r for p, r in zip(places, reach, strict=True)], axis=0)
    return low, high


def _between(
    parts: Sequence[Placed],
    left: Sequence[Placed],
    right: Sequence[Placed],
    x: Floats,
    z: Floats,
) -> tuple[Floats, Floats]:
    """Where lines first enter and last leave solids, but for those that are beyond a finger:
    the other wall of a tray whose rim is held."""
    low, high = np.full(len(x), np.inf), np.full(len(x), -np.inf)
    beyond_left, beyond_right = _interval(left, x, z)[1], _interval(right, x, z)[0]
    for solid, pose in parts:
        enter, leave = along_y(solid, pose, x, z)
        counts = (enter <= beyond_left) & (leave >= beyond_right)
        low = np.where(counts, np.minimum(low, enter), low)
        high = np.where(counts, np.maximum(high, leave), high)
    return low, high


def _interval(parts: Sequence[Placed], x: Floats, z: Floats) -> tuple[Floats, Floats]:
    """Where lines first enter and last leave some solids."""
    found = [along_y(solid, pose, x, z) for solid, pose in parts]
    return np.min([a for a, _ in found], axis=0), np.max([b for _, b in found], axis=0)
