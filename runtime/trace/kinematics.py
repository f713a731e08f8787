"""Where links and objects of a trace are at given times."""

from __future__ import annotations

import numpy as np

from runtime.robot.model import Floats
from runtime.robot.urdf import Joint
from runtime.trace.model import WORLD, Trace, TraceRobot, span_at
from runtime.world.quaternions import matrix


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
        values.update(
            zip(
                self.robot.fingers,
                self.robot.finger_values(np.array(opening)).tolist(),
                strict=True,
            )
        )
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


def guided_at(trace: Trace, name: str, time: float) -> Floats:
    """World pose (4, 4) of a fixed thing at a time: where its guide was moved to."""
    spans = trace.guided.get(name)
    if spans is not None:
        return matrix(span_at(spans, time).at(time))
    thing = next(thing for thing in trace.world.fixed if thing.name == name)
    return np.vstack([thing.pose, [0.0, 0.0, 0.0, 1.0]])


def object_at(trace: Trace, links: dict[str, Floats], index: int, time: float) -> Floats:
    """World pose (4, 4) of the middle of an object's bottom at a time."""
    span = trace.span(index, time)
    local = matrix(span.at(time))
    return local if span.frame == WORLD else links[span.frame] @ local
