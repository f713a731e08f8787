"""Exports, read back."""

from __future__ import annotations

import io
import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from runtime.export.bag import TOPICS, BagOptions, write_bag
from runtime.export.messages import track_of, trajectories
from runtime.export.model import glb
from runtime.robot.urdf import read_urdf
from runtime.trace.kinematics import Tree, links_at, object_at
from runtime.world.quaternions import matrix
from sketchlang.errors import InputError


def test_a_controller_reads_the_same_motion(trace) -> None:
    message = json.loads(json.dumps(trajectories(trace)))["arm"]
    assert message["joint_names"] == list(trace.robot.joints)
    times = np.linspace(0, trace.duration, 500)
    assert track_of(message).at(times)[0] == pytest.approx(trace.joints.at(times)[0], abs=1e-5)


def test_fingers_share_the_opening(trace) -> None:
    track = track_of(trajectories(trace)["gripper"])
    assert track.values.sum(axis=1) == pytest.approx(trace.opening.values[:, 0], abs=1e-5)


def read_bag(path) -> dict[str, list]:
    """Its messages by topic, each with its time in seconds."""
    from rosbags.rosbag2 import Reader
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    seen: dict[str, list] = {}
    with Reader(path) as reader:
        for connection, stamp, data in reader.messages():
            message = store.deserialize_cdr(data, connection.msgtype)
            seen.setdefault(connection.topic, []).append((stamp * 1e-9, message))
    return seen


@pytest.fixture(scope="module")
def bag(trace, tmp_path_factory):
    pytest.importorskip("rosbags")
    path = tmp_path_factory.mktemp("bags") / "bag"
    write_bag(replace(trace, duration=12.0), path, BagOptions(rate=10.0, frame="odom"))
    return read_bag(path)


def test_a_bag_is_read_back(trace, bag) -> None:
    assert set(bag) == set(TOPICS)
    time, state = bag["/joint_states"][100]
    expected = trace.joints.at(np.array([time]))[0][0]
    assert state.position[: len(expected)] == pytest.approx(expected)
    assert len(state.name) == len(state.position) == len(state.velocity)
    assert bag["/clock"][100][1].clock.sec == 10
    events = [json.loads(message.data) for _, message in bag["/events"]]
    assert {"event": "grasp", "object": trace.grips[0].object} in events


def test_the_frames_of_a_bag_are_a_tree_with_all_links_where_they_are(trace, bag) -> None:
    time, moving = bag["/tf"][100]
    seen = {t.child_frame_id: t for t in [*moving.transforms, *bag["/tf_static"][0][1].transforms]}
    links = links_at(trace, Tree(trace.robot), time)
    assert set(seen) == {*links, *(thing.name for thing in trace.world.movables)}

    def world(name: str) -> np.ndarray:
        if name == "odom":
            return np.eye(4)
        at = seen[name].transform
        turn, where = at.rotation, at.translation
        local = matrix(np.array([where.x, where.y, where.z, turn.x, turn.y, turn.z, turn.w]))
        return world(seen[name].header.frame_id) @ local

    for name, pose in links.items():
        assert world(name) == pytest.approx(pose, abs=1e-4)
    for index, thing in enumerate(trace.world.movables):
        assert world(thing.name) == pytest.approx(object_at(trace, links, index, time), abs=1e-4)


def test_the_robot_of_a_bag_is_the_robot(trace, bag, tmp_path) -> None:
    """Its URDF is read as other robots' are, and has the same joints at the same places."""
    path = tmp_path / "robot.urdf"
    path.write_text(bag["/robot_description"][0][1].data)
    robot, ours = read_urdf(path), trace.robot.urdf
    assert set(robot.shapes) == set(ours.shapes)
    for child, joint in ours.joints.items():
        assert robot.joints[child].origin == pytest.approx(joint.origin, abs=1e-5)
        assert robot.joints[child].name == joint.name


def test_markers_are_in_frames_that_there_are(trace, bag) -> None:
    shown = bag["/markers"][0][1].markers
    assert {*(t.name for t in trace.world.movables), *(t.name for t in trace.world.fixed)} <= {
        marker.ns for marker in shown
    }
    frames = {t.child_frame_id for t in bag["/tf"][0][1].transforms} | {"odom"}
    assert {marker.header.frame_id for marker in shown} <= frames
    assert len({marker.id for marker in shown}) == len(shown)


def test_a_bag_does_not_replace_anything(trace, tmp_path) -> None:
    pytest.importorskip("rosbags")
    with pytest.raises(InputError, match="exists"):
        write_bag(trace, tmp_path)


def test_a_model_has_everything_by_name(trace) -> None:
    scene = trimesh.load_scene(io.BytesIO(glb(trace, 10.0)), file_type="glb")
    names = set(scene.geometry)
    assert {thing.name for thing in trace.world.movables} <= names
    assert {thing.name for thing in trace.world.fixed} <= names
    first = trace.world.movables[0]
    pose = scene.graph.get(first.name)[0]
    assert pose[1, 3] == pytest.approx(0.767, abs=1e-3)  # y is up
