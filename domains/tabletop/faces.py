"""Faces: the sides that an object can stand on, and the same grasp seen from each of them.

Face 0 is the side on which an object stands at the start. Another one is only thought of where
no hand could put the object at its goal on that: a flat carton that is taken across the edge
of a table lies on the lower finger, and has to be stood up before it can be let go.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from domains.tabletop.features.swept import HEADINGS, near_headings
from domains.tabletop.items import Item
from domains.tabletop.room import has_room
from domains.tabletop.scene.model import AnyGoal, PoseGoal, RegionGoal, SceneObject
from domains.tabletop.state import PINCH, SIDE, SLANT, SLOPE, TOP, Grasp
from runtime.world.poses import Floats, Pose, compose, invert
from runtime.world.stable import ANY_TURN, StablePose
from runtime.world.world import Movable

if TYPE_CHECKING:
    from domains.tabletop.features.goals import GoalSites
    from domains.tabletop.world import TabletopWorld

MOST = 6
"""Faces of an object that are thought of, at most."""

STEADY = 0.05
"""Radians by which an object has to be tilted on a face before it falls over, at least."""

SQUARE = 2e-4
"""Radians by which a hand may be off the level to count as level."""

SQUARE_SIDES = 12
"""Headings of the hand that are tried for turning an object, at most."""


class Turn(NamedTuple):
    """One way to take an object and to put it on another face: by which family, along which
    heading in the standing frame of the face on which it is taken (radians), and the grasp as
    it is seen from the other face."""

    family: int
    angle: float
    there: Grasp


def faces_of(told: SceneObject, thing: Movable, first: Item) -> tuple[Item, ...]:
    """An object on each of its faces, the one at the start first; none on which it looks as at
    the start, rolls, or falls over easily. Opposite sides count as two, however alike: a hand that
    holds the object at one end can put it on the other end only."""
    found, alike = [first], told.stable[told.rests.stable].like
    for stable in told.stable:
        if stable.like == alike or stable.rolls or len(found) == MOST:
            continue
        symmetry = HEADINGS if stable.symmetry == ANY_TURN else max(1, stable.symmetry)
        item, _ = Item.of(replace(thing, pose=stable.pose), 0.0, symmetry, len(found))
        if _steadiness(stable, item) > STEADY:
            found.append(item)
    return tuple(found)


def _steadiness(stable: StablePose, item: Item) -> float:
    """Radians by which it can be tilted before its centre of mass is over its edge."""
    polygon = stable.polygon
    centre = compose(stable.pose, np.column_stack([np.eye(3), item.body.centre]))[:, 3]
    along = np.roll(polygon, -1, axis=0) - polygon
    to = centre[:2] - polygon
    area = along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]
    room = float((area / np.linalg.norm(along, axis=1)).min())
    return math.atan2(room, float(centre[2]))


def turned(world: TabletopWorld, index: int, grasp: Grasp, face: int) -> Grasp | None:
    """A grasp as it is seen from another face of the object; None where the hand would come
    neither level nor from straight above, nor halfway between."""
    if face == grasp.face:
        return grasp
    key = (world.kinds[index], grasp, face)
    return world.memory.answer("turned", key, lambda: _turned(world, index, grasp, face))


def _turned(world: TabletopWorld, index: int, grasp: Grasp, face: int) -> Grasp | None:
    here, there = world.item(index, grasp.face), world.item(index, face)
    tool = compose(there.standing, compose(invert(here.standing), grasp.tool))
    found = grasp_at(tool, face)
    return found if found is not None and found.family in world.families else None


def grasp_at(tool: Pose, face: int) -> Grasp | None:
    """The grasp with the tool at a pose (3, 4) in the standing frame of a face."""
    (x, y), rise = tool[:2, 0].tolist(), float(tool[2, 0])
    sideways = float(tool[2, 1])
    flipped = False
    if abs(rise) < SQUARE and abs(sideways) < SQUARE:
        family, flipped = SIDE, bool(tool[2, 2] < 0)
    elif abs(rise) < SQUARE and abs(sideways) > 1 - SQUARE**2:
        family, flipped = PINCH, sideways < 0
    elif abs(rise + SLOPE) < SQUARE and abs(sideways) < SQUARE:
        family, flipped = SLANT, bool(tool[2, 2] < 0)
    elif rise < -1 + SQUARE**2:
        family = TOP
        x, y = tool[:2, 2].tolist()
    else:
        return None
    heading = math.atan2(y, x)
    c, s = math.cos(heading), math.sin(heading)
    px, py, height = tool[:, 3].tolist()
    return Grasp.of(heading, height, flipped, family, c * px + s * py, c * py - s * px, face)


def turns(world: TabletopWorld, index: int, face: int, to: int) -> tuple[Turn, ...]:
    """The ways to take an object that stands on one face and to put it on another one."""
    key = (world.kinds[index], face, to)
    return world.memory.answer("turns", key, lambda: tuple(_turns(world, index, face, to)))


def _turns(world: TabletopWorld, index: int, face: int, to: int) -> Iterator[Turn]:
    item = world.item(index, face)
    angles: Floats = item.sides[:SQUARE_SIDES]
    if not len(angles):
        angles = np.arange(4.0) * (math.pi / 2)
    for family in world.families:
        hold = item.holds(world.hand, family, angles)
        if hold is None:
            continue
        for k in np.flatnonzero(hold.fits).tolist():
            there = turned(world, index, item.grasp(hold, k, float(angles[k])), to)
            if there is not None:
                yield Turn(family, float(angles[k]), there)


def faces_at(world: TabletopWorld, index: int, goal: GoalSites | None) -> tuple[int, ...]:
    """The faces on which an object may be put, at a goal or (None) anywhere: the one at the
    start, where as far as fixed things are concerned a hand could put it there, else those on
    which one could. What never moves decides, and nothing else."""
    if not can_turn(world, index, goal):
        return (0,)
    if goal is None:
        return world.memory.answer("loose faces", index, lambda: _loose_faces(world, index))
    key = (index, goal.key if goal.frame is None else goal.support)
    return world.memory.answer("faces", key, lambda: _faces_at(world, index, goal))


def is_turned(world: TabletopWorld, index: int) -> bool:
    """Whether some goal on what does not move wants an object on another face than that of the
    start: what stands on it has to be taken off first."""
    return world.memory.answer("is turned", index, lambda: _is_turned(world, index))


def _is_turned(world: TabletopWorld, index: int) -> bool:
    goal = world.scene.goals.get(index)
    singles = goal.alternatives if isinstance(goal, AnyGoal) else (goal,)
    return any(
        faces_at(world, index, world.sites_of(index, single, None)) != (0,)
        for single in singles
        if isinstance(single, RegionGoal | PoseGoal) and world.grounds[single.support].owner is None
    )


def can_turn(world: TabletopWorld, index: int, goal: GoalSites | None) -> bool:
    """Whether an object may be put on another face at all: nothing needs it to bear something,
    and no heading is asked for, which is that of the face at the start."""
    many = len(world.faces[index]) > 1 and index not in world.bases
    return many and (goal is None or goal.yaw is None)


def _loose_faces(world: TabletopWorld, index: int) -> tuple[int, ...]:
    """Of an object that may be put anywhere: on its own face unless it can only be taken across
    an edge, where the lower finger would be between it and what it is put on."""
    ways = {family for family in world.families if _start_ways(world, index, family)}
    if ways != {PINCH}:
        return (0,)
    return _others(world, index, None) or (0,)


def _faces_at(world: TabletopWorld, index: int, goal: GoalSites) -> tuple[int, ...]:
    ways = [family for family in world.families if _start_ways(world, index, family)]
    ground, item = world.grounds[goal.support], world.items[index]
    if not ways:
        return (0,)
    if goal.region is None or has_room(ground, item):
        if goal.frame is not None:
            # What is wider than its support can be put there with a finger under it.
            if ways != [PINCH] or min(item.size[:2]) > 2 * max(ground.half):
                return (0,)
        elif any(_placeable(world, index, goal, family, None) for family in ways):
            return (0,)
    return _others(world, index, goal) or (0,)


def _start_ways(world: TabletopWorld, index: int, family: int) -> int:
    """Bits of the headings along which an object can be taken where it starts."""
    placements = world.initial.placements
    at = world.rests(placements, index)
    return 0 if at is None else world.reachable_at(index, family, at)


def _others(world: TabletopWorld, index: int, goal: GoalSites | None) -> tuple[int, ...]:
    """Other faces than that at the start on which an object could be put, the lowest first."""
    at = world.rests(world.initial.placements, index)
    assert at is not None
    found = []
    for item in world.faces[index][1:]:
        if goal is not None and not has_room(world.grounds[goal.support], item):
            continue
        for turn in turns(world, index, 0, item.face):
            start = _start_ways(world, index, turn.family)
            if start & near_headings(turn.angle + at[3]) and (
                goal is None
                or goal.frame is not None
                or _placeable(world, index, goal, turn.there.family, turn.there)
            ):
                found.append(item)
                break
    return tuple(item.face for item in sorted(found, key=lambda item: item.size[2]))


def _placeable(
    world: TabletopWorld, index: int, goal: GoalSites, family: int, grasp: Grasp | None
) -> bool:
    """Whether some way leads to a site of a goal past what never moves."""
    hold = world.place_hold(index, family, goal.world_yaw, grasp)
    face = 0 if grasp is None else grasp.face
    return bool(world.reachable_goal(goal, index, family, hold, face).any())
