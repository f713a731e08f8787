"""A ROS 2 bag of a trace: all that RViz needs to show it, and what happens in it."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from runtime.export.description import description
from runtime.export.frames import Frames, transforms
from runtime.export.markers import markers
from runtime.export.messages import NANO, finger_motion, stamp
from runtime.export.typed import typed
from runtime.robot.model import Floats
from runtime.trace.model import Trace
from sketchlang.errors import InputError
from sketchlang.files import new_folder

TOPICS = {
    "/clock": "rosgraph_msgs/msg/Clock",
    "/joint_states": "sensor_msgs/msg/JointState",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/robot_description": "std_msgs/msg/String",
    "/markers": "visualization_msgs/msg/MarkerArray",
    "/events": "std_msgs/msg/String",
}

LATCHED = ("/tf_static", "/robot_description", "/markers")
"""Topics whose last message is there for whoever comes later."""

MARKERS_EVERY = 5.0
"""Seconds after which markers are said again: who starts in the middle of a bag sees them."""


@dataclass(frozen=True)
class BagOptions:
    """`rate`: messages a second on each topic of what moves; `frame`: the frame of the scene;
    `meshes`: a URI under which the robot's meshes are found, where that is not the bag itself."""

    rate: float = 20.0
    frame: str = "map"
    meshes: str | None = None


def check_bag(path: Path) -> None:
    """Find out before the work whether a bag can be written.

    Raises:
        InputError: the path exists, or the package rosbags is missing.
    """
    if find_spec("rosbags") is None:
        raise InputError("bags need the package rosbags", hint="install sketchlang[bag]")
    if path.exists() or path.is_symlink():
        raise InputError("a bag is a new folder, and this exists", place=str(path))


def write_bag(trace: Trace, path: Path, options: BagOptions | None = None) -> None:
    """Write a bag, a folder that must not exist, with the topics of `TOPICS`, and the robot's
    meshes in a folder of it.

    It is written in a temporary folder beside and moved when it is complete.

    Raises:
        InputError: it exists, it cannot be written, or the package rosbags is missing.
    """
    check_bag(path)
    options = options or BagOptions()
    folder_of_meshes = options.meshes or path.absolute().as_uri()
    text, files = description(trace.robot.urdf, folder_of_meshes.rstrip("/"))
    try:
        with new_folder(path) as folder:
            _write(trace, folder, options, text)
            for name, content in files.items() if options.meshes is None else ():
                target = folder / name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(content, encoding="utf-8")
    except sqlite3.Error as error:
        raise InputError(f"cannot be written: {error}", place=str(path)) from None


def _write(trace: Trace, path: Path, options: BagOptions, robot: str) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(path, version=8) as writer:
        connections = {
            topic: writer.add_connection(
                topic, kind, typestore=store, offered_qos_profiles=_qos(topic)
            )
            for topic, kind in TOPICS.items()
        }
        for time, topic, data in _messages(trace, options, robot):
            message = typed(store, TOPICS[topic], data)
            raw = store.serialize_cdr(message, TOPICS[topic])
            writer.write(connections[topic], round(time * NANO), raw)


def _qos(topic: str) -> list[Any]:
    """Latched topics keep their last message; the others are as publishers have them."""
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    if topic not in LATCHED:
        return []
    never = QosTime(0, 0)
    return [
        Qos(
            QosHistory.KEEP_LAST,
            1,
            QosReliability.RELIABLE,
            QosDurability.TRANSIENT_LOCAL,
            never,
            never,
            QosLiveliness.AUTOMATIC,
            never,
            False,
        )
    ]


def _messages(
    trace: Trace, options: BagOptions, robot: str
) -> Iterator[tuple[float, str, dict[str, Any]]]:
    """Times, topics and messages, in the order of time."""
    frames = Frames(trace, options.frame)
    around = markers(trace, frames.things, options.frame)
    yield 0.0, "/robot_description", {"data": robot}
    yield 0.0, "/tf_static", {"transforms": transforms(frames.fixed(), stamp(0.0))}
    told = sorted(_events(trace), key=lambda event: event[0])
    said = -MARKERS_EVERY
    for time in _times(trace, options.rate).tolist():
        while told and told[0][0] <= time:
            moment, event = told.pop(0)
            yield moment, "/events", {"data": json.dumps(event)}
        now = stamp(time)
        yield time, "/clock", {"clock": now}
        if time >= said + MARKERS_EVERY:
            said = time
            yield time, "/markers", {"markers": around}
        yield time, "/joint_states", {"header": {"stamp": now}, **_joints(trace, time)}
        yield time, "/tf", {"transforms": transforms(frames.at(time), now)}
    for moment, event in told:
        yield moment, "/events", {"data": json.dumps(event)}


def _times(trace: Trace, rate: float) -> Floats:
    return np.arange(0.0, trace.duration + 0.5 / rate, 1 / rate)


def _joints(trace: Trace, time: float) -> dict[str, Any]:
    """Names, positions and velocities of all joints that are not fixed in the URDF."""
    robot, now = trace.robot, np.array([time])
    joints, speeds = (rows[0] for rows in trace.joints.at(now))
    opening, widening = (rows[0] for rows in trace.opening.at(now))
    values, velocities = finger_motion(robot, opening[0], widening[0])
    held = {n: v for n, v in robot.fixed.items() if n not in (*robot.joints, *robot.fingers)}
    return {
        "name": [*robot.joints, *robot.fingers, *held],
        "position": np.concatenate([joints, values, list(held.values())]),
        "velocity": np.concatenate([speeds, velocities, np.zeros(len(held))]),
    }


def _events(trace: Trace) -> Iterator[tuple[float, dict[str, Any]]]:
    """What happens, by time: rules fire, actions begin, things are grasped and let go."""
    for subgoal in trace.subgoals:
        yield subgoal.start, {"event": "rule", "rule": subgoal.rule}
    for action in trace.actions:
        yield action.start, {"event": "action", "text": action.text}
    for grip in trace.grips:
        kind = "grasp" if grip.attach else "release"
        yield grip.time, {"event": kind, "object": grip.object}
    for event in trace.events:
        yield event.time, {"event": event.kind, "text": event.text}
