"""Read trace files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from runtime.robot.model import Floats
from runtime.robot.urdf import Box, Joint, Urdf
from runtime.scene.model import (
    Goal,
    Obstacle,
    PoseGoal,
    RegionGoal,
    Scene,
    SceneObject,
    Surface,
    UprightBox,
    WordGoal,
)
from runtime.trace.kinematics import matrix
from runtime.trace.model import (
    WORLD,
    Event,
    Grip,
    RuleText,
    Span,
    Trace,
    TraceAction,
    TraceRobot,
    TraceSketch,
    TraceSubgoal,
)
from runtime.trace.node import Node, read_json
from runtime.trace.track import Track
from runtime.trace.write import FORMAT, VERSION


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
    scene, robot, sketch = _scene(data["scene"]), _robot(data["robot"]), _sketch(data["sketch"])
    names = [thing.name for thing in scene.objects]
    subgoals = tuple(_subgoal(node) for node in data["subgoals"].each())
    objects = data["objects"].each()
    if len(objects) != len(names):
        raise data["objects"].fail(f"{len(objects)} entries for {len(names)} objects")
    links = set(robot.urdf.boxes)
    return Trace(
        source=data["source"].choice("plan", "execution"),
        tool_version=data["tool_version"].text(),
        sketch=sketch,
        scene=scene,
        robot=robot,
        planner=data["planner"].text(),
        seed=data["seed"].whole(),
        duration=data["duration"].number(),
        subgoals=subgoals,
        actions=tuple(_action(node, names, len(subgoals)) for node in data["actions"].each()),
        base=_track(data["base"], 3),
        joints=_track(data["joints"], len(robot.joints)),
        opening=_track(data["opening"], 1),
        grips=tuple(
            Grip(
                node["start"].number(),
                node["time"].number(),
                _name(node["object"], names),
                node["attach"].flag(),
            )
            for node in data["grips"].each()
        ),
        objects=tuple(_spans(node, links) for node in objects),
        events=tuple(
            Event(node["time"].number(), node["kind"].text(), node["text"].text())
            for node in data["events"].each()
        ),
    )


def _name(node: Node, names: list[str]) -> str:
    if node.text() not in names:
        raise node.fail(f"unknown object {node.text()!r}")
    return node.text()


def _index(node: Node, count: int, what: str) -> int:
    if not 0 <= node.whole() < count:
        raise node.fail(f"there is no {what} {node.whole()}")
    return node.whole()


def _times(node: Node, strict: bool) -> Floats:
    times = node.numbers((None,))
    if np.any(np.diff(times) < 0) or (strict and np.any(np.diff(times) == 0)):
        raise node.fail("times must rise")
    return times


def _track(node: Node, width: int) -> Track:
    times = _times(node["times"], strict=True)
    values = node["values"].numbers((len(times), width))
    return Track(times, values, node["velocities"].numbers((len(times), width)))


def _poses(node: Node, count: int) -> Floats:
    poses = node.numbers((count, 7))
    length = np.linalg.norm(poses[:, 3:], axis=1)
    if np.abs(length - 1).max() > 1e-3:
        raise node.fail("the last four numbers of a pose must be a unit quaternion")
    poses[:, 3:] /= length[:, None]
    return poses


def _spans(node: Node, links: set[str]) -> tuple[Span, ...]:
    spans = []
    for entry in node.each():
        frame = entry["frame"].text()
        if frame != WORLD and frame not in links:
            raise entry["frame"].fail(f"the robot has no link {frame!r}")
        times = _times(entry["times"], strict=False)
        poses = _poses(entry["poses"], len(times))
        spans.append(Span(entry["start"].number(), frame, times, poses))
    if not spans or spans[0].frame != WORLD:
        raise node.fail("an object starts in the world")
    return tuple(spans)


def _subgoal(node: Node) -> TraceSubgoal:
    values = {
        key: {name: value.whole() for name, value in node[key].items()}
        for key in ("before", "after", "rejected")
    }
    counts = {key: node[key].whole() for key in ("expanded", "generated", "attempt", "width")}
    start, end = node["start"].number(), node["end"].number()
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
    thing, placement = node["object"].optional(), node["placement"].optional()
    row = None if placement is None else placement.numbers((4,)).tolist()
    return TraceAction(
        node["name"].choice("move_base", "pick", "place"),
        _index(node["subgoal"], subgoals, "subgoal"),
        None if thing is None else _name(thing, names),
        None if row is None else (row[0], row[1], row[2], row[3]),
        node["start"].number(),
        node["end"].number(),
    )


def _sketch(node: Node) -> TraceSketch:
    texts = tuple((entry["name"].text(), entry["text"].text()) for entry in node["texts"].each())
    features = tuple(
        (entry["name"].text(), entry["kind"].choice("bool", "nat"))
        for entry in node["features"].each()
    )
    rules = []
    for entry in node["rules"].each():
        text = _index(entry["text"], len(texts), "text")
        start, end = entry["start"].whole(), entry["end"].whole()
        if not 0 <= start <= end <= len(texts[text][1]):
            raise entry.fail("the rule is not within its text")
        rules.append(RuleText(entry["name"].text(), text, start, end))
    return TraceSketch(node["name"].text(), texts, features, tuple(rules))


def _box(node: Node) -> UprightBox:
    x, y, z = node["centre"].numbers((3,)).tolist()
    size = node["size"].numbers((3,))
    if size.min() <= 0:
        raise node["size"].fail("sizes must be positive")
    a, b, c = size.tolist()
    return UprightBox((x, y, z), (a, b, c), node["yaw"].number())


def _scene(node: Node) -> Scene:
    surfaces: list[Surface] = []
    obstacles: list[Obstacle] = []
    obstacles += [Obstacle(wall["name"].text(), _box(wall["box"])) for wall in node["walls"].each()]
    for entry in node["tables"].each():
        box, region = _box(entry["box"]), entry["region"].numbers((2,)).tolist()
        name, rest = entry["name"].text(), entry["rest"].number()
        surfaces.append(Surface(name, box, (region[0] / 2, region[1] / 2), rest))
        obstacles.append(Obstacle(name, box))
    objects = [_object(entry, len(surfaces)) for entry in node["objects"].each()]
    names = [thing.name for thing in objects]
    goals: dict[int, Goal] = {}
    for entry in node["goals"].each():
        index = names.index(_name(entry["object"], names))
        surface = _index(entry["table"], len(surfaces), "table")
        if "at" in entry.value:
            x, y = entry["at"].numbers((2,)).tolist()
            goals[index] = PoseGoal(surface, x, y, entry["tolerance"].number())
        else:
            goals[index] = RegionGoal(surface)
    word = node["word"].optional()
    start = node["robot_start"].numbers((3,)).tolist()
    return Scene(
        name=node["name"].text(),
        robot_start=(start[0], start[1], start[2]),
        surfaces=tuple(surfaces),
        obstacles=tuple(obstacles),
        objects=tuple(objects),
        goals=goals,
        word=None
        if word is None
        else WordGoal(
            word["word"].text(),
            _index(word["table"], len(surfaces), "table"),
            word["pitch"].number(),
            word["tolerance"].number(),
        ),
        digest=node["digest"].text(),
    )


def _object(node: Node, surfaces: int) -> SceneObject:
    size, start = node["size"].numbers((3,)), node["start"].numbers((3,)).tolist()
    if size.min() <= 0:
        raise node["size"].fail("sizes must be positive")
    a, b, c = size.tolist()
    colour, letter = node["colour"].optional(), node["letter"].optional()
    return SceneObject(
        node["name"].text(),
        (a, b, c),
        (start[0], start[1], start[2]),
        _index(node["table"], surfaces, "table"),
        None if colour is None else colour.text(),
        None if letter is None else letter.text(),
    )


def _robot(node: Node) -> TraceRobot:
    boxes: dict[str, tuple[Box, ...]] = {}
    for link in node["links"].each():
        boxes[link["name"].text()] = tuple(
            Box(
                box["name"].text(),
                matrix(_poses(Node([box["pose"].value], box.file, f"{box.where}.pose"), 1)[0])[:3],
                box["size"].numbers((3,)) / 2,
            )
            for box in link["boxes"].each()
        )
    joints: dict[str, Joint] = {}
    for entry in node["joints"].each():
        joint = _joint(entry, set(boxes))
        if joint.child in joints:
            raise entry["child"].fail(f"two joints move {joint.child!r}")
        joints[joint.child] = joint
    root = node["root"].text()
    _check_tree(node, root, set(boxes), joints)
    names = {joint.name for joint in joints.values()}
    lists = {
        key: [entry.text() for entry in node[key].each()]
        for key in ("planning_joints", "finger_joints", "gripper_links")
    }
    for key in ("planning_joints", "finger_joints"):
        for i, name in enumerate(lists[key]):
            if name not in names:
                raise node[key].each()[i].fail(f"there is no joint {name!r}")
    if node["tool"].text() not in boxes:
        raise node["tool"].fail(f"there is no link {node['tool'].text()!r}")
    return TraceRobot(
        name=node["name"].text(),
        digest=node["digest"].text(),
        urdf=Urdf(node["name"].text(), root, boxes, joints),
        joints=tuple(lists["planning_joints"]),
        fingers=tuple(lists["finger_joints"]),
        fixed={name: value.number() for name, value in node["fixed_joints"].items()},
        home=node["home"].numbers((len(lists["planning_joints"]),)),
        tool=node["tool"].text(),
        gripper_links=tuple(lists["gripper_links"]),
        max_opening=node["max_opening"].number(),
    )


def _joint(node: Node, links: set[str]) -> Joint:
    for key in ("parent", "child"):
        if node[key].text() not in links:
            raise node[key].fail(f"there is no link {node[key].text()!r}")
    origin = Node([node["origin"].value], node.file, f"{node.where}.origin")
    lower, upper, velocity = node["limits"].numbers((3,)).tolist()
    return Joint(
        node["name"].text(),
        node["type"].choice("fixed", "revolute", "continuous", "prismatic"),
        node["parent"].text(),
        node["child"].text(),
        matrix(_poses(origin, 1)[0])[:3],
        node["axis"].numbers((3,)),
        lower,
        upper,
        velocity,
    )


def _check_tree(node: Node, root: str, links: set[str], joints: dict[str, Joint]) -> None:
    reached = {root} & links
    while True:
        more = {j.child for j in joints.values() if j.parent in reached} - reached
        if not more:
            break
        reached |= more
    if reached != links or root in joints:
        raise node["joints"].fail(f"the links are not a tree that hangs on {root!r}")
