"""Traces as JSON; `docs/trace-format.md` is the reference."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from domains.tabletop.scene.model import Goal, PoseGoal, Scene, UprightBox
from runtime.robot.model import Floats
from runtime.trace.model import Span, Trace, TraceRobot, TraceSketch
from runtime.trace.track import Track
from runtime.world.quaternions import pose_of
from sketchlang.files import write_text

FORMAT = "sketchlang-trace"
VERSION = 1


def write_trace(trace: Trace, path: Path) -> None:
    """Write a trace; a file of that name is replaced when the new one is complete.

    Raises:
        InputError: the file cannot be written.
    """
    write_text(path, dumps(trace) + "\n")


def dumps(trace: Trace) -> str:
    """The trace as JSON on one line."""
    return json.dumps(to_json(trace), separators=(",", ":"))


def rounded(array: Floats) -> list[Any]:
    """Plain lists, to six places: micrometres and microradians, and no negative zeros."""
    plain: list[Any] = (np.round(np.asarray(array, dtype=np.float64), 6) + 0.0).tolist()
    return plain


def to_json(trace: Trace) -> dict[str, Any]:
    """The trace as plain data."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "tool_version": trace.tool_version,
        "source": trace.source,
        "planner": trace.planner,
        "seed": trace.seed,
        "duration": round(trace.duration, 6),
        "sketch": _sketch(trace.sketch),
        "scene": _scene(trace.scene),
        "robot": _robot(trace.robot),
        "subgoals": [
            {
                "rule": s.rule,
                "start": round(s.start, 6),
                "end": round(s.end, 6),
                "before": dict(s.before),
                "after": dict(s.after),
                "expanded": s.expanded,
                "generated": s.generated,
                "attempt": s.attempt,
                "width": s.width,
                "rejected": dict(s.rejected),
            }
            for s in trace.subgoals
        ],
        "actions": [
            {
                "name": a.name,
                "subgoal": a.subgoal,
                "object": a.object,
                "placement": None if a.placement is None else rounded(np.array(a.placement)),
                "start": round(a.start, 6),
                "end": round(a.end, 6),
            }
            for a in trace.actions
        ],
        "base": _track(trace.base),
        "joints": _track(trace.joints),
        "opening": _track(trace.opening),
        "grips": [
            {
                "start": round(g.start, 6),
                "time": round(g.time, 6),
                "object": g.object,
                "attach": g.attach,
            }
            for g in trace.grips
        ],
        "objects": [[_span(span) for span in spans] for spans in trace.objects],
        "events": [
            {"time": round(e.time, 6), "kind": e.kind, "text": e.text} for e in trace.events
        ],
    }


def _track(track: Track) -> dict[str, Any]:
    return {
        "times": rounded(track.times),
        "values": rounded(track.values),
        "velocities": rounded(track.velocities),
    }


def _span(span: Span) -> dict[str, Any]:
    return {
        "start": round(span.start, 6),
        "frame": span.frame,
        "times": rounded(span.times),
        "poses": rounded(span.poses),
    }


def _sketch(sketch: TraceSketch) -> dict[str, Any]:
    return {
        "name": sketch.name,
        "texts": [{"name": name, "text": text} for name, text in sketch.texts],
        "features": [{"name": name, "kind": kind} for name, kind in sketch.features],
        "rules": [
            {"name": r.name, "text": r.text, "start": r.start, "end": r.end} for r in sketch.rules
        ],
    }


def _box(box: UprightBox) -> dict[str, Any]:
    return {
        "centre": rounded(np.array(box.centre)),
        "size": rounded(np.array(box.size)),
        "yaw": round(box.yaw, 6),
    }


def _scene(scene: Scene) -> dict[str, Any]:
    tables = {surface.name for surface in scene.surfaces}
    return {
        "name": scene.name,
        "digest": scene.digest,
        "robot_start": rounded(np.array(scene.robot_start)),
        "tables": [
            {"name": s.name, "box": _box(s.table), "region": rounded(np.array(s.half) * 2)}
            | {"rest": round(s.rest, 6)}
            for s in scene.surfaces
        ],
        "walls": [
            {"name": o.name, "box": _box(o.box)} for o in scene.obstacles if o.name not in tables
        ],
        "objects": [
            {
                "name": o.name,
                "size": rounded(np.array(o.size)),
                "start": rounded(np.array(o.start)),
                "table": o.surface,
                "colour": o.colour,
                "letter": o.letter,
            }
            for o in scene.objects
        ],
        "goals": [_goal(scene, index, goal) for index, goal in sorted(scene.goals.items())],
        "word": None
        if scene.word is None
        else {
            "word": scene.word.word,
            "table": scene.word.surface,
            "pitch": scene.word.pitch,
            "tolerance": scene.word.tolerance,
        },
    }


def _goal(scene: Scene, index: int, goal: Goal) -> dict[str, Any]:
    data: dict[str, Any] = {"object": scene.objects[index].name, "table": goal.surface}
    if isinstance(goal, PoseGoal):
        data["at"] = rounded(np.array([goal.x, goal.y]))
        data["tolerance"] = goal.tolerance
    return data


def _robot(robot: TraceRobot) -> dict[str, Any]:
    urdf = robot.urdf
    return {
        "name": robot.name,
        "digest": robot.digest,
        "root": urdf.root,
        "links": [
            {
                "name": link,
                "boxes": [
                    {
                        "name": box.name,
                        "pose": rounded(pose_of(box.pose)),
                        "size": rounded(2 * box.half),
                    }
                    for box in boxes
                ],
            }
            for link, boxes in urdf.boxes.items()
        ],
        "joints": [
            {
                "name": joint.name,
                "type": joint.type,
                "parent": joint.parent,
                "child": joint.child,
                "origin": rounded(pose_of(joint.origin)),
                "axis": rounded(joint.axis),
                "limits": rounded(np.array([joint.lower, joint.upper, joint.velocity])),
            }
            for joint in urdf.joints.values()
        ],
        "planning_joints": list(robot.joints),
        "finger_joints": list(robot.fingers),
        "fixed_joints": {name: round(value, 6) for name, value in robot.fixed.items()},
        "home": rounded(robot.home),
        "tool": robot.tool,
        "gripper_links": list(robot.gripper_links),
        "max_opening": round(robot.max_opening, 6),
        "openings": rounded(robot.openings),
        "finger_values": rounded(robot.finger_table),
    }
