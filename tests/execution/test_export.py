"""Exports, read back."""

from __future__ import annotations

import io
import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from runtime.export.bag import write_bag
from runtime.export.messages import track_of, trajectories
from runtime.export.model import glb
from sketchlang.errors import InputError


def test_a_controller_reads_the_same_motion(trace) -> None:
    message = json.loads(json.dumps(trajectories(trace)))["arm"]
    assert message["joint_names"] == list(trace.robot.joints)
    times = np.linspace(0, trace.duration, 500)
    assert track_of(message).at(times)[0] == pytest.approx(trace.joints.at(times)[0], abs=1e-5)


def test_fingers_share_the_opening(trace) -> None:
    track = track_of(trajectories(trace)["gripper"])
    assert track.values.sum(axis=1) == pytest.approx(trace.opening.values[:, 0], abs=1e-5)


def test_a_bag_is_read_back(trace, tmp_path) -> None:
    pytest.importorskip("rosbags")
    from rosbags.rosbag2 import Reader
    from rosbags.typesys import Stores, get_typestore

    path = tmp_path / "bag"
    write_bag(replace(trace, duration=12.0), path)
    store = get_typestore(Stores.ROS2_HUMBLE)
    seen: dict[str, list] = {}
    with Reader(path) as reader:
        for connection, stamp, data in reader.messages():
            message = store.deserialize_cdr(data, connection.msgtype)
            seen.setdefault(connection.topic, []).append((stamp, message))
    assert set(seen) == {"/joint_states", "/tf"}
    stamp, state = seen["/joint_states"][200]
    expected = trace.joints.at(np.array([stamp * 1e-9]))[0][0]
    assert state.position[: len(expected)] == pytest.approx(expected)
    names = {transform.child_frame_id for transform in seen["/tf"][0][1].transforms}
    assert names == {trace.robot.urdf.root, *(thing.name for thing in trace.world.movables)}
    base = seen["/tf"][200][1].transforms[0].transform.translation
    assert [base.x, base.y] == pytest.approx(trace.base.at(np.array([stamp * 1e-9]))[0][0][:2])


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
