"""Plan files: JSON, versioned, self-describing; `docs/plan-format.md` is their reference.

A plan names its scene and robot by name and digest, and holds every action with its timed
joint and base trajectories, and for every subgoal the rule that fired and the feature values
before and after. Lengths in metres, angles in radians, times in seconds, world frame.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from runtime.motion.motion import ArmMove, BaseMove, GripperMove, Piece
from runtime.robot.model import Floats
from sketchlang.errors import InputError
from sketchlang.files import write_text
from sketchlang.reading import read_json

FORMAT = "sketchlang-plan"
VERSION = 1

LARGEST = 1e6
"""Metres, radians or seconds: no number in a plan or a trace is beyond."""

LONGEST = 36_000.0
"""Seconds that a plan or a trace may take: ten hours."""

FARTHEST = 1000.0
"""Metres (and radians) from the origin that a base pose in a file may be."""


@dataclass(frozen=True, eq=False)
class TimedPiece:
    """A piece of a motion and the seconds at its way points (k,), from its own start."""

    piece: Piece
    times: Floats


@dataclass(frozen=True, eq=False)
class PlanAction:
    """One action: `name` is move_base, pick or place. `placement` is where a placed object
    then stands (x, y, z of its bottom, heading)."""

    name: str
    subgoal: int
    object: str | None
    placement: tuple[float, float, float, float] | None
    pieces: tuple[TimedPiece, ...]


@dataclass(frozen=True)
class PlanSubgoal:
    """One subplan: the rule, feature values by name, and the effort it took; `rejected`
    counts the candidates that died at each step of X."""

    rule: str
    before: Mapping[str, int]
    after: Mapping[str, int]
    actions: int
    expanded: int
    generated: int
    attempt: int
    width: int
    rejected: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan as it is on disk; object names and not indices, so that it reads by itself."""

    sketch: str
    scene: str
    scene_digest: str
    robot: str
    robot_digest: str
    planner: str
    seed: int
    objects: tuple[str, ...]
    base_start: tuple[float, float, float]
    subgoals: tuple[PlanSubgoal, ...]
    actions: tuple[PlanAction, ...]
    tool_version: str = ""
    path: str = field(default="", compare=False)

    @property
    def execution_time(self) -> float:
        """Seconds that the trajectories take."""
        return float(sum(t.times[-1] for action in self.actions for t in action.pieces))


def write_plan(plan: Plan, path: Path) -> None:
    """Write a plan; a file of that name is replaced when the new one is complete.

    Raises:
        InputError: the file cannot be written.
    """
    write_text(path, json.dumps(to_json(plan), indent=None, separators=(",", ":")) + "\n")


def to_json(plan: Plan) -> dict[str, Any]:
    """The plan as plain data."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "tool_version": plan.tool_version,
        "sketch": plan.sketch,
        "scene": {"name": plan.scene, "digest": plan.scene_digest},
        "robot": {"name": plan.robot, "digest": plan.robot_digest},
        "planner": plan.planner,
        "seed": plan.seed,
        "objects": list(plan.objects),
        "base_start": list(plan.base_start),
        "subgoals": [
            {
                "rule": subgoal.rule,
                "before": dict(subgoal.before),
                "after": dict(subgoal.after),
                "actions": subgoal.actions,
                "expanded": subgoal.expanded,
                "generated": subgoal.generated,
                "attempt": subgoal.attempt,
                "width": subgoal.width,
                "rejected": dict(subgoal.rejected),
            }
            for subgoal in plan.subgoals
        ],
        "actions": [_action_to_json(action) for action in plan.actions],
    }


def _rounded(array: Floats) -> list[Any]:
    # Micrometres and microradians: below every tolerance that anything downstream has.
    rounded: list[Any] = np.round(array, 6).tolist()
    return rounded


def _action_to_json(action: PlanAction) -> dict[str, Any]:
    data: dict[str, Any] = {"name": action.name, "subgoal": action.subgoal}
    if action.object is not None:
        data["object"] = action.object
    if action.placement is not None:
        data["placement"] = [round(value, 6) for value in action.placement]
    data["pieces"] = [_piece_to_json(timed) for timed in action.pieces]
    return data


def _piece_to_json(timed: TimedPiece) -> dict[str, Any]:
    times = _rounded(timed.times)
    match timed.piece:
        case BaseMove(poses):
            return {"type": "base", "times": times, "poses": _rounded(poses)}
        case ArmMove(path, kind):
            return {"type": "arm", "kind": kind, "times": times, "path": _rounded(path)}
        case GripperMove(opening, attach, release):
            data: dict[str, Any] = {"type": "gripper", "times": times, "opening": round(opening, 6)}
            if attach is not None:
                data["attach"] = True
            if release is not None:
                data["release"] = True
            return data


# -- reading ----------------------------------------------------------------------------------


def read_plan(path: Path) -> Plan:
    """Read a plan file.

    Raises:
        InputError: what is wrong with the file, and where.
    """
    return _Reader(str(path)).plan(read_json(path))


class _Reader:
    """Takes plain data apart; every complaint names the place in the file."""

    def __init__(self, path: str) -> None:
        self.path = path

    def fail(self, where: str, message: str, hint: str | None = None) -> InputError:
        return InputError(message, place=f"{self.path}: {where}" if where else self.path, hint=hint)

    def item(self, data: Any, key: str, kind: type | tuple[type, ...], where: str) -> Any:
        if not isinstance(data, dict):
            raise self.fail(where, f"expected an object, found {_shown(data)}")
        if key not in data:
            raise self.fail(where, f"the key {key!r} is missing")
        value = data[key]
        inner = f"{where}.{key}" if where else key
        wanted = kind if isinstance(kind, tuple) else (kind,)
        if not isinstance(value, wanted) or (isinstance(value, bool) and bool not in wanted):
            raise self.fail(inner, f"expected {_kinds(wanted)}, found {_shown(value)}")
        return value

    def numbers(self, value: Any, shape: tuple[int | None, ...], where: str) -> Floats:
        try:
            array = np.array(value)
        except ValueError:
            raise self.fail(where, "expected rows of numbers of equal length") from None
        if array.dtype.kind not in "iuf":  # text, truth values, integers beyond 64 bits
            raise self.fail(where, f"expected numbers, found {_shown(value)}")
        array = array.astype(np.float64)
        fits = array.ndim == len(shape) and all(
            want is None or have == want for have, want in zip(array.shape, shape, strict=False)
        )
        if not fits:
            wanted = " x ".join("k" if n is None else str(n) for n in shape)
            raise self.fail(where, f"expected {wanted} numbers, found {_shown(value)}")
        if not np.isfinite(array).all():
            raise self.fail(where, "numbers must be finite")
        if array.size and np.abs(array).max() > LARGEST:
            raise self.fail(where, f"numbers must be between -{LARGEST:g} and {LARGEST:g}")
        return array

    def plan(self, data: Any) -> Plan:
        if self.item(data, "format", str, "") != FORMAT:
            hint = None
            if data["format"] == "sketchlang-actions":
                hint = "a plan of a classical domain has no motions to certify"
            raise self.fail("format", f"this is not a plan file ({FORMAT})", hint)
        version = self.item(data, "version", int, "")
        if version != VERSION:
            age = "an older" if version < VERSION else "a newer"
            raise self.fail(
                "version",
                f"the plan is of version {version}, this is a reader of version {VERSION}",
                hint=f"it was written by {age} sketchlang; plan the scene again",
            )
        scene, robot = self.item(data, "scene", dict, ""), self.item(data, "robot", dict, "")
        objects = self.item(data, "objects", list, "")
        if not all(isinstance(name, str) for name in objects):
            raise self.fail("objects", "expected names")
        start = self.numbers(self.item(data, "base_start", list, ""), (3,), "base_start")
        subgoals = [
            self.subgoal(entry, f"subgoals[{i}]")
            for i, entry in enumerate(self.item(data, "subgoals", list, ""))
        ]
        actions = [
            self.action(entry, f"actions[{i}]", objects, len(subgoals))
            for i, entry in enumerate(self.item(data, "actions", list, ""))
        ]
        seconds = sum(float(timed.times[-1]) for action in actions for timed in action.pieces)
        if seconds > LONGEST:
            raise self.fail("actions", f"the plan takes longer than {LONGEST:g} seconds")
        return Plan(
            sketch=self.item(data, "sketch", str, ""),
            scene=self.item(scene, "name", str, "scene"),
            scene_digest=self.item(scene, "digest", str, "scene"),
            robot=self.item(robot, "name", str, "robot"),
            robot_digest=self.item(robot, "digest", str, "robot"),
            planner=self.item(data, "planner", str, ""),
            seed=self.item(data, "seed", int, ""),
            objects=tuple(objects),
            base_start=(float(start[0]), float(start[1]), float(start[2])),
            subgoals=tuple(subgoals),
            actions=tuple(actions),
            tool_version=self.item(data, "tool_version", str, ""),
            path=self.path,
        )

    def subgoal(self, data: Any, where: str) -> PlanSubgoal:
        values = {}
        for key in ("before", "after", "rejected"):
            values[key] = self.item(data, key, dict, where)
            for name in values[key]:
                self.item(values[key], name, int, f"{where}.{key}")
        counts = {
            key: self.item(data, key, int, where)
            for key in ("actions", "expanded", "generated", "attempt", "width")
        }
        rule = self.item(data, "rule", str, where)
        return PlanSubgoal(
            rule, values["before"], values["after"], rejected=values["rejected"], **counts
        )

    def action(self, data: Any, where: str, objects: Sequence[str], subgoals: int) -> PlanAction:
        name = self.item(data, "name", str, where)
        if name not in {"move_base", "pick", "place"}:
            raise self.fail(f"{where}.name", f"unknown action {name!r}")
        thing = None
        placement = None
        if name != "move_base":
            thing = self.item(data, "object", str, where)
            if thing not in objects:
                raise self.fail(f"{where}.object", f"unknown object {thing!r}")
        if name == "place":
            row = self.numbers(
                self.item(data, "placement", list, where), (4,), f"{where}.placement"
            )
            placement = (float(row[0]), float(row[1]), float(row[2]), float(row[3]))
        subgoal = self.item(data, "subgoal", int, where)
        if not 0 <= subgoal < subgoals:
            raise self.fail(f"{where}.subgoal", f"there is no subgoal {subgoal}")
        index = objects.index(thing) if thing is not None else None
        pieces = tuple(
            self.piece(entry, f"{where}.pieces[{i}]", index)
            for i, entry in enumerate(self.item(data, "pieces", list, where))
        )
        return PlanAction(name, subgoal, thing, placement, pieces)

    def piece(self, data: Any, where: str, index: int | None) -> TimedPiece:
        kind = self.item(data, "type", str, where)
        times = self.numbers(self.item(data, "times", list, where), (None,), f"{where}.times")
        if len(times) < 1 or times[0] != 0 or np.any(np.diff(times) < 0):
            raise self.fail(f"{where}.times", "times must start at 0 and not fall")
        piece: Piece
        if kind == "base":
            poses = self.item(data, "poses", list, where)
            rows = self.numbers(poses, (len(times), 3), f"{where}.poses")
            if np.abs(rows).max() > FARTHEST:
                raise self.fail(f"{where}.poses", "the base drives out of this world")
            piece = BaseMove(rows)
        elif kind == "arm":
            path = self.item(data, "path", list, where)
            rows = self.numbers(path, (len(times), None), f"{where}.path")
            piece = ArmMove(rows, self.item(data, "kind", str, where))
        elif kind == "gripper":
            self.item(data, "opening", (int, float), where)
            opening = float(self.numbers(data["opening"], (), f"{where}.opening"))
            attach, release = (
                key in data and bool(self.item(data, key, bool, where))
                for key in ("attach", "release")
            )
            if (attach or release) and index is None:
                raise self.fail(where, "a base move cannot attach or release an object")
            if attach and release:
                raise self.fail(where, "one piece cannot attach and release an object")
            piece = GripperMove(opening, index if attach else None, index if release else None)
        else:
            raise self.fail(f"{where}.type", f"unknown piece {kind!r}")
        return TimedPiece(piece, times)


def _kinds(kinds: tuple[type, ...]) -> str:
    names = {
        dict: "an object",
        list: "a list",
        str: "a string",
        int: "a whole number",
        bool: "true or false",
    }
    return " or ".join(names.get(kind, "a number") for kind in kinds)


def _shown(value: Any) -> str:
    text = json.dumps(value, default=repr)
    return text if len(text) <= 60 else text[:57] + "..."
