"""Actions of plan files of version 1, which were picks and places of upright boxes.

A grip said only that the action's object is fixed to the gripper; where an object was put
stood beside the motion, as x, y, z of its bottom and its heading. The support was not named.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.motion.motion import ArmMove, Attach, BaseMove, GripperMove, Piece, Release
from runtime.plan.fields import base_poses_of, times_of
from runtime.plan.model import PlanAction, TimedPiece
from runtime.plan.node import Node, index_of, name_of
from runtime.world.poses import Floats


def action_of_version_1(node: Node, objects: list[str], subgoals: int) -> PlanAction:
    """An action of a file of version 1 (the keys that it does not know count for nothing)."""
    name = node["name"].choice("move_base", "pick", "place")
    thing = None if name == "move_base" else name_of(node["object"], objects)
    placement = node["placement"].numbers((4,)) if name == "place" else None
    subgoal = index_of(node["subgoal"], subgoals, "subgoal")
    pieces = tuple(_piece(entry, thing, placement) for entry in node["pieces"].each())
    arguments = {} if thing is None else {"object": thing}
    text = "drive" if thing is None else f"{name} {thing}"
    return PlanAction(name, text, subgoal, pieces, arguments)


def _piece(node: Node, thing: str | None, placement: Floats | None) -> TimedPiece:
    kind = node["type"].choice("base", "arm", "gripper")
    times = times_of(node)
    piece: Piece
    if kind == "base":
        piece = BaseMove(base_poses_of(node, len(times)))
    elif kind == "arm":
        piece = ArmMove(node["path"].numbers((len(times), None)), node["kind"].text())
    else:
        piece = _gripper(node, thing, placement)
    return TimedPiece(piece, times)


def _gripper(node: Node, thing: str | None, placement: Floats | None) -> GripperMove:
    flags = [node.get(key) for key in ("attach", "release")]
    attach, release = (flag is not None and flag.flag() for flag in flags)
    opening = node["opening"].number()
    if not attach and not release:
        return GripperMove(opening)
    if thing is None:
        raise node.fail("a base move cannot attach or release an object")
    if attach and release:
        raise node.fail("one piece cannot attach and release an object")
    if attach:
        return GripperMove(opening, Attach(thing, None))
    if placement is None:
        raise node.fail("a pick does not say where its object is put")
    x, y, z, yaw = placement.tolist()
    pose = np.array([x, y, z, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)])
    return GripperMove(opening, None, Release(thing, None, pose))
