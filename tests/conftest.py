"""What many tests need: the built-in robot, scenes, and plans that were really produced."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from domains.tabletop.scene.load import load_scene
from domains.tabletop.scene.model import Scene
from runtime.plan.write import write_plan
from runtime.robot.load import load_robot
from runtime.robot.model import RobotModel
from sketchlang.library import find_scene
from tests.runtime.plans import in_turn

# Time is measured by benchmarks: tests run on machines that are busy with other things.
settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")


@pytest.fixture(scope="session")
def robot() -> RobotModel:
    return load_robot("tiago")


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2024)


@pytest.fixture(scope="session")
def sticks() -> Scene:
    """The smallest built-in scene: three tables, two sticks."""
    path, name = find_scene("sorting/3t-02")
    return load_scene(path, name)


@pytest.fixture(scope="session")
def plan_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plan of `sorting/3t-02`, as the command line writes it."""
    path = tmp_path_factory.mktemp("plans") / "plan.json"
    done = sketchlang("run", "pick_and_place", "sorting/3t-02", "--seed", "0", "--out", str(path))
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="session")
def plain_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plan of `sorting/3t-02` that does one thing after the other."""
    path = tmp_path_factory.mktemp("plans") / "plan.json"
    write_plan(in_turn("sorting/3t-02", 0), path)
    return path


@pytest.fixture
def plain_data(plain_file: Path) -> dict[str, Any]:
    """The same plan as plain data, to be changed at will."""
    data: dict[str, Any] = json.loads(plain_file.read_text())
    return data


@pytest.fixture
def plan_data(plan_file: Path) -> dict[str, Any]:
    """The same plan as plain data, to be changed at will."""
    data: dict[str, Any] = json.loads(plan_file.read_text())
    return data


def sketchlang(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run the command line in a process of its own, as users do."""
    return subprocess.run(
        [sys.executable, "-c", "from sketchlang.cli import main; main()", *arguments],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=cwd,
        check=False,
    )
