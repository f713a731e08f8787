"""Goals of several objects on one support that leave no room for each other."""

from __future__ import annotations

import math

import numpy as np

from domains.tabletop.features.functions import arrangement, misplaced
from domains.tabletop.footprints import footprints_meet
from domains.tabletop.room import room_on
from domains.tabletop.state import State
from domains.tabletop.why.finding import Finding, finding
from domains.tabletop.world import TabletopWorld
from runtime.world.poses import Floats

ROUNDS = 40
"""Times that all objects of a support are put on it anew."""

SPOTS = 60
"""Places that are tried for each of them."""

MOST = 40
"""Objects of one support above which nothing is tried."""


def crowded(world: TabletopWorld, state: State) -> list[Finding]:
    """Supports on which the objects that belong there, and are not held off by anything else, were
    never all put down at random. What is tried may have been bad luck: nothing here is certain."""
    here = arrangement(world, state.placements)
    groups: dict[int, list[int]] = {}
    wanting = misplaced(state)
    for index in range(len(world.items)):
        goal = world.goal_sites(index, here)
        if goal is not None and goal.region is not None and goal.frame is None:
            groups.setdefault(goal.support, []).append(index)
    found = []
    for support, group in groups.items():
        coming = [i for i in group if i in wanting]
        if not coming or not 1 < len(group) <= MOST:
            continue
        most = _most(world, support, group)
        if most < len(group):
            ground = world.grounds[support]
            text = (
                f"{ground.name} has room for {most} of the {len(group)} objects that shall be on "
                f"it, as far as {ROUNDS} ways to put them there tell"
            )
            others = [world.items[i].name for i in group if i != coming[0]]
            name = world.items[coming[0]].name
            found.append(
                finding(name, "too small", text, certain=False, tested=True, others=others)
            )
    return found


def _most(world: TabletopWorld, support: int, group: list[int]) -> int:
    """The most objects of a group that were put on a support, the largest ones first."""
    rng = np.random.default_rng(0)
    group = sorted(group, key=lambda i: -world.items[i].outer_radius)
    best = 0
    for _ in range(ROUNDS):
        standing: list[Floats] = []
        for index in group:
            row = _spot(world, support, index, standing, rng)
            if row is not None:
                standing.append(row)
        best = max(best, len(standing))
        if best == len(group):
            break
    return best


def _spot(
    world: TabletopWorld, support: int, index: int, standing: list[Floats], rng: np.random.Generator
) -> Floats | None:
    """An upright box (8,) around an object at a random free place, None if none was found."""
    ground, item = world.grounds[support], world.items[index]
    spans, headings = room_on(ground, item)
    if spans is None:
        return None
    for _ in range(SPOTS):
        x, y = (float(rng.uniform(-span, span)) for span in spans)
        # Along the sides of the support most fit.
        quarter = ground.yaw + math.pi / 2 * int(rng.integers(4))
        yaw = quarter if rng.random() < 0.5 else float(rng.uniform(0, 2 * math.pi))
        if headings is not None:
            yaw = headings[int(rng.integers(len(headings)))]
        wx, wy = ground.outside(x, y)
        row = world.box_row(index, (wx, wy, ground.height, yaw))
        if not any(footprints_meet(row, other, 0.0) for other in standing):
            return row
    return None
