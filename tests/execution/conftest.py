"""A plan of the smallest scene, made once, and its trace."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from domains.tabletop.scene.worlds import find_world
from runtime.trace.load import load_trace
from runtime.trace.model import Trace
from sketchlang.cli.run import command as run


@pytest.fixture(scope="session")
def overlapping(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plan of `sorting/3t-02`."""
    path = tmp_path_factory.mktemp("plans") / "plan.json"
    done = CliRunner().invoke(run, ["pick_and_place", "sorting/3t-02", "--out", str(path)])
    assert done.exit_code == 0, done.output
    return path


@pytest.fixture(scope="session")
def plan_file(overlapping: Path) -> Path:
    """The same, for modules that do not care."""
    return overlapping


@pytest.fixture(scope="session")
def trace(plan_file: Path) -> Trace:
    return load_trace(plan_file, find_world)


@pytest.fixture(scope="session")
def in_turn_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plan of `sorting/3t-02` in which base and arm never move at once."""
    path = tmp_path_factory.mktemp("plans") / "plan.json"
    words = ["pick_and_place", "sorting/3t-02", "--in-turn", "--out", str(path)]
    done = CliRunner().invoke(run, words)
    assert done.exit_code == 0, done.output
    return path


@pytest.fixture(scope="session")
def in_turn(in_turn_file: Path) -> Trace:
    return load_trace(in_turn_file, find_world)


@pytest.fixture
def plan_data(plan_file: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(plan_file.read_text(encoding="utf-8"))
    return data
