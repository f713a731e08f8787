"""Whether hands aslant are thought of in a scene that names no approaches.

They cost the features time (ADR 23), so they join the others only where something hardly gets to
its goal by them: it is as low as a level hand is thick, and its goal as high as a hand from above
gets. What never moves decides, and nothing else, so that features stay functions of a state.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.faces import faces_at
from domains.tabletop.items import why_not
from domains.tabletop.state import SLANT

if TYPE_CHECKING:
    from domains.tabletop.features.goals import GoalSites
    from domains.tabletop.world import TabletopWorld

MARGIN = 0.05
"""Metres above a grasp to which an arm that gets there easily could reach as well, ..."""

BREADTH = 0.15
"""... with its wrist in an annulus of that breadth."""


def is_wanted(upright: TabletopWorld, aslant: TabletopWorld) -> bool:
    """Whether some object that hands can hold upright or level is hardly brought to its goal so,
    and better by one aslant. The worlds are the same scene without and with that."""
    return any(
        why_not(upright.items[index], upright.hand, upright.families) is None
        and not any(_leads(upright, index, goal, family, True) for family in upright.families)
        and not _is_turned(upright, index, goal)
        and _leads(aslant, index, goal, SLANT, False)
        for index, goal in _goals(upright)
    )


def _goals(world: TabletopWorld) -> list[tuple[int, GoalSites]]:
    """The objects that stand on furniture and have one goal that is there, too."""
    found = []
    for index, goal in world.goals.items():
        start = world.initial.placements[index]
        if (
            start is not None
            and world.grounds[start.support].owner is None
            and not goal.holds(start)
        ):
            found.append((index, goal))
    return found


def _is_turned(world: TabletopWorld, index: int, goal: GoalSites) -> bool:
    return faces_at(world, index, goal) != (0,)


def _leads(world: TabletopWorld, index: int, goal: GoalSites, family: int, easily: bool) -> bool:
    """Whether a hand can take an object where it starts, and put it at its goal."""
    at = world.rests(world.initial.placements, index)
    if at is None or not world.reachable_at(index, family, at):
        return False
    hold = world.place_hold(index, family, goal.world_yaw, None)
    if not world.reachable_goal(goal, index, family, hold).any():
        return False
    if not easily:
        return True
    heights = (at[2], float(np.max(goal.xyz[:, 2])))
    return all(_is_easy(world, family, height + hold.height) for height in heights)


def _is_easy(world: TabletopWorld, family: int, height: float) -> bool:
    found = world.hand.workspace(family, height + MARGIN)
    return found is not None and found[2] - found[1] >= BREADTH
