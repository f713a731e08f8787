"""`trajectory_msgs/msg/JointTrajectory` of a trace, as plain data."""

from __future__ import annotations

from typing import Any

import numpy as np

from runtime.robot.model import Floats
from runtime.trace.model import Trace, TraceRobot
from runtime.trace.track import Track
from runtime.trace.write_world import rounded

NANO = 1_000_000_000


def trajectories(trace: Trace) -> dict[str, Any]:
    """Messages by name: `arm` for lift and arm, `gripper` for the finger joints.

    Points have positions and velocities: between two of them, a controller that follows the
    cubic through both (as ROS 2's joint trajectory controller does) moves as the trace does.
    """
    fingers = trace.robot.fingers
    opening = trace.opening
    values, velocities = finger_motion(trace.robot, opening.values[:, 0], opening.velocities[:, 0])
    finger_track = Track(opening.times, values, velocities)
    return {
        "arm": joint_trajectory(trace.robot.joints, trace.joints),
        "gripper": joint_trajectory(fingers, finger_track),
    }


def finger_motion(robot: TraceRobot, opening: Floats, speed: Floats) -> tuple[Floats, Floats]:
    """Values and velocities (k, m) of the finger joints for openings (k,) that change at some
    speed (k,)."""
    step = 1e-4
    values = robot.finger_values(opening)
    low = robot.finger_values(opening - step)
    high = robot.finger_values(opening + step)
    # At the ends of the table the joints stop on one side: the slope is that of the other.
    span = np.clip(opening + step, *robot.openings[[0, -1]]) - np.clip(
        opening - step, *robot.openings[[0, -1]]
    )
    slope = (high - low) / np.maximum(span, 1e-9)[..., None]
    return values, slope * np.asarray(speed)[..., None]


def joint_trajectory(names: tuple[str, ...], track: Track) -> dict[str, Any]:
    """One message, with the fields of its definition."""
    return {
        "header": {"stamp": stamp(0.0), "frame_id": ""},
        "joint_names": list(names),
        "points": [
            {
                "positions": rounded(values),
                "velocities": rounded(velocities),
                "accelerations": [],
                "effort": [],
                "time_from_start": stamp(float(time)),
            }
            for time, values, velocities in zip(
                track.times, track.values, track.velocities, strict=True
            )
        ],
    }


def stamp(time: float) -> dict[str, int]:
    """Seconds as ROS has them."""
    total = round(time * NANO)
    return {"sec": total // NANO, "nanosec": total % NANO}


def track_of(message: dict[str, Any]) -> Track:
    """The track of a message, as a controller reads it."""
    points = message["points"]

    def column(key: str) -> Floats:
        return np.array([point[key] for point in points], dtype=np.float64)

    times = [p["time_from_start"]["sec"] + p["time_from_start"]["nanosec"] / NANO for p in points]
    return Track(np.array(times), column("positions"), column("velocities"))
