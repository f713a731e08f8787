"""Plans as plain data, changed by tests in one way at a time."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from runtime.plan.model import Plan
from runtime.plan.read import read_plan

Json = dict[str, Any]


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
