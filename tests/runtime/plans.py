"""Plans as plain data, changed by tests in one way at a time."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from domains.tabletop.actions.document import document
from domains.tabletop.problem import TabletopProblem
from runtime.plan.model import Plan
from runtime.plan.read import read_plan
from runtime.search.limits import Limits
from runtime.solve import open_task, solve
from sketchlang.loader import load_sketch

Json = dict[str, Any]


def in_turn(scene: str, seed: int) -> Plan:
    """A plan whose actions are done one after the other, with the arm in its home posture in
    between: base, arm and gripper pieces."""
    task = open_task(load_sketch("pick_and_place").checked, scene, seed)
    task.reporting.warm_up()
    rng = np.random.default_rng(seed)
    outcome = solve(task.sketch, task.problem, Limits(timeout=120.0), rng)
    assert outcome.solved
    assert isinstance(task.problem, TabletopProblem)
    return document(task.problem.world, task.sketch.model, outcome, "lazy-siiw-r", seed)


def parse(folder: Path, data: Json) -> Plan:
    """Read plain data as a plan file."""
    path = folder / "plan.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    return read_plan(path)


def pieces(data: Json, kind: str) -> Iterator[tuple[int, int, Json]]:
    """Action number, piece number and piece, for all pieces of a type."""
    for i, action in enumerate(data["actions"]):
        for j, piece in enumerate(action["pieces"]):
            if piece["type"] == kind:
                yield i, j, piece


def actions(data: Json, name: str) -> list[int]:
    """Numbers of the actions of a name."""
    return [i for i, action in enumerate(data["actions"]) if action["name"] == name]


def released(action: Json) -> Json:
    """What an action lets go, and where."""
    found: Json = next(p["release"] for p in action["pieces"] if "release" in p)
    return found


def changed(data: Json) -> Json:
    """A copy to change."""
    return copy.deepcopy(data)
