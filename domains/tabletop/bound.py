"""A lower bound of the time that any plan of a task takes, and why it is one.

Each object that is misplaced at the start has to be gripped and let go at least once; each of the
two takes the robot file's time for the gripper, in which the robot rests. Between gripping an
object and letting it go the base goes from a disc around the object, from which the arm reaches
it, to one around the nearest place where it may end; between letting go and gripping the next
one, from that place's disc to that of another object. Which object follows which is not
known: the cheapest assignment of a next object to each (every order is one, so none is cheaper)
bounds those ways. Each way takes at least the time from rest to rest at the limits of speed,
acceleration and jerk. What it leaves out: the arm's own motion, turns, ways around obstacles,
and objects that have to be moved more than once. Of a word, whose letters may be taken from
several objects, only how many blocks have to be moved is known, not which and where to.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from domains.tabletop.features.functions import arrangement, misplaced
from domains.tabletop.scene.model import AnyGoal, HeldGoal, PoseGoal, RegionGoal
from domains.tabletop.state import State
from domains.tabletop.world import TabletopWorld
from runtime.assignment import least_assignment
from runtime.motion.course import least_time
from runtime.robot.model import Floats

Box = tuple[float, float, float, float]
"""A rectangle of the floor: least x and y, largest x and y."""

STEPS = np.arange(0.0, 2.01, 0.05)
"""Heights (m) at which the arm's reach is asked for."""


def execution_bound(world: TabletopWorld, state: State) -> float:
    """Seconds that any plan from a state takes at least."""
    moved = sorted(misplaced(state))
    if not moved:
        return 0.0
    grips = 2 * world.robot.gripper.time
    if world.words is not None:
        here = arrangement(world, state.placements)
        held = grips / 2 if state.held is not None else 0.0  # it was gripped before
        return grips * max(1, world.words.fewest_moves(here)) - held
    if state.held is not None:
        return grips / 2
    froms = [_here(world, state, index) for index in moved]
    to = [_goal(world, index) for index in moved]
    reach = _reach(world)
    carried = sum(_way(world, a, b, reach) for a, b in zip(froms, to, strict=True))
    return len(moved) * grips + carried + _between(world, state, froms, to, reach)


def _between(
    world: TabletopWorld, state: State, froms: Sequence[Box], to: Sequence[list[Box]], reach: float
) -> float:
    """The least that going to a next object takes, from the start and after each object but the
    last one."""
    x, y, _ = state.base.pose
    count = len(froms)
    costs: Floats = np.zeros((count + 1, count + 1))
    for j, box in enumerate(froms):
        costs[0, j] = _way(world, box, [(x, y, x, y)], reach / 2)
        for i in range(count):
            costs[i + 1, j] = _way(world, box, to[i], reach) if i != j else 1e6
    costs[0, count] = 1e6  # something is first
    return least_assignment(costs)


def _way(world: TabletopWorld, box: Box, others: list[Box], reach: float) -> float:
    """Seconds of the base from within reach of a rectangle to within reach of one of others."""
    base = world.robot.base
    if not base.velocity or not others:
        return 0.0
    away = min(_apart(box, other) for other in others) - 2 * reach
    return least_time(max(0.0, away), base.velocity, base.acceleration, base.jerk)


def _apart(a: Box, b: Box) -> float:
    dx = max(a[0] - b[2], b[0] - a[2], 0.0)
    dy = max(a[1] - b[3], b[1] - a[3], 0.0)
    return math.hypot(dx, dy)


def _reach(world: TabletopWorld) -> float:
    """Metres from the base's axis to a grasp centre, at most."""
    farthest = 0.0
    for family in world.families:
        for height in STEPS.tolist():
            found = world.hand.workspace(family, height)
            if found is not None:
                farthest = max(farthest, found[2] + abs(found[0]))
    largest = max((math.hypot(*item.size[:2]) / 2 for item in world.items), default=0.0)
    return farthest + math.hypot(*world.shoulder.tolist()) + largest


def _here(world: TabletopWorld, state: State, index: int) -> Box:
    at = world.rests(state.placements, index)
    assert at is not None, "nothing is held"
    return at[0], at[1], at[0], at[1]


def _goal(world: TabletopWorld, index: int) -> list[Box]:
    """Where an object may end; empty where that may be anywhere."""
    goal = world.scene.goals.get(index)
    goals = goal.alternatives if isinstance(goal, AnyGoal) else (goal,)
    found: list[Box] = []
    for each in goals:
        if each is None or isinstance(each, HeldGoal):
            return []
        ground = world.grounds[each.support]
        if ground.owner is not None:
            return []
        if isinstance(each, PoseGoal):
            r = each.tolerance
            found.append((each.x - r, each.y - r, each.x + r, each.y + r))
        elif isinstance(each, RegionGoal):
            hx, hy = ground.half
            signs = [(sx, sy) for sx in (-1, 1) for sy in (-1, 1)]
            corners = np.array([ground.outside(sx * hx, sy * hy) for sx, sy in signs])
            low, high = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
            found.append((low[0], low[1], high[0], high[1]))
    return found
