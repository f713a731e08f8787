"""Read plan files; `docs/plan-format.md` is the reference."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from runtime.motion.motion import (
    ArmMove,
    Attach,
    BaseMove,
    Carried,
    GripperMove,
    Piece,
    Release,
    Together,
)
from runtime.plan.fields import base_poses_of, times_of
from runtime.plan.model import Failure, Plan, PlanAction, PlanSubgoal, TimedPiece
from runtime.plan.node import LONGEST, Node, index_of, name_of, one_pose_of, poses_of, read_json
from runtime.plan.version_1 import action_of_version_1
from runtime.plan.write import FORMAT, VERSION


def read_plan(path: Path) -> Plan:
    """Read a plan file of version 1, 2 or 3.

    Raises:
        InputError: what is wrong with the file, and where.
    """
    return plan_of(read_json(path))


def plan_of(data: Node) -> Plan:
    """The same for the data of a file."""
    version = _version(data)
    data.only(
        *("format", "version", "tool_version", "sketch", "scene", "robot", "planner", "seed"),
        *("objects", "base_start", "subgoals", "actions", "failure"),
    )
    scene, robot = data["scene"], data["robot"]
    scene.only("name", "digest")
    robot.only("name", "digest", *(["joints"] if version > 1 else []))
    joints = tuple(_names(robot["joints"])) if version > 1 else ()
    objects = _names(data["objects"])
    start = data["base_start"].numbers((3,))
    subgoals = tuple(_subgoal(node) for node in data["subgoals"].each())
    actions = tuple(
        _action(node, objects, joints, len(subgoals), version)
        if version > 1
        else action_of_version_1(node, objects, len(subgoals))
        for node in data["actions"].each()
    )
    plan = Plan(
        sketch=data["sketch"].text(),
        scene=scene["name"].text(),
        scene_digest=scene["digest"].text(),
        robot=robot["name"].text(),
        robot_digest=robot["digest"].text(),
        planner=data["planner"].text(),
        seed=data["seed"].whole(),
        objects=tuple(objects),
        base_start=(float(start[0]), float(start[1]), float(start[2])),
        subgoals=subgoals,
        actions=actions,
        joints=joints,
        tool_version=data["tool_version"].text(),
        failure=_failure(data.get("failure")),
        path=data.file,
    )
    if plan.execution_time > LONGEST:
        raise data["actions"].fail(f"the plan takes longer than {LONGEST:g} seconds")
    return plan


def _version(data: Node) -> int:
    if data["format"].text() != FORMAT:
        hint = None
        if data["format"].text() == "sketchlang-actions":
            hint = "a plan of a classical domain has no motions to certify"
        raise data["format"].fail(f"this is not a plan file ({FORMAT})", hint)
    version = data["version"].whole()
    if version not in range(1, VERSION + 1):
        age = "an older" if version < 1 else "a newer"
        raise data["version"].fail(
            f"the plan is of version {version}, this is a reader of versions 1 to {VERSION}",
            hint=f"it was written by {age} sketchlang; plan the scene again",
        )
    return version


def _failure(node: Node | None) -> Failure | None:
    if node is None:
        return None
    node.only("reason", "stuck", "why")
    why = []
    for entry in node["why"].each():
        entry["text"].text()
        why.append({key: value.value for key, value in entry.items()})
    stuck = {name: value.whole() for name, value in node["stuck"].items()}
    return Failure(node["reason"].text(), stuck, tuple(why))


def _names(node: Node) -> list[str]:
    names: list[str] = []
    for entry in node.each():
        if entry.text() in names:
            raise entry.fail(f"{entry.text()!r} stands here twice")
        names.append(entry.text())
    return names


def _subgoal(node: Node) -> PlanSubgoal:
    counts = ("actions", "expanded", "generated", "attempt", "width")
    tables = ("before", "after", "rejected")
    node.only("rule", *counts, *tables)
    values = {key: {name: v.whole() for name, v in node[key].items()} for key in tables}
    numbers = {key: node[key].whole() for key in counts}
    return PlanSubgoal(
        node["rule"].text(),
        values["before"],
        values["after"],
        rejected=values["rejected"],
        **numbers,
    )


def _action(
    node: Node, objects: list[str], joints: tuple[str, ...], subgoals: int, version: int
) -> PlanAction:
    node.only("name", "text", "subgoal", "arguments", "pieces", "values")
    arguments: dict[str, Any] = {key: value.value for key, value in node["arguments"].items()}
    values = node.get("values")
    return PlanAction(
        node["name"].text(),
        node["text"].text(),
        index_of(node["subgoal"], subgoals, "subgoal"),
        tuple(_piece(entry, objects, len(joints), version) for entry in node["pieces"].each()),
        arguments,
        None if values is None else {name: value.whole() for name, value in values.items()},
    )


def _piece(node: Node, objects: list[str], joints: int, version: int) -> TimedPiece:
    newer = ["together"] if version > 2 else []
    kind = node["type"].choice("base", "arm", "gripper", *newer)
    times = times_of(node)
    piece: Piece | Together
    if kind == "together":
        node.only("type", "times", "poses", "path", "openings")
        count = len(times)
        path, openings = node["path"].numbers((count, joints)), node["openings"].numbers((count,))
        piece = Together(base_poses_of(node, count), path, openings)
    elif kind == "base":
        node.only("type", "times", "poses", "along")
        piece = BaseMove(base_poses_of(node, len(times)), _along(node, len(times)))
    elif kind == "arm":
        node.only("type", "times", "kind", "path", "along")
        path = node["path"].numbers((len(times), joints))
        piece = ArmMove(path, node["kind"].text(), _along(node, len(times)))
    else:
        node.only("type", "times", "opening", "attach", "release")
        piece = _gripper(node, objects)
    return TimedPiece(piece, times)


def _gripper(node: Node, objects: list[str]) -> GripperMove:
    attach, release = node.get("attach"), node.get("release")
    gripped = letting = None
    if attach is not None and release is not None:
        raise node.fail("one piece cannot attach and release a body")
    if attach is not None:
        attach.only("body", "to")
        gripped = Attach(name_of(attach["body"], objects), attach["to"].text())
    if release is not None:
        release.only("body", "on", "pose")
        on = release["on"].optional()
        letting = Release(
            name_of(release["body"], objects),
            None if on is None else on.text(),
            one_pose_of(release["pose"]),
        )
    return GripperMove(node["opening"].number(), gripped, letting)


def _along(node: Node, count: int) -> tuple[Carried, ...]:
    entries = node.get("along")
    if entries is None:
        return ()
    found = []
    for entry in entries.each():
        entry.only("body", "poses")
        found.append(Carried(entry["body"].text(), poses_of(entry["poses"], count)))
    return tuple(found)
