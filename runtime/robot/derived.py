"""What is derived from a robot's kinematics, kept on disk by the digest of its files.

Deriving takes some seconds. Where the cache cannot be read or written, it is done anew.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from runtime.robot.approach import USUAL, Approach, Derived, Family, Workspace
from runtime.robot.model import RobotModel
from runtime.robot.reachable import grid, shoulder_of
from runtime.robot.sweeps import approach_of
from sketchlang.errors import InputError
from sketchlang.files import cache_folder, write_text

VERSION = 5
"""Part of the name of cached files: to be raised when something here derives differently."""

BOXES = ("hand", "arm", "fingers")


def derived_of(robot: RobotModel, families: Sequence[Family] = USUAL) -> Derived:
    """What kinematics says of a robot and some families, from the cache or anew."""
    others = "".join(f"-{family.value}" for family in families if family not in USUAL)
    path = cache_folder() / "robots" / f"{robot.digest}-{VERSION}{others}.json"
    try:
        return _from_data(json.loads(path.read_text("utf-8")), families)
    except (OSError, ValueError, KeyError, TypeError):
        pass
    derived = derive(robot, families)
    data = _as_data(derived)
    with suppress(OSError, InputError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, json.dumps(data))
    return _from_data(data, families)  # rounded, so that a first run is no other than the next ones


def derive(robot: RobotModel, families: Sequence[Family] = USUAL) -> Derived:
    """The same, always anew."""
    workspaces, approaches = {}, {}
    for family in families:
        workspaces[family], postures = grid(robot, family)
        approaches[family] = approach_of(robot, family, postures)
    return Derived(shoulder_of(robot), workspaces, approaches)


def _as_data(derived: Derived) -> dict[str, Any]:
    families = {}
    for family in derived.workspaces:
        workspace, approach = derived.workspaces[family], derived.approaches[family]
        families[family.value] = {
            "heights": _rounded(workspace.heights),
            "inner": _rounded(workspace.inner),
            "outer": _rounded(workspace.outer),
            "wrist_offset": round(workspace.wrist_offset, 6),
            **{key: _rounded(getattr(approach, key)) for key in BOXES},
        }
    return {"centre": [round(value, 6) for value in derived.centre], "families": families}


def _rounded(values: Any) -> Any:
    return np.round(values, 6).tolist()


def _from_data(data: Any, wanted: Sequence[Family]) -> Derived:
    """Raises ValueError, KeyError or TypeError for anything else than `_as_data` makes."""
    workspaces, approaches = {}, {}
    for family in wanted:
        entry = data["families"][family.value]
        heights, inner, outer = (
            np.array(entry[key], dtype=float) for key in ("heights", "inner", "outer")
        )
        if not heights.shape == inner.shape == outer.shape:
            raise ValueError
        offset = float(entry["wrist_offset"])
        workspaces[family] = Workspace(heights, inner, outer, offset)
        boxes = (np.array(entry[key], dtype=float).reshape(-1, 6) for key in BOXES)
        approaches[family] = Approach(family, *boxes)
    x, y = (float(value) for value in data["centre"])
    return Derived((x, y), workspaces, approaches)
