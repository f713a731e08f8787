"""What one controller is to do between two times: the goal of its action, as plain data.

Messages have the fields of their ROS 2 definitions; fields that are left out have their defaults.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from runtime.export.messages import finger_motion, joint_trajectory, stamp
from runtime.robot.controllers import Controller
from runtime.robot.model import Floats
from runtime.trace.model import Trace, TraceRobot
from runtime.trace.track import Track

OFF = 2e-4
"""Metres by which a base path may cut its corners, and radians for headings."""

UNMOVED = 1e-6
"""rad or m: who is to move less gets no goal."""

TYPES = {
    "FollowJointTrajectory": "control_msgs/action/FollowJointTrajectory",
    "GripperCommand": "control_msgs/action/GripperCommand",
    "FollowPath": "nav2_msgs/action/FollowPath",
    "NavigateToPose": "nav2_msgs/action/NavigateToPose",
}
"""The ROS 2 type of each kind of controller's action."""


@dataclass(frozen=True, eq=False)
class Goal:
    """A goal for a controller: the message, and the motion that it stands for, from time 0 on:
    values of the controller's joints, or x, y, heading of the base."""

    controller: Controller
    message: dict[str, Any]
    motion: Track

    @property
    def type(self) -> str:
        """The ROS 2 type of the action."""
        return TYPES[self.controller.type]


def goal_of(
    trace: Trace, controller: Controller, start: float, end: float, frame: str
) -> Goal | None:
    """What a controller has to do from `start` to `end`, times at which it rests; None if that
    is nothing. `frame` is the frame of base poses."""
    if controller.moves_base:
        motion = sliced(trace.base, start, end)
    else:
        tracks = [joint_track(trace, name) for name in controller.joints]
        motion = _beside([sliced(track, start, end) for track in tracks])
    if np.abs(motion.values - motion.values[0]).max() <= UNMOVED:
        return None
    return Goal(controller, message_of(controller, motion, trace.robot, frame), motion)


def message_of(
    controller: Controller, motion: Track, robot: TraceRobot, frame: str
) -> dict[str, Any]:
    """The goal message of a controller for a motion."""
    match controller.type:
        case "FollowJointTrajectory":
            return {"trajectory": joint_trajectory(controller.joints, motion)}
        case "GripperCommand":
            position = round(float(motion.values[-1, 0]), 6)
            return {"command": {"position": position, "max_effort": robot.max_force or 0.0}}
        case "FollowPath":
            return {
                "path": path_message(motion, frame),
                "controller_id": "",
                "goal_checker_id": "",
            }
        case _:
            last = pose_message(motion.values[-1], float(motion.times[-1]), frame)
            return {"pose": last, "behavior_tree": ""}


def joint_track(trace: Trace, name: str) -> Track:
    """One joint over time: planned for, of a finger, or held."""
    robot = trace.robot
    if name in robot.joints:
        i = robot.joints.index(name)
        track = trace.joints
        return Track(track.times, track.values[:, i : i + 1], track.velocities[:, i : i + 1])
    if name in robot.fingers:
        i, track = robot.fingers.index(name), trace.opening
        times = _with_bends(track, robot)
        opening, speed = track.at(times)
        values, velocities = finger_motion(robot, opening[:, 0], speed[:, 0])
        return Track(times, values[:, i : i + 1], velocities[:, i : i + 1])
    held = np.array([[robot.fixed.get(name, 0.0)]])
    return Track(np.zeros(1), held, np.zeros((1, 1)))


def _with_bends(track: Track, robot: TraceRobot) -> Floats:
    """The knots of the opening, and others in between where fingers do not just slide: there
    the joints' motion is no cubic."""
    share = (robot.openings - robot.openings[0]) / np.ptp(robot.openings)
    table = robot.finger_table
    straight = table[0] + share[:, None] * (table[-1] - table[0])
    if len(track.times) == 1 or np.abs(table - straight).max() < 1e-6:
        return track.times
    pieces = [
        np.linspace(a, b, 17)[:-1] for a, b in zip(track.times[:-1], track.times[1:], strict=True)
    ]
    return np.append(np.concatenate(pieces), track.times[-1])


def sliced(track: Track, start: float, end: float) -> Track:
    """A track between two times at which it rests, from time 0 on."""
    inside = (track.times > start + 1e-6) & (track.times < end - 1e-6)
    times = np.concatenate([[start], track.times[inside], [end]])
    values, velocities = track.at(times)
    velocities[[0, -1]] = 0.0
    return Track(times - start, values, velocities)


def _beside(tracks: Sequence[Track]) -> Track:
    """Tracks of equal duration as the columns of one."""
    times = np.unique(np.concatenate([np.round(track.times, 6) for track in tracks]))
    both = [track.at(times) for track in tracks]
    velocities = np.hstack([v for _, v in both])
    velocities[[0, -1]] = 0.0
    return Track(times, np.hstack([p for p, _ in both]), velocities)


def path_message(motion: Track, frame: str) -> dict[str, Any]:
    """`nav_msgs/msg/Path`: poses stamped with their times from the start of the step. From one
    to the next, position and heading change evenly."""
    times = _samples(motion)
    values = motion.at(times)[0]
    return {
        "header": {"stamp": stamp(0.0), "frame_id": frame},
        "poses": [
            pose_message(value, time, frame)
            for value, time in zip(values, times.tolist(), strict=True)
        ],
    }


def _samples(motion: Track) -> Floats:
    """Times close enough together that straight lines between them are off by `OFF` at most."""
    found = [float(motion.times[0])]
    for i in range(1, len(motion.times)):
        a, b = float(motion.times[i - 1]), float(motion.times[i])
        h = b - a
        p, q = motion.values[i - 1], motion.values[i]
        u, v = motion.velocities[i - 1] * h, motion.velocities[i] * h
        # The second derivative of the cubic, over h^2, is largest at an end.
        bend = max(
            float(np.abs(6 * (q - p) - 4 * u - 2 * v).max()),
            float(np.abs(6 * (p - q) + 2 * u + 4 * v).max()),
        )
        # A line over a part 1/n of the interval is off by bend / 8 n^2.
        count = max(1, math.ceil(math.sqrt(bend / (8 * OFF))))
        found += np.linspace(a, b, count + 1)[1:].tolist()
    return np.array(found)


def pose_message(value: Floats, time: float, frame: str) -> dict[str, Any]:
    """`geometry_msgs/msg/PoseStamped` of x, y, heading."""
    x, y, heading = map(float, value)
    half = math.remainder(heading, 2 * math.pi) / 2
    return {
        "header": {"stamp": stamp(time), "frame_id": frame},
        "pose": {
            "position": {"x": round(x, 6), "y": round(y, 6), "z": 0.0},
            "orientation": {
                "x": 0.0,
                "y": 0.0,
                "z": round(math.sin(half), 9),
                "w": round(math.cos(half), 9),
            },
        },
    }
