"""Read trace files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from runtime.plan.node import LONGEST, Node, index_of, name_of, poses_of, read_json
from runtime.robot.model import Floats
from runtime.trace.model import (
    WORLD,
    Event,
    Grip,
    RuleText,
    Span,
    Trace,
    TraceAction,
    TraceSketch,
    TraceSubgoal,
)
from runtime.trace.read_robot import robot_of
from runtime.trace.read_world import world_of
from runtime.trace.track import Track
from runtime.trace.write import FORMAT, VERSION
from runtime.world.world import World


def read_trace(path: Path) -> Trace:
    """Read a trace file.

    Raises:
        InputError: what is wrong with the file, and where.
    """
    return trace_of(read_json(path))


def trace_of(data: Node) -> Trace:
    """The same for the data of a file."""
    if data["format"].text() != FORMAT:
        raise data["format"].fail(f"this is not a trace file ({FORMAT})")
    version = data["version"].whole()
    if version != VERSION:
        age = "an older" if version < VERSION else "a newer"
        raise data["version"].fail(
            f"the trace is of version {version}, this is a reader of version {VERSION}",
            hint=f"it was written by {age} sketchlang; make it again of its plan",
        )
    world, robot, sketch = world_of(data["world"]), robot_of(data["robot"]), _sketch(data["sketch"])
    names = [thing.name for thing in world.movables]
    subgoals = tuple(_subgoal(node, sketch) for node in data["subgoals"].each())
    objects = data["objects"].each()
    if len(objects) != len(names):
        raise data["objects"].fail(f"{len(objects)} entries for {len(names)} objects")
    links = set(robot.urdf.shapes)
    duration = data["duration"].number()
    if not 0 <= duration <= LONGEST:
        raise data["duration"].fail(f"a trace lasts from 0 to {LONGEST:g} seconds")
    return Trace(
        source=data["source"].choice("plan", "execution"),
        tool_version=data["tool_version"].text(),
        sketch=sketch,
        world=world,
        robot=robot,
        planner=data["planner"].text(),
        seed=data["seed"].whole(),
        duration=duration,
        subgoals=subgoals,
        actions=tuple(_action(node, names, len(subgoals)) for node in data["actions"].each()),
        base=_track(data["base"], 3),
        joints=_track(data["joints"], len(robot.joints)),
        opening=_track(data["opening"], 1),
        grips=tuple(
            Grip(
                node["start"].number(),
                node["time"].number(),
                name_of(node["object"], names),
                node["attach"].flag(),
            )
            for node in data["grips"].each()
        ),
        objects=tuple(_spans(node, links) for node in objects),
        guided=_guided(data["guided"], world, links),
        events=tuple(
            Event(node["time"].number(), node["kind"].text(), node["text"].text())
            for node in data["events"].each()
        ),
    )


def _span_of_time(node: Node) -> tuple[float, float]:
    start, end = node["start"].number(), node["end"].number()
    if not 0 <= start <= end:
        raise node["end"].fail("the end comes before the start")
    return start, end


def _times(node: Node, strict: bool) -> Floats:
    times = node.numbers((None,))
    if np.any(np.diff(times) < 0) or (strict and np.any(np.diff(times) == 0)):
        raise node.fail("times must rise")
    return times


def _track(node: Node, width: int) -> Track:
    times = _times(node["times"], strict=True)
    values = node["values"].numbers((len(times), width))
    return Track(times, values, node["velocities"].numbers((len(times), width)))


def _spans(node: Node, links: set[str]) -> tuple[Span, ...]:
    spans = []
    for entry in node.each():
        frame = entry["frame"].text()
        if frame != WORLD and frame not in links:
            raise entry["frame"].fail(f"the robot has no link {frame!r}")
        times = _times(entry["times"], strict=False)
        poses = poses_of(entry["poses"], len(times))
        spans.append(Span(entry["start"].number(), frame, times, poses))
    if not spans or spans[0].frame != WORLD:
        raise node.fail("an object starts in the world")
    return tuple(spans)


def _guided(node: Node, world: World, links: set[str]) -> dict[str, tuple[Span, ...]]:
    known = {thing.name for thing in world.fixed if thing.guide is not None}
    for name, spans in node.items():
        if name not in known:
            raise spans.fail(f"nothing called {name!r} can be moved along a guide")
    return {name: _spans(spans, links) for name, spans in node.items()}


def _subgoal(node: Node, sketch: TraceSketch) -> TraceSubgoal:
    values = {
        key: {name: value.whole() for name, value in node[key].items()}
        for key in ("before", "after", "rejected")
    }
    for key in ("before", "after"):
        for name, _ in sketch.features:
            node[key][name].whole()  # every feature of the sketch has a value
    counts = {key: node[key].whole() for key in ("expanded", "generated", "attempt", "width")}
    start, end = _span_of_time(node)
    return TraceSubgoal(
        node["rule"].text(),
        start,
        end,
        values["before"],
        values["after"],
        counts["expanded"],
        counts["generated"],
        counts["attempt"],
        counts["width"],
        values["rejected"],
    )


def _action(node: Node, names: list[str], subgoals: int) -> TraceAction:
    thing, values = node["object"].optional(), node.get("values")
    return TraceAction(
        node["name"].text(),
        node["text"].text(),
        index_of(node["subgoal"], subgoals, "subgoal"),
        None if thing is None else name_of(thing, names),
        *_span_of_time(node),
        None if values is None else {name: value.whole() for name, value in values.items()},
    )


def _sketch(node: Node) -> TraceSketch:
    texts = tuple((entry["name"].text(), entry["text"].text()) for entry in node["texts"].each())
    features = tuple(
        (entry["name"].text(), entry["kind"].choice("bool", "nat"))
        for entry in node["features"].each()
    )
    rules = []
    for entry in node["rules"].each():
        text = index_of(entry["text"], len(texts), "text")
        start, end = entry["start"].whole(), entry["end"].whole()
        if not 0 <= start <= end <= len(texts[text][1]):
            raise entry.fail("the rule is not within its text")
        rules.append(RuleText(entry["name"].text(), text, start, end))
    return TraceSketch(node["name"].text(), texts, features, tuple(rules))
