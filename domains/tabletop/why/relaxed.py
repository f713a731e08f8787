"""A task with some things away: what a smallest reason is tested on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from domains.tabletop.faces import faces_at
from domains.tabletop.features.functions import arrangement, obstructions
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.items import why_not
from domains.tabletop.memory import Memory
from domains.tabletop.state import State
from domains.tabletop.why.tested import FEW, can_pick, can_place
from domains.tabletop.world import TabletopWorld

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem


ASKED = 12
"""Objects that X is asked to take off before it stays open whether one is blocked for good."""


class Thing(NamedTuple):
    """Something that can be thought away: an object, by its number, or something fixed."""

    name: str
    number: int | None


def things_of(world: TabletopWorld, state: State, index: int) -> list[Thing]:
    """What can be thought away where an object is to get to its goal: all but what bears the
    object, its goal, or anything else. Fixed things first."""
    here = arrangement(world, state.placements)
    goal = world.goal_sites(index, here)
    used = {p.support for p in state.placements if p is not None}
    used |= set() if goal is None else {goal.support}
    bearing = {index, *here.standing_on(index)} | (set() if goal is None else set(goal.bearers))
    for support in used:
        owner = world.grounds[support].owner
        bearing |= set() if owner is None else here.standing_on(owner)
    names = {world.scene.supports[support].owner for support in used}
    fixed = [Thing(f.name, None) for f in world.scene.world.fixed if f.name not in names]
    objects = [
        Thing(world.items[i].name, i)
        for i, placement in enumerate(state.placements)
        if placement is not None and i not in bearing
    ]
    return fixed + objects


def without(
    problem: TabletopProblem, state: State, index: int, gone: frozenset[Thing]
) -> TabletopProblem:
    """The task that starts in a state, with some things away, and asks for the goal of one object
    only."""
    world = problem.world
    names = {thing.name for thing in gone if thing.number is None}
    absent = {thing.number for thing in gone if thing.number is not None}
    scene = world.scene
    inner = scene.world
    kept = tuple(thing for thing in inner.fixed if thing.name not in names)
    # Nothing can be put down on what is away: its supports shrink to nothing.
    supports = tuple(
        replace(support, half=(0.0, 0.0)) if support.owner in names else support
        for support in inner.supports
    )
    goals = {i: goal for i, goal in scene.goals.items() if i == index}
    relaxed_scene = replace(scene, world=replace(inner, fixed=kept, supports=supports), goals=goals)
    if names:
        relaxed = TabletopWorld.of(relaxed_scene, world.robot, world)
    else:
        relaxed = replace(world, scene=relaxed_scene, memory=Memory())
    placements = tuple(None if i in absent else p for i, p in enumerate(state.placements))
    return problem.of(relaxed, replace(state, placements=placements, world=relaxed))


def is_free(problem: TabletopProblem, state: State, index: int) -> bool:
    """Whether an object can get to its goal if all that a hand can move is out of the way: those
    objects are taken off one after the other, and nobody asks where to. What is impossible so is
    impossible for any sketch. X is asked only where the features see no more to take off, of what
    has the least around it, and of no more than `ASKED` objects: then nothing is proved."""
    asked = 0
    while True:
        others = [i for i in _standing(state) if i != index and _is_loose(problem, state, i)]
        more = [i for i in others if way_to_object(problem.world, state, i)]
        if not more:
            if can_go(problem, state, index):
                return True
            for other in sorted(others, key=lambda i: obstructions(state, i)):
                if asked == ASKED:
                    return True
                asked += 1
                if can_pick(problem, state, other, FEW):
                    more = [other]
                    break
        if not more:
            return False
        placements = tuple(None if i in more else p for i, p in enumerate(state.placements))
        state = replace(state, placements=placements)


def _standing(state: State) -> list[int]:
    return [i for i, placement in enumerate(state.placements) if placement is not None]


def can_go(problem: TabletopProblem, state: State, index: int) -> bool:
    """Whether an object can be picked up, if it is not held, and put at its goal, as things are."""
    world = problem.world
    goal = world.goal_sites(index, arrangement(world, state.placements))
    if goal is None:
        return True
    ready = (
        state.held == index
        or way_to_object(world, state, index)
        or can_pick(problem, state, index, FEW)
    )
    return ready and (
        way_to_goal(world, state, index, goal) or can_place(problem, state, index, goal, FEW)
    )


def _is_loose(problem: TabletopProblem, state: State, index: int) -> bool:
    """Whether nothing stands on an object, and a hand could hold it."""
    world = problem.world
    bears = arrangement(world, state.placements).bears(index)
    return not bears and why_not(world.items[index], world.hand, world.families) is None


def way_to_object(world: TabletopWorld, state: State, index: int) -> bool:
    """Whether the estimate of the features finds a way to an object that nothing bars."""
    return bool(families_to_object(world, state, index))


def families_to_object(world: TabletopWorld, state: State, index: int) -> list[int]:
    """The families of such ways."""
    here = arrangement(world, state.placements)
    return [
        family
        for family in world.families
        if int(here.picks[family].reachable[index]) & here.free_headings(index, family)
    ]


def way_to_goal(world: TabletopWorld, state: State, index: int, goal: GoalSites) -> bool:
    """The same for a site of its goal; where it is to be turned onto another face, that is
    taken for granted."""
    if faces_at(world, index, goal) != (0,):
        return True
    return bool(families_to_goal(world, state, index, goal))


def families_to_goal(world: TabletopWorld, state: State, index: int, goal: GoalSites) -> list[int]:
    """The families of such ways, for the object as it stands."""
    here, found = arrangement(world, state.placements), []
    grasp = state.grasp if state.held == index else None
    for family in world.families:
        ways = here.places_of(index, goal, family, grasp)
        free = ((ways.counts == 0) << np.arange(ways.counts.shape[1])).sum(axis=1)
        if (ways.reachable & free).any():
            found.append(family)
    return found
