"""Execution under physics."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

pytest.importorskip("pybullet")

from benchmarks.execution import planned
from domains.tabletop.scene.worlds import find_world
from runtime.physics.execute import execute
from runtime.physics.follow import Follower
from runtime.physics.materials import Materials
from runtime.physics.recorder import Recorder
from runtime.physics.simulation import Physics
from runtime.show.software import Studio, png
from runtime.trace.kinematics import Tree, links_at
from runtime.trace.load import load_trace
from runtime.trace.write import write_trace
from sketchlang.cli.execute import command


def test_a_plan_is_executed(trace, tmp_path) -> None:
    report, happened = execute(trace)
    assert report.success
    assert not report.slips
    assert not report.touches
    assert max(pose.error for pose in report.objects) < 0.01
    assert report.tracking.largest[:2].max() < 0.01
    assert happened.source == "execution"
    path = tmp_path / "executed.json"
    write_trace(happened, path)
    again = load_trace(path, find_world)
    assert [s.rule for s in again.subgoals] == [s.rule for s in trace.subgoals]


def test_slippery_fingers_lose_the_object_and_it_is_told(trace) -> None:
    slippery = Materials(friction=0.05, finger_force=5.0)
    first_pick = replace(trace, duration=trace.actions[1].end)
    report, _ = execute(first_pick, materials=slippery)
    assert not report.success
    assert any(slip.what == "the grasp broke" for slip in report.slips)
    assert report.unmet


def test_the_simulated_robot_is_the_robot(trace) -> None:
    physics = Physics(trace.world, trace.robot)
    try:
        follower = Follower(physics, Recorder(physics))
        follower.wait(0.1)
        expected = links_at(trace, Tree(trace.robot), 0.0)[trace.robot.tool]
        assert physics.tool_matrix() == pytest.approx(expected, abs=2e-3)
    finally:
        physics.close()


def test_a_grasp_needs_both_fingers(trace) -> None:
    physics = Physics(trace.world, trace.robot)
    try:
        physics.step()
        assert not physics.grasp(0)
        assert physics.held is None
    finally:
        physics.close()


def test_the_command_prints_one_object(trace, tmp_path) -> None:
    path = tmp_path / "short.json"
    first = trace.actions[0].end
    write_trace(replace(trace, duration=first), path)
    done = CliRunner().invoke(command, [str(path), "--json"])
    report = json.loads(done.stdout)
    assert done.exit_code == 1  # it only drove to the table
    assert not report["goal_reached"]
    assert set(report["tracking"]) >= {"base_x", *trace.robot.joints}


def test_a_picture_shows_something(trace) -> None:
    studio = Studio(trace, (160, 90))
    try:
        image = studio.picture(0.0)
    finally:
        studio.close()
    assert image.shape == (90, 160, 3)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 20
    assert png(image).startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["words/tamp", "non_monotonic/2t-11"])
def test_plans_of_the_other_families_are_executed(scene) -> None:
    report, _ = execute(planned(scene, seed=0))
    assert report.success, report.unmet


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["pushed", "failed-grasp", "dropped", "obstacle", "noise"])
def test_a_closed_loop_recovers(kind) -> None:
    done = CliRunner().invoke(
        command,
        ["pick_and_place", "sorting/3t-02", "--closed-loop", "--disturbance", kind, "--json"],
    )
    report = json.loads(done.stdout)
    assert report["goal_reached"], report
    assert not [event for event in report["events"] if event["kind"] == "touch"]
