"""An arm of one's own on a desk: its foot ends a little below the plate that it stands on, and its
root is called `world`, as in many URDFs."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("pybullet")

import sketchlang
from domains.tabletop.scene.worlds import find_world
from runtime.judge.certify import certify
from runtime.motion.course import TICK
from runtime.physics.execute import execute
from runtime.plan.read import read_plan
from runtime.robot.load import load_robot
from runtime.trace.load import load_trace

ROBOTS = Path(sketchlang.__file__).parents[1] / "runtime" / "robot"

DEEP = 0.0005
"""Metres that the foot is below the desk's top; the built-in one ends 2 mm above it."""


@pytest.fixture(scope="module")
def own_arm(tmp_path_factory) -> str:
    folder = tmp_path_factory.mktemp("own") / "arm"
    shutil.copytree(ROBOTS / "ur5e_desk", folder)
    urdf, toml = folder / "ur5e_desk.urdf", folder / "ur5e_desk.toml"
    text = urdf.read_text().replace('link="base"', 'link="world"').replace('"base"', '"world"')
    urdf.write_text(text)
    text = toml.read_text().replace('"base"', '"world"')
    toml.write_text(text.replace("height = 0.75", f"height = {0.75 - 0.002 - DEEP}"))
    return str(toml)


def test_it_plans_as_smoothly_is_certified_and_executes(own_arm, tmp_path) -> None:
    own = sketchlang.plan("pick_and_place", "desk/sort", robot=own_arm, seed=0)
    clear = sketchlang.plan("pick_and_place", "desk/sort", robot="ur5e_desk", seed=0)
    assert own.solved
    assert clear.solved
    # Where the foot counted as a contact, every motion was one after the other, with stops.
    assert own.plan.execution_time < 1.2 * clear.plan.execution_time + TICK
    path = tmp_path / "plan.json"
    own.plan.save(path)
    trace = load_trace(path, find_world, sketch="pick_and_place")  # the plan names the robot's file
    assert trace.robot.name == "ur5e_desk"
    assert own.plan.validate().valid
    report, _ = execute(trace)
    assert report.success
    assert not report.touches
    assert max(pose.error for pose in report.objects) < 0.01


def test_a_foot_deep_in_something_is_still_a_collision(own_arm, tmp_path) -> None:
    own = sketchlang.plan("pick_and_place", "desk/sort", robot=own_arm, seed=0)
    assert own.solved
    sunk = tmp_path / "sunk"
    shutil.copytree(Path(own_arm).parent, sunk)
    toml = sunk / "ur5e_desk.toml"
    toml.write_text(toml.read_text().replace(f"height = {0.75 - 0.002 - DEEP}", "height = 0.7"))
    own.plan.save(tmp_path / "plan.json")
    robot = load_robot(str(toml))
    plan = replace(read_plan(tmp_path / "plan.json"), robot_digest=robot.digest)
    found = certify(plan, find_world("desk/sort"), robot)
    assert any("world hits desk" in finding.message for finding in found.findings)
