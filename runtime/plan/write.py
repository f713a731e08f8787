"""Plans as JSON, always of the newest version."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from runtime.motion.motion import ArmMove, BaseMove, Carried, GripperMove, Together
from runtime.plan.model import Failure, Plan, PlanAction, TimedPiece
from runtime.world.poses import Floats
from sketchlang.files import write_text

FORMAT = "sketchlang-plan"
VERSION = 3


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
        **_failure(plan.failure),
        "tool_version": plan.tool_version,
        "sketch": plan.sketch,
        "scene": {"name": plan.scene, "digest": plan.scene_digest},
        "robot": {"name": plan.robot, "digest": plan.robot_digest, "joints": list(plan.joints)},
        "planner": plan.planner,
        "seed": plan.seed,
        "objects": list(plan.objects),
        "base_start": _rounded(np.array(plan.base_start)),
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
        "actions": [_action(action) for action in plan.actions],
    }


def _failure(failure: Failure | None) -> dict[str, Any]:
    if failure is None:
        return {}
    why = [dict(finding) for finding in failure.why]
    return {"failure": {"reason": failure.reason, "stuck": dict(failure.stuck), "why": why}}


def _rounded(array: Floats) -> list[Any]:
    # Micrometres and microradians: below every tolerance that anything downstream has.
    rounded: list[Any] = (np.round(array, 6) + 0.0).tolist()
    return rounded


def _action(action: PlanAction) -> dict[str, Any]:
    data = {
        "name": action.name,
        "text": action.text,
        "subgoal": action.subgoal,
        "arguments": dict(action.arguments),
        "pieces": [_piece(timed) for timed in action.pieces],
    }
    return data if action.values is None else data | {"values": dict(action.values)}


def _piece(timed: TimedPiece) -> dict[str, Any]:
    times = _rounded(timed.times)
    match timed.piece:
        case BaseMove(poses, along):
            return {"type": "base", "times": times, "poses": _rounded(poses)} | _along(along)
        case ArmMove(path, kind, along):
            data = {"type": "arm", "kind": kind, "times": times, "path": _rounded(path)}
            return data | _along(along)
        case Together(poses, path, openings):
            return {
                "type": "together",
                "times": times,
                "poses": _rounded(poses),
                "path": _rounded(path),
                "openings": _rounded(openings),
            }
        case GripperMove(opening, attach, release):
            grip: dict[str, Any] = {"type": "gripper", "times": times, "opening": round(opening, 6)}
            if attach is not None:
                grip["attach"] = {"body": attach.body, "to": attach.to}
            if release is not None:
                grip["release"] = {
                    "body": release.body,
                    "on": release.on,
                    "pose": _rounded(release.pose),
                }
            return grip


def _along(along: tuple[Carried, ...]) -> dict[str, Any]:
    if not along:
        return {}
    return {"along": [{"body": c.body, "poses": _rounded(c.poses)} for c in along]}
