"""The robot of a trace file."""

from __future__ import annotations

import numpy as np

from runtime.plan.node import Node, poses_of
from runtime.robot.controllers import ACTIONS, Controller
from runtime.robot.shapes import Shape
from runtime.robot.urdf import Joint, Urdf
from runtime.show.looks import Look
from runtime.trace.model import WORLD, TraceRobot
from runtime.trace.read_world import solid_of
from runtime.world.poses import Pose
from runtime.world.quaternions import matrix


def robot_of(node: Node) -> TraceRobot:
    """The robot that a node of a trace file describes."""
    shapes: dict[str, tuple[Shape, ...]] = {}
    for link in node["links"].each():
        shapes[link["name"].text()] = tuple(
            Shape(solid["name"].text(), _pose(solid, "pose"), solid_of(solid))
            for solid in link["solids"].each()
        )
    joints: dict[str, Joint] = {}
    for entry in node["joints"].each():
        joint = _joint(entry, set(shapes))
        if joint.child in joints:
            raise entry["child"].fail(f"two joints move {joint.child!r}")
        joints[joint.child] = joint
    root = node["root"].text()
    _check_tree(node, root, set(shapes), joints)
    names = {joint.name for joint in joints.values()}
    lists = {
        key: [entry.text() for entry in node[key].each()]
        for key in ("planning_joints", "finger_joints", "gripper_links")
    }
    for key in ("planning_joints", "finger_joints"):
        _check_names(node[key], lists[key], names, "joint")
    _check_names(node["gripper_links"], lists["gripper_links"], set(shapes), "link")
    if WORLD in shapes:
        raise node["links"].fail(f"no link can have the name {WORLD!r}")
    if node["tool"].text() not in shapes:
        raise node["tool"].fail(f"there is no link {node['tool'].text()!r}")
    openings = node["openings"].numbers((None,))
    table = node["finger_values"].numbers((len(openings), len(lists["finger_joints"])))
    force, looks = node["max_force"].optional(), node.get("looks")
    return TraceRobot(
        name=node["name"].text(),
        digest=node["digest"].text(),
        urdf=Urdf(node["name"].text(), root, shapes, joints),
        joints=tuple(lists["planning_joints"]),
        fingers=tuple(lists["finger_joints"]),
        fixed={name: value.number() for name, value in node["fixed_joints"].items()},
        home=node["home"].numbers((len(lists["planning_joints"]),)),
        tool=node["tool"].text(),
        gripper_links=tuple(lists["gripper_links"]),
        max_opening=node["max_opening"].number(),
        openings=openings,
        finger_table=table,
        max_force=None if force is None else force.number(),
        controllers=_controllers(node.get("controllers"), names),
        looks=tuple(_look(entry, set(shapes)) for entry in looks.each()) if looks else (),
    )


def _controllers(node: Node | None, names: set[str]) -> tuple[Controller, ...]:
    """Traces that were written before there were controllers have none."""
    found = []
    for entry in [] if node is None else node.each():
        joints = [joint.text() for joint in entry["joints"].each()]
        moves_base = entry["moves_base"].flag()
        if joints and not moves_base:
            _check_names(entry["joints"], joints, names, "joint")
        found.append(
            Controller(
                entry["name"].text(),
                entry["type"].choice(*ACTIONS),
                tuple(joints),
                entry["action"].text(),
                moves_base,
            )
        )
    return tuple(found)


def _look(node: Node, links: set[str]) -> Look:
    if node["link"].text() not in links:
        raise node["link"].fail(f"there is no link {node['link'].text()!r}")
    vertices = node["vertices"].numbers((None, 3))
    faces = node["faces"].numbers((None, 3)).astype(np.int64)
    if not 0 <= faces.min() <= faces.max() < len(vertices):
        raise node["faces"].fail("a face names a vertex that is not there")
    red, green, blue = node["colour"].numbers((3,)).tolist()
    return node["link"].text(), (vertices, faces), (red, green, blue)


def _pose(node: Node, key: str) -> Pose:
    row = Node([node[key].value], node.file, f"{node.where}.{key}")
    return matrix(poses_of(row, 1)[0])[:3]


def _joint(node: Node, links: set[str]) -> Joint:
    for key in ("parent", "child"):
        if node[key].text() not in links:
            raise node[key].fail(f"there is no link {node[key].text()!r}")
    lower, upper, velocity = node["limits"].numbers((3,)).tolist()
    return Joint(
        node["name"].text(),
        node["type"].choice("fixed", "revolute", "continuous", "prismatic"),
        node["parent"].text(),
        node["child"].text(),
        _pose(node, "origin"),
        node["axis"].numbers((3,)),
        lower,
        upper,
        velocity,
    )


def _check_names(node: Node, found: list[str], known: set[str], what: str) -> None:
    """At least one, all known, none twice."""
    if not found:
        raise node.fail(f"the robot has no {what} here")
    for i, name in enumerate(found):
        if name not in known:
            raise node.each()[i].fail(f"there is no {what} {name!r}")
        if name in found[:i]:
            raise node.each()[i].fail(f"{name!r} stands here twice")


def _check_tree(node: Node, root: str, links: set[str], joints: dict[str, Joint]) -> None:
    reached = {root} & links
    while True:
        more = {j.child for j in joints.values() if j.parent in reached} - reached
        if not more:
            break
        reached |= more
    if reached != links or root in joints:
        raise node["joints"].fail(f"the links are not a tree that hangs on {root!r}")
