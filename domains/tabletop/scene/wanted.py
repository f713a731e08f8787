"""The goals of a scene as what is wanted of its world, for those who know worlds only."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from domains.tabletop.scene.furniture import local
from domains.tabletop.scene.model import (
    AnyGoal,
    Goal,
    HeldGoal,
    PoseGoal,
    RegionGoal,
    SceneObject,
    WordGoal,
    bearing,
)
from runtime.world import goals as wanted
from runtime.world.poses import heading
from runtime.world.stable import ANY_TURN
from runtime.world.world import Support


def wanted_of(
    goals: Mapping[int, Goal],
    word: WordGoal | None,
    objects: Sequence[SceneObject],
    supports: Sequence[Support],
) -> tuple[wanted.Goal, ...]:
    """What a world has to fulfil, in the order of the objects."""
    return tuple(_all(goals, word, objects, supports))


def _all(
    goals: Mapping[int, Goal],
    word: WordGoal | None,
    objects: Sequence[SceneObject],
    supports: Sequence[Support],
) -> Iterator[wanted.Goal]:
    exact = bearing(goals, objects, supports)
    for index, goal in goals.items():
        yield _one(goal, objects[index], objects, supports, index in exact)
    if word is not None:
        name = supports[word.support].name
        yield wanted.Spelled(word.word, name, word.pitch, word.tolerance)


def _one(
    goal: Goal,
    thing: SceneObject,
    objects: Sequence[SceneObject],
    supports: Sequence[Support],
    exact: bool,
) -> wanted.Goal:
    """What a goal asks; `exact` where turns that the shape does not tell count."""
    match goal:
        case RegionGoal():
            return wanted.RestsOn(thing.name, supports[goal.support].name)
        case HeldGoal():
            return wanted.IsHeld(thing.name)
        case AnyGoal():
            return wanted.AnyOf(
                tuple(_one(each, thing, objects, supports, exact) for each in goal.alternatives)
            )
        case PoseGoal():
            return _at(goal, thing, objects, supports[goal.support], exact)


def _at(
    goal: PoseGoal,
    thing: SceneObject,
    objects: Sequence[SceneObject],
    support: Support,
    exact: bool,
) -> wanted.RestsAt:
    x, y, yaw = goal.x, goal.y, goal.yaw
    if all(support.owner != other.name for other in objects):
        (x, y), turn = local(support, x, y), heading(support.pose)
        yaw = None if yaw is None else yaw - turn
    symmetry = thing.stable[thing.rests.stable].symmetry
    if exact:
        symmetry = 1
    elif symmetry == ANY_TURN:
        yaw = None
    return wanted.RestsAt(
        thing.name, support.name, x, y, goal.tolerance, yaw, symmetry=max(1, symmetry)
    )
