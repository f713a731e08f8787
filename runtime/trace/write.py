"""Traces as JSON; `docs/trace-format.md` is the reference."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from runtime.show.looks import is_built_in, looks_of
from runtime.trace.model import Span, Trace, TraceRobot, TraceSketch
from runtime.trace.track import Track
from runtime.trace.write_world import rounded, solid_to_json, world_to_json
from runtime.world.quaternions import pose_of
from sketchlang.files import write_text

FORMAT = "sketchlang-trace"
VERSION = 2


def write_trace(trace: Trace, path: Path) -> None:
    """Write a trace; a file of that name is replaced when the new one is complete.

    Raises:
        InputError: the file cannot be written.
    """
    write_text(path, dumps(trace) + "\n")


def dumps(trace: Trace) -> str:
    """The trace as JSON on one line."""
    return json.dumps(to_json(trace), separators=(",", ":"))


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
        "world": world_to_json(trace.world),
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
                "text": a.text,
                "subgoal": a.subgoal,
                "object": a.object,
                "start": round(a.start, 6),
                "end": round(a.end, 6),
                **({} if a.values is None else {"values": dict(a.values)}),
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
        "guided": {
            name: [_span(span) for span in spans] for name, spans in sorted(trace.guided.items())
        },
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


def _robot(robot: TraceRobot) -> dict[str, Any]:
    urdf, looks = robot.urdf, _looks(robot)
    return {
        "name": robot.name,
        "digest": robot.digest,
        "root": urdf.root,
        "links": [
            {
                "name": link,
                "solids": [
                    {
                        "name": shape.name,
                        "pose": rounded(pose_of(shape.pose)),
                        **solid_to_json(shape.solid),
                    }
                    for shape in shapes
                ],
            }
            for link, shapes in urdf.shapes.items()
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
        "max_force": None if robot.max_force is None else round(robot.max_force, 6),
        "openings": rounded(robot.openings),
        "finger_values": rounded(robot.finger_table),
        "controllers": [
            {
                "name": c.name,
                "type": c.type,
                "joints": list(c.joints),
                "action": c.action,
                "moves_base": c.moves_base,
            }
            for c in robot.controllers
        ],
    } | ({"looks": looks} if looks else {})


def _looks(robot: TraceRobot) -> list[dict[str, Any]]:
    """What is seen of a robot, where neither its solids nor looks of ours say it."""
    if not (robot.looks or any(robot.urdf.visuals.values())) or is_built_in(robot):
        return []
    return [
        {
            "link": link,
            "colour": rounded(np.array(colour)),
            "vertices": rounded(vertices),
            "faces": faces.tolist(),
        }
        for link, (vertices, faces), colour in looks_of(robot)
    ]
