"""Towers that goals describe, and whether there is room for one where its lowest object is.

Where one of several goals will do for an object, and others are to stand on it, some of these
goals may leave no room for what is to come: under a ceiling a tower of six does not fit where one
of three does. What counts is whether a hand gets in with each of the objects, and can lift it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.features.goals import GoalSites
from domains.tabletop.hand import LIFT
from domains.tabletop.scene.model import PoseGoal, RegionGoal
from domains.tabletop.state import PINCH
from runtime.world.poses import Floats, apply, upright

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement
    from domains.tabletop.world import TabletopWorld

ENOUGH = 2
"""Families of approaches with which it is easy to build a tower."""


@dataclass(frozen=True)
class Storey:
    """An object that is to stand on another one, or higher: its index, and the middle of its
    bottom in the standing frame of the lowest object, metres."""

    index: int
    x: float
    y: float
    z: float


def storeys(world: TabletopWorld, index: int) -> tuple[Storey, ...]:
    """What goals put on an object, directly and higher up, from below."""
    return world.memory.answer("storeys", index, lambda: tuple(_above(world, index, [index])))


def _above(world: TabletopWorld, index: int, below: list[int]) -> list[Storey]:
    found = []
    owned = world.owned.get(index, ())
    for other, goal in world.scene.goals.items():
        if not isinstance(goal, RegionGoal | PoseGoal) or goal.support not in owned:
            continue
        if other in below:
            continue  # goals that contradict each other are named elsewhere
        ground = world.grounds[goal.support]
        lx, ly = (goal.x, goal.y) if isinstance(goal, PoseGoal) else (0.0, 0.0)
        x, y = ground.outside(lx, ly)
        found.append(Storey(other, x, y, ground.height))
        found += [
            Storey(each.index, x + each.x, y + each.y, ground.height + each.z)
            for each in _above(world, other, [*below, other])
        ]
    return found


def ways(world: TabletopWorld, index: int, at: tuple[float, float, float, float]) -> int:
    """From how many sides at least a hand gets in with each of the objects that goals put on one,
    were that to rest at x, y, height and heading: that is, along how many families of approaches
    nothing that never moves is in the way, nor 3 cm higher."""

    def compute() -> int:
        return min(
            sum(_serves(world, each, at, family) for family in world.families)
            for each in storeys(world, index)
        )

    return world.memory.answer("ways to towers", (index, at), compute)


def _serves(
    world: TabletopWorld, storey: Storey, at: tuple[float, float, float, float], family: int
) -> bool:
    """Whether a hand of a family gets in with an object of a tower that stands there."""

    if family == PINCH:
        return False  # what bears it is in the way of the lower finger

    def compute() -> bool:
        site = apply(upright(*at), np.array([[storey.x, storey.y, storey.z]]))
        sites: Floats = np.vstack([site, site + np.array([0.0, 0.0, LIFT])])
        hold = world.place_hold(storey.index, family, None, None)
        low, high = world.reachable(sites, world.own(storey.index), hold, family).tolist()
        return bool(low & high)

    return world.memory.answer("hands at towers", (storey, at, family), compute)


def serving(here: Arrangement, index: int, families: Sequence[int]) -> Sequence[int]:
    """Those of some families with which an object can be put where it belongs in a tower, if the
    lowest object of that is in its place; all of them where that is not known."""
    world = here.world
    root = _root(world, index)
    if root == index or not here.present[root]:
        return families
    goal, placement = world.goal_sites(root, here), here.placements[root]
    at = world.rests(here.placements, root)
    if goal is None or placement is None or at is None or not goal.holds(placement):
        return families
    storey = next((each for each in storeys(world, root) if each.index == index), None)
    if storey is None:
        return families
    return [f for f in families if _serves(world, storey, at, f)] or families


def _root(world: TabletopWorld, index: int) -> int:
    """The lowest object of the tower to which an object belongs by the goals."""
    found = [index]
    while True:
        goal = world.scene.goals.get(found[-1])
        if not isinstance(goal, RegionGoal | PoseGoal):
            return found[-1]
        owner = world.grounds[goal.support].owner
        if owner is None or owner in found:
            return found[-1]
        found.append(owner)


def most_ways(world: TabletopWorld, index: int, goal: GoalSites) -> int:
    """The same where there are most of them, of the sites of a goal; ENOUGH on what can move."""
    if goal.frame is not None:
        return ENOUGH
    yaw = goal.world_yaw or 0.0
    return max(ways(world, index, (x, y, z, yaw)) for x, y, z in goal.xyz.tolist())


def with_room(here: Arrangement, index: int, choices: Sequence[GoalSites]) -> Sequence[GoalSites]:
    """Those of several goals of an object at which there is room for all that is to stand on it:
    from two sides where that can be had, for what has been put aside can often be taken in one
    way only. A goal that holds is judged by where the object is; it is left only if the object
    can be taken there."""
    world = here.world
    placement, at = here.placements[index], world.rests(here.placements, index)
    found: list[int] = []
    for sites in choices:
        holds = placement is not None and sites.holds(placement)
        if holds and at is not None and sites.frame is None:
            found.append(ways(world, index, at))
            if found[-1] and not here.is_reachable(index):
                return [sites]
        else:
            found.append(most_ways(world, index, sites))
    enough = min(ENOUGH, max(found, default=0))
    return [sites for sites, number in zip(choices, found, strict=True) if number >= enough]
