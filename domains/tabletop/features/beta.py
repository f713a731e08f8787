"""beta: whether an object would disturb others at a placement (paper, Sketch, SIW_R).

That is exact one placement at a time (`disturbed_by`), and quick for the sites of a goal all
together (`has_harmless_site`).
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.faces import faces_at
from domains.tabletop.features.alpha import Thought, obstructions_with
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.ways import Places, place_barred
from domains.tabletop.loads import tall
from domains.tabletop.state import Placement
from runtime.kernels.plane import point_distance
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement
    from domains.tabletop.world import Ints

Circle = tuple[float, float, float]
"""x, y (m) of the middle, and the radius."""

NOTHING_BARRED: NDArray[np.bool_] = np.ones(1, dtype=np.bool_)
"""All of some boxes are fine."""


def disturbed_by(
    here: Arrangement, index: int, placement: Placement, misplaced: frozenset[int]
) -> int:
    """How many other misplaced objects would be obstructed more, were an object there.

    The object itself must be away in this arrangement.
    """
    world = here.world
    at = world.rests_at(here.placements, index, placement)
    if at is None:
        return 1  # on something in the hand, or on what stands on the object itself
    box = world.box_row(index, at, placement.face)
    if world.owned:
        box[5] = tall(world, here.placements, index, placement.face) / 2
        box[2] = at[2] + box[5]
    extra = Thought(here, index, box)
    owner = world.grounds[placement.support].owner
    below = frozenset() if owner is None else here.standing_on(owner)
    others = frozenset(i for i in misplaced if i != index and here.present[i])
    count = len(others & below)
    if not count and not extra.bars.any() and _leaves_places(here, box[None], others)[0]:
        return 0
    for other in others - below:
        goal = world.goal_sites(other, here)
        if goal is None:
            continue
        before = here.obstructions(other, goal)
        if not _both_far(here, extra, other, goal) or (before > 0 and extra.bars.any()):
            count += obstructions_with(here, other, goal, None, extra) > before
    return count


def has_harmless_site(
    here: Arrangement, index: int, goal: GoalSites, others: frozenset[int]
) -> bool:
    """Whether an object could go to a site of its goal, on furniture, where it certainly is in
    nobody's way: it bars no heading to any object, and leaves a free one to the goals of the
    others. That holds, too, once the object itself is away."""
    world = here.world
    key = (goal.key, world.kinds[index])
    harmless = here.site_table(index, goal).harmless(index)
    if not harmless.any():
        return False
    groups = _groups_of(here, others)
    alone = next((g for g in groups if groups[g] == (index,)), None)
    # Of one kind with one goal any will do, but where things ride on each other.
    question = (key, others, alone, index if world.owned else None)
    if question not in here.left:
        boxes = world.site_boxes(index, goal)
        asked = [group[group[0] == index] for g, group in groups.items() if g != alone]
        here.left[question] = _leaves_places(here, boxes, asked, known_as=key)
    return bool((harmless & here.left[question]).any())


def _groups_of(here: Arrangement, others: frozenset[int]) -> dict[Hashable, tuple[int, ...]]:
    """Objects that stand somewhere, the first two of each kind with the same goal."""
    if others not in here.groups:
        found: dict[Hashable, tuple[int, ...]] = {}
        for other in sorted(others):
            goal = here.world.goal_sites(other, here)
            if here.present[other] and goal is not None:
                group = (goal.key, here.world.kinds[other], here.face(other, None))
                found[group] = (*found.get(group, ()), other)[:2]
        here.groups[others] = found
    return here.groups[others]


def _leaves_places(
    here: Arrangement, boxes: Floats, others: Iterable[int], known_as: Hashable = None
) -> NDArray[np.bool_]:
    """Which boxes (b, 8), thought to be there one at a time, bar nothing on the way to the
    goals of others, or leave free ways to other sites of these (b,). `known_as` names boxes
    that are always the same, and what they bar is remembered."""
    world, seen = here.world, set()
    circle = _circle_around(here, boxes, known_as)
    fine = np.ones(len(boxes), dtype=np.bool_)
    for other in others:
        goal = world.goal_sites(other, here)
        if goal is None or here.waits(goal) or (goal.key, world.kinds[other]) in seen:
            continue
        if faces_at(world, other, goal) != (0,) or here.face(other, None):
            return np.zeros(len(boxes), dtype=np.bool_)  # it is turned on its way there
        seen.add((goal.key, world.kinds[other]))
        if goal.frame is None and _is_apart(here, circle, other, goal):
            continue
        places = {f: here.places_of(other, goal, f) for f in world.families}
        # Where no site is reached anyway there is nothing to lose.
        open_ones = {f: ways for f, ways in places.items() if ways.reachable.any()}
        for family, ways in (open_ones or places).items():
            spared = ways.spared.get(known_as)
            if spared is None:
                spared = _spared(here, ways, family, boxes, known_as, world.kinds[other])
                if known_as is not None:
                    ways.spared[known_as] = spared
            if spared is not NOTHING_BARRED:
                fine &= spared
    return fine


def _circle_around(here: Arrangement, boxes: Floats, known_as: Hashable) -> Circle:
    """A circle that boxes (b, 8) are within."""

    def compute() -> Circle:
        middle = (boxes[:, :2].min(axis=0) + boxes[:, :2].max(axis=0)) / 2
        away = np.hypot(*(boxes[:, :2] - middle).T) + np.hypot(boxes[:, 3], boxes[:, 4])
        return float(middle[0]), float(middle[1]), float(away.max())

    if known_as is None:
        return compute()
    return here.world.memory.answer("circles around sites", known_as, compute)


def _is_apart(here: Arrangement, circle: Circle, other: int, goal: GoalSites) -> bool:
    """Whether what is in a circle bars no way of another object to its goal, on furniture, whatever
    it is: it is too far away from all of the goal."""

    def compute() -> float:
        ways = [here.places_of(other, goal, family) for family in here.world.families]
        return max(max(here.reach(each.hold), each.extent) for each in ways)

    question = (goal.key, here.world.kinds[other])
    reach = here.world.memory.answer("reaches around goals", question, compute)
    (x, y), radius = goal.circle
    return math.hypot(circle[0] - x, circle[1] - y) > radius + reach + circle[2]


def _spared(
    here: Arrangement, ways: Places, family: int, boxes: Floats, known_as: Hashable, kind: int
) -> NDArray[np.bool_]:
    """Which boxes (b,) bar nothing on the ways to the sites of a goal, or leave a way free to
    one of them where any will do."""
    plus = _barred_by(here, ways, family, boxes, known_as, kind)
    if plus is None:
        return NOTHING_BARRED
    harmless: NDArray[np.bool_] = np.logical_not(plus.any(axis=0))
    if ways.goal.modulus == 1:
        harmless |= (ways.free[:, None] & ~plus).any(axis=0)
    return harmless


def _barred_by(
    here: Arrangement, ways: Places, family: int, boxes: Floats, known_as: Hashable, kind: int
) -> Ints | None:
    """Bits (S, b) of the headings to the sites of a goal that boxes bar; None where they bar
    none: most goals are far from each other."""

    def compute() -> Ints | None:
        found = place_barred(here.world, ways, family, boxes)
        return found if found.any() else None

    if known_as is None or ways.goal.frame is not None:
        return compute()
    if _all_far(here, ways, boxes):
        return None
    question = (known_as, ways.goal.key, kind, family, ways.hold.key)
    return here.world.memory.answer("sites bar sites", question, compute)


def _all_far(here: Arrangement, ways: Places, boxes: Floats) -> bool:
    """Whether boxes (b, 8) are too far from the sites of a goal to bar a way to any of them, by
    circles around all of them."""
    (x, y), radius = ways.goal.circle
    reach = radius + max(here.reach(ways.hold), ways.extent)
    away = np.hypot(boxes[:, 0] - x, boxes[:, 1] - y) - np.hypot(boxes[:, 3], boxes[:, 4])
    return bool(away.min() > reach)


def _both_far(here: Arrangement, extra: Thought, other: int, goal: GoalSites) -> bool:
    """Whether a box is too far from an object and from its goal to be in its way."""
    (x, y), radius = goal.circle
    hold = here.world.place_hold(other, here.world.families[0], goal.world_yaw, None)
    reach = here.reach(hold) + 2 * here.world.radius(other)
    site = here.sites[other]
    return bool(
        point_distance(extra.box, site[0], site[1]) > reach
        and point_distance(extra.box, x, y) > reach + radius
    )
