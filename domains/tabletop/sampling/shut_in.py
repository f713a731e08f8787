"""What to pick up first where things on the floor shut the robot in.

With one of the things that stand around it in the hand it gets out, with any other one it would
stand there and could not bring it anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from domains.tabletop.faces import faces_at, turned
from domains.tabletop.features.functions import arrangement
from domains.tabletop.state import Grasp, State
from domains.tabletop.world import TabletopWorld
from runtime.motion.room import Room

Picks = list[tuple[int, tuple[Grasp, ...]]]


def leading_on(
    world: TabletopWorld, room_in: Callable[[State], Room], state: State, picks: Picks
) -> Picks:
    """Of objects with their grasps those which the robot can bring to where they belong, or which
    belong nowhere, as far as its way is concerned; all of them where that is true of none.
    `room_in` tells the room of the robot in a state."""
    room = room_in(state)
    if world.is_fixed or room is world.room:
        return picks
    found = [
        (index, grasps)
        for index, grasps in picks
        if _is_brought(world, room, state, index, grasps)
        or _is_brought(world, room_in(state.picked(index, grasps[0])), state, index, grasps)
    ]
    return found or picks


def _is_brought(
    world: TabletopWorld, room: Room, state: State, index: int, grasps: Sequence[Grasp]
) -> bool:
    """Whether, from a room, the robot can stand where an object belongs with one of some grasps;
    what never moves decides, and what makes the room."""
    goal = world.goal_sites(index, arrangement(world, state.placements))
    if goal is None:
        return True
    elsewhere = replace(world, room=room)
    for face in faces_at(world, index, goal):
        own = world.own(index, face)
        for grasp in grasps:
            there = turned(world, index, grasp, face)
            if there is None:
                continue
            hold = world.place_hold(index, there.family, goal.world_yaw, there)
            if elsewhere.reachable(goal.xyz, own, hold, there.family).any():
                return True
    return False
