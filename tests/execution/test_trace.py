"""Traces: true to their plan, the same after writing and reading, refused where damaged."""

from __future__ import annotations

import copy
import json
import re

import numpy as np
import pytest
from click.testing import CliRunner

from domains.tabletop.scene.worlds import find_world
from runtime.judge.skeleton import Skeleton
from runtime.motion.motion import ArmMove, BaseMove
from runtime.plan.node import Node
from runtime.plan.read import read_plan
from runtime.robot.load import DEFAULT_ROBOT, load_robot
from runtime.trace.kinematics import Tree, links_at, object_at
from runtime.trace.load import load_trace
from runtime.trace.read import read_trace, trace_of
from runtime.trace.track import TrackBuilder
from runtime.trace.write import to_json, write_trace
from runtime.world.quaternions import matrix, pose_of
from sketchlang.cli.replay import command as replay
from sketchlang.errors import InputError


def test_what_is_written_is_read_again(trace, tmp_path) -> None:
    first, second = tmp_path / "first.json", tmp_path / "second.json"
    write_trace(trace, first)
    write_trace(read_trace(first), second)
    assert first.read_bytes() == second.read_bytes()


def test_a_trace_passes_through_the_way_points_of_its_plan(trace, plan_file) -> None:
    plan, now = read_plan(plan_file), 0.0
    for action in plan.actions:
        for timed in action.pieces:
            times = now + timed.times
            if isinstance(timed.piece, BaseMove):
                found = trace.base.at(times)[0]
                off = found - timed.piece.poses
                off[:, 2] -= 2 * np.pi * np.round(off[:, 2] / (2 * np.pi))
                assert np.abs(off).max() < 1e-6
            elif isinstance(timed.piece, ArmMove):
                assert np.abs(trace.joints.at(times)[0] - timed.piece.path).max() < 2e-3
            now = times[-1]
    assert trace.duration == pytest.approx(plan.execution_time)


def test_the_base_keeps_its_limits_of_acceleration(trace) -> None:
    robot = load_robot(DEFAULT_ROBOT)
    times = np.arange(0.0, trace.duration, 0.002)
    poses, speeds = trace.base.at(times)
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    driven = np.column_stack([c * speeds[:, 0] + s * speeds[:, 1], speeds[:, 2]])
    # Between way points a track bends as its spline does: over their distance in time.
    gained = np.abs(driven[25:] - driven[:-25]).max(axis=0) / 0.05
    assert gained[0] < 1.1 * robot.base.acceleration
    assert gained[1] < 1.05 * robot.base.angular_acceleration


def test_links_are_where_the_judge_of_plans_has_them(trace) -> None:
    robot = load_robot(DEFAULT_ROBOT)
    base, q = np.array([[0.3, -1.0, 2.0]]), robot.home[None] * 0.9
    expected = Skeleton(robot).transforms(base, q, 0.05)
    found = Tree(trace.robot).links(base[0], q[0], 0.05)
    assert found.keys() == expected.keys()
    for link, pose in found.items():
        assert pose == pytest.approx(expected[link][0], abs=1e-9)


def test_a_held_object_keeps_its_place_in_the_gripper(trace) -> None:
    tree = Tree(trace.robot)
    grip, letting = trace.grips[0], trace.grips[1]
    index = [thing.name for thing in trace.world.movables].index(grip.object)
    relative = []
    for time in np.linspace(grip.time + 0.01, letting.time - 0.01, 7):
        links = links_at(trace, tree, time)
        pose = object_at(trace, links, index, time)
        relative.append(np.linalg.inv(links[trace.robot.tool]) @ pose)
    assert all(pose == pytest.approx(relative[0], abs=1e-9) for pose in relative)


def test_objects_do_not_jump_when_they_are_gripped_or_let_go(trace) -> None:
    tree = Tree(trace.robot)
    for grip in trace.grips:
        index = [thing.name for thing in trace.world.movables].index(grip.object)
        before, after = (
            object_at(trace, links_at(trace, tree, t), index, t)
            for t in (grip.time - 1e-6, grip.time + 1e-6)
        )
        assert before == pytest.approx(after, abs=1e-4)


def test_quaternions_are_inverse_to_matrices() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        turn = rng.normal(size=4)
        pose = np.concatenate([rng.normal(size=3), turn / np.linalg.norm(turn)])
        assert matrix(pose_of(matrix(pose))) == pytest.approx(matrix(pose), abs=1e-12)


def test_a_line_with_ramps_has_the_speed_of_a_trapezoid() -> None:
    builder = TrackBuilder(np.zeros(1))
    builder.line(1.0, 5.0, np.array([3.0]), 0.25)
    values, speeds = builder.track().at(np.array([0.5, 1.5, 2.0, 3.0, 4.0, 4.5, 6.0]))
    assert speeds[:, 0] == pytest.approx([0, 0.5, 1.0, 1.0, 1.0, 0.5, 0])
    assert values[:, 0] == pytest.approx([0, 0.125, 0.5, 1.5, 2.5, 2.875, 3.0])


DAMAGES = [
    (lambda d: d.update(version=0), r"version: the trace is of version 0"),
    (lambda d: d.pop("objects"), r"the key 'objects' is missing"),
    (lambda d: d["base"]["times"].reverse(), r"base.times: times must rise"),
    (lambda d: d["joints"]["values"].pop(), r"joints.values: expected \d+ x 8 numbers"),
    (lambda d: d["objects"][0][0].update(frame="moon"), r"objects\[0\]\[0\].frame: .* 'moon'"),
    (lambda d: d["actions"][0].update(subgoal=99), r"actions\[0\].subgoal: there is no subgoal 99"),
    (lambda d: d["robot"]["joints"][0].update(parent="x"), r"robot.joints\[0\].parent"),
    (
        lambda d: d["world"]["objects"][1]["solids"][0].update(size=[1, 0, 1]),
        r"world.objects\[1\].*size",
    ),
    (lambda d: d["grips"][0].update(object="nobody"), r"grips\[0\].object"),
    (lambda d: d["sketch"]["rules"][0].update(end=10**6), r"sketch.rules\[0\]: the rule is not"),
    (lambda d: d["objects"][0][0]["poses"].append("a"), r"objects\[0\]\[0\].poses"),
    (lambda d: d.update(duration=float("nan")), r"duration: numbers must be finite"),
    (lambda d: d.update(duration=-5), r"duration: a trace lasts from 0"),
    (lambda d: d.update(duration=1e5), r"duration: a trace lasts from 0 to 36000"),
    (lambda d: d["world"].update(robot_start=[1e308, 0, 0]), r"world.robot_start: numbers must be"),
    (lambda d: d["world"].update(name="\ud800"), r"world.name: half of a surrogate pair"),
    (lambda d: d["subgoals"][0].update(end=-1), r"subgoals\[0\].end: the end comes before"),
    (lambda d: d["actions"][1].update(start=1e4), r"actions\[1\].end: the end comes before"),
    (
        lambda d: d["subgoals"][1]["before"].pop("m"),
        r"subgoals\[1\].before: the key 'm'",
    ),
    (
        lambda d: d["robot"].update(gripper_links=["x"]),
        r"robot.gripper_links\[0\]: .* no link",
    ),
    (lambda d: d["robot"].update(finger_joints=[]), r"robot.finger_joints: the robot has no joint"),
    (
        lambda d: d["robot"]["finger_joints"].append(d["robot"]["finger_joints"][0]),
        r"robot.finger_joints\[2\]: .* stands here twice",
    ),
    (
        lambda d: d["world"].update(
            goals=[{"kind": "word", "word": "", "support": "table1", "pitch": 1, "tolerance": 1}]
        ),
        r"world.goals\[0\].word: a word has letters",
    ),
    (lambda d: d["world"]["goals"][0].update(support="moon"), r"world.goals\[0\].support: .*moon"),
    (lambda d: d["world"]["supports"][0].update(owner="x"), r"world.supports\[0\].owner"),
    (lambda d: d["world"]["objects"][0].update(solids=[]), r"world.objects\[0\].solids"),
    (lambda d: d["guided"].update(table1=[]), r"guided.table1: nothing called 'table1'"),
    (
        lambda d: d["world"]["fixed"][0]["solids"][0].update(type="hull", points=[[0, 0, 0]]),
        r"world.fixed\[0\].solids\[0\].points",
    ),
]


@pytest.mark.parametrize(("damage", "message"), DAMAGES, ids=[m for _, m in DAMAGES])
def test_a_damaged_trace_is_refused_with_its_place(trace, damage, message) -> None:
    data = copy.deepcopy(to_json(trace))
    damage(data)
    with pytest.raises(InputError) as caught:
        trace_of(Node(data, "trace.json"))
    assert re.search(rf"^trace\.json: .*{message}|^trace\.json: {message}", str(caught.value))


@pytest.mark.parametrize("command", ["replay", "execute", "export"])
def test_commands_refuse_a_file_that_is_cut_off(command, plan_file, tmp_path) -> None:
    from sketchlang.cli import cli

    path = tmp_path / "cut.json"
    path.write_text(plan_file.read_text(encoding="utf-8")[:5000], encoding="utf-8")
    options = {"replay": ["--html", str(tmp_path / "x.html")], "execute": []}.get(
        command, ["--glb", str(tmp_path / "x.glb")]
    )
    done = CliRunner().invoke(cli, [command, str(path), *options])
    assert done.exit_code == 2
    assert "cut off" in done.output


def test_a_plan_that_does_not_hang_together_is_refused(plan_data, tmp_path) -> None:
    pieces = plan_data["actions"][1]["pieces"]
    moving = next(piece for piece in pieces if piece["type"] == "together")
    moving["path"][0][2] += 0.5
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(plan_data), encoding="utf-8")
    with pytest.raises(InputError, match=r"actions\[1\]\.pieces\[\d+\]: starts 0\.5"):
        load_trace(path, find_world)


def test_a_plan_of_another_scene_is_refused(plan_data, tmp_path) -> None:
    plan_data["scene"]["digest"] = "0" * 64
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(plan_data), encoding="utf-8")
    done = CliRunner().invoke(replay, [str(path), "--trace", str(tmp_path / "t.json")])
    assert done.exit_code == 2
    assert "another version of the scene" in done.output
