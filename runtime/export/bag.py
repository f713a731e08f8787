"""A ROS 2 bag of a trace: joint states, and the poses of base and objects as transforms."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from runtime.export.messages import NANO, finger_motion
from runtime.robot.model import Floats
from runtime.trace.kinematics import Tree, links_at, object_at
from runtime.trace.model import WORLD, Trace
from runtime.world.quaternions import pose_of
from sketchlang.errors import InputError
from sketchlang.escape import visible
from sketchlang.files import new_folder

RATE = 20.0
"""Messages a second on each topic."""


def check_bag(path: Path) -> None:
    """Find out before the work whether a bag can be written.

    Raises:
        InputError: the path exists, or the package rosbags is missing.
    """
    if find_spec("rosbags") is None:
        raise InputError("bags need the package rosbags", hint="install sketchlang[bag]")
    if path.exists() or path.is_symlink():
        raise InputError("a bag is a new folder, and this exists", place=str(path))


def write_bag(trace: Trace, path: Path) -> None:
    """Write a bag, a folder that must not exist: `/joint_states` and `/tf`.

    It is written in a temporary folder beside and moved when it is complete.

    Raises:
        InputError: it exists, it cannot be written, or the package rosbags is missing.
    """
    check_bag(path)
    try:
        with new_folder(path) as folder:
            _write(trace, folder)
    except sqlite3.Error as error:
        raise InputError(f"cannot be written: {error}", place=str(path)) from None


def _write(trace: Trace, path: Path) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(path, version=8) as writer:
        connections = {
            topic: writer.add_connection(topic, kind, typestore=store)
            for topic, kind in (
                ("/joint_states", "sensor_msgs/msg/JointState"),
                ("/tf", "tf2_msgs/msg/TFMessage"),
            )
        }
        for time in _times(trace):
            for topic, message in _messages(trace, store.types, time):
                connection = connections[topic]
                data = store.serialize_cdr(message, connection.msgtype)
                writer.write(connection, round(time * NANO), data)


def _times(trace: Trace) -> Floats:
    return np.arange(0.0, trace.duration + 0.5 / RATE, 1 / RATE)


def _messages(trace: Trace, types: Any, time: float) -> Iterator[tuple[str, Any]]:
    total = round(time * NANO)
    stamp = types["builtin_interfaces/msg/Time"](total // NANO, total % NANO)
    header = types["std_msgs/msg/Header"]
    now = np.array([time])
    joints, speeds = (rows[0] for rows in trace.joints.at(now))
    opening, widening = (rows[0] for rows in trace.opening.at(now))
    fingers = trace.robot.fingers
    values, velocities = finger_motion(trace.robot, opening[0], widening[0])
    yield (
        "/joint_states",
        types["sensor_msgs/msg/JointState"](
            header(stamp, ""),
            [*trace.robot.joints, *fingers],
            np.concatenate([joints, values]),
            np.concatenate([speeds, velocities]),
            np.zeros(0),
        ),
    )
    tree = Tree(trace.robot)
    links = links_at(trace, tree, time)
    frames = {trace.robot.urdf.root: pose_of(links[trace.robot.urdf.root])}
    for index, thing in enumerate(trace.world.movables):
        frames[thing.name] = pose_of(object_at(trace, links, index, time))
    vector, quaternion = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]
    transform = types["geometry_msgs/msg/Transform"]
    stamped = types["geometry_msgs/msg/TransformStamped"]
    yield (
        "/tf",
        types["tf2_msgs/msg/TFMessage"](
            [
                stamped(
                    header(stamp, WORLD),
                    visible(name),
                    transform(vector(*map(float, pose[:3])), quaternion(*map(float, pose[3:]))),
                )
                for name, pose in frames.items()
            ]
        ),
    )
