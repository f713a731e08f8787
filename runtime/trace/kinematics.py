"""Where links and objects of a trace are at given times."""

from __future__ import annotations

import numpy as np

from runtime.robot.model import Floats
from runtime.robot.urdf import Joint
from runtime.trace.model import WORLD, Trace, TraceRobot


def matrix(pose: Floats) -> Floats:
    """A pose x, y, z, quaternion x, y, z, w (7,) as a matrix (4, 4)."""
    x, y, z, w = pose[3:]
    out = np.eye(4)
    out[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    out[:3, 3] = pose[:3]
    return out


def pose_of(transform: Floats) -> Floats:
    """A rigid transform (4, 4) or (3, 4) as x, y, z, quaternion x, y, z, w (7,)."""
    r = transform[:3, :3]
    # The largest of the four squares: none of the divisions is by something small.
    squares = np.array(
        [
            1 + r[0, 0] - r[1, 1] - r[2, 2],
            1 - r[0, 0] + r[1, 1] - r[2, 2],
            1 - r[0, 0] - r[1, 1] + r[2, 2],
            1 + r[0, 0] + r[1, 1] + r[2, 2],
        ]
    )
    rows = [
        [squares[0], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]],
        [r[0, 1] + r[1, 0], squares[1], r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]],
        [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], squares[2], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], squares[3]],
    ]
    quaternion = np.array(rows[int(squares.argmax())])
    quaternion /= np.linalg.norm(quaternion)
    if quaternion[3] < 0:
        quaternion = -quaternion
    return np.concatenate([transform[:3, 3], quaternion])


class Tree:
    """The links of a robot in an order in which parents come first."""

    def __init__(self, robot: TraceRobot) -> None:
        self.robot = robot
        self.order: list[Joint] = []
        reached, pending = {robot.urdf.root}, list(robot.urdf.joints.values())
        while pending:
            ready = [joint for joint in pending if joint.parent in reached]
            self.order += ready
            reached |= {joint.child for joint in ready}
            pending = [joint for joint in pending if joint not in ready]

    def links(self, base: Floats, joints: Floats, opening: float) -> dict[str, Floats]:
        """World poses (4, 4) of all links for a base pose (3,), joint values (n,) and an
        opening of the gripper."""
        values = dict(self.robot.fixed)
        values.update(zip(self.robot.joints, joints.tolist(), strict=True))
        values.update(dict.fromkeys(self.robot.fingers, opening / len(self.robot.fingers)))
        c, s = np.cos(base[2]), np.sin(base[2])
        root = np.array([[c, -s, 0, base[0]], [s, c, 0, base[1]], [0, 0, 1.0, 0], [0, 0, 0, 1.0]])
        found = {self.robot.urdf.root: root}
        for joint in self.order:
            here = found[joint.parent] @ np.vstack([joint.origin, [0, 0, 0, 1.0]])
            value = values.get(joint.name, 0.0)
            found[joint.child] = here @ joint_motion(joint, value) if value else here
        return found


def joint_motion(joint: Joint, value: float) -> Floats:
    """What a joint does to its child (4, 4) at a value."""
    motion = np.eye(4)
    if joint.type == "prismatic":
        motion[:3, 3] = value * joint.axis
    elif joint.type != "fixed":
        x, y, z = joint.axis
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        motion[:3, :3] += np.sin(value) * cross + (1 - np.cos(value)) * (cross @ cross)
    return motion


def links_at(trace: Trace, tree: Tree, time: float) -> dict[str, Floats]:
    """World poses (4, 4) of the robot's links at a time."""
    now = np.array([time])
    base, joints, opening = (
        track.at(now)[0][0] for track in (trace.base, trace.joints, trace.opening)
    )
    return tree.links(base, joints, float(opening[0]))


def object_at(trace: Trace, links: dict[str, Floats], index: int, time: float) -> Floats:
    """World pose (4, 4) of the middle of an object's bottom at a time."""
    span = trace.span(index, time)
    local = matrix(span.at(time))
    return local if span.frame == WORLD else links[span.frame] @ local
