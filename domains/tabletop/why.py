"""Why there is no plan: what is known before a search, and what can be said after one.

Before: objects that no hand can take, and objects or goals that no pose of the robot reaches
even with nothing else about. The estimate of the features names candidates; X, asked many times
with all other objects away, has the last word.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from domains.tabletop.actions.actions import Pick, Place
from domains.tabletop.faces import faces_at
from domains.tabletop.features import swept
from domains.tabletop.features.functions import (
    arrangement,
    disturbances,
    misplaced,
    obstructions,
)
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import HEADINGS
from domains.tabletop.ground import Ground
from domains.tabletop.items import why_not
from domains.tabletop.room import has_room
from domains.tabletop.sampling.draw import Draw
from domains.tabletop.state import Grasp, State
from domains.tabletop.world import TabletopWorld
from runtime.kernels.plane import point_distance
from runtime.search.problem import Rejection
from runtime.search.siw_r import Outcome

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem

Finding = dict[str, Any]

TRIES = 40
"""Manipulations that X is asked for before something counts as out of reach."""

SEEDS = 12

BESIDE = 0.05
"""Metres from a support within which something that rises above it counts as its wall."""


def before(problem: TabletopProblem) -> list[Finding]:
    """What makes the task hopeless, object by object; empty where nothing does."""
    state = problem.world.initial
    here = arrangement(problem.world, state.placements)
    found = []
    for index in sorted(misplaced(state)):
        goal = problem.world.goal_sites(index, here)
        if goal is not None:
            finding = _hopeless(problem, state, index, goal)
            if finding is not None:
                found.append(finding)
    return found


def _hopeless(
    problem: TabletopProblem, state: State, index: int, goal: GoalSites
) -> Finding | None:
    world = problem.world
    item = world.items[index]
    cannot = why_not(item, world.hand, world.families)
    if cannot is not None:
        return _finding(item.name, "cannot be grasped", f"{item.name} {cannot}")
    resting = state.placements[index]
    assert resting is not None
    ground = world.grounds[goal.support]
    if faces_at(world, index, goal) != (0,):
        return None  # on another side some way leads there
    if goal.region is not None and not has_room(ground, item):
        text = f"{item.name} does not fit on {ground.name}: it is larger than the room there"
        return _finding(item.name, "does not fit", text)
    here = arrangement(world, state.placements)
    alone = replace(
        state, placements=tuple(p if i == index else None for i, p in enumerate(state.placements))
    )
    fixed = world.grounds[resting.support].owner is None
    if fixed and not here.is_reachable(index) and _executable_pick(problem, alone, index) is None:
        text = f"{item.name} is out of reach: {_barred(world, alone, index)}"
        return _finding(item.name, "out of reach", text)
    known = goal.frame is None and fixed
    if known and not _is_reachable(world, index, goal):
        if _executable_place(problem, alone, index, goal):
            return None
        name, why = world.grounds[goal.support].name, _why_goal(world, index, goal)
        text = f"the goal of {item.name} on {name} is out of reach: {why}"
        return _finding(item.name, "goal out of reach", text)
    return None


def _finding(name: str, cause: str, text: str) -> Finding:
    return {"object": name, "cause": cause, "text": text}


def _is_reachable(world: TabletopWorld, index: int, goal: GoalSites) -> bool:
    """Whether the estimate finds a way to a site of a goal that nothing fixed bars."""
    for family in world.families:
        hold = world.place_hold(index, family, goal.world_yaw, None)
        if world.reachable_goal(goal, index, family, hold).any():
            return True
    return False


def _grasps(world: TabletopWorld, state: State, index: int) -> list[Grasp]:
    """Grasps of an object where it rests, a heading of each family at a time."""
    at = world.rests(state.placements, index)
    assert at is not None
    item = world.items[index]
    found = []
    for k in sorted(range(HEADINGS), key=lambda k: (k % 6, k % 3, k)):
        for family in world.families:
            angle = float(world.hold(index, family, at[3]).angles[k]) - at[3]
            hold = item.holds(world.hand, family, np.array([angle]))
            if hold is not None and hold.fits[0]:
                found.append(item.grasp(hold, 0, angle))
    return found


def _executable_pick(problem: TabletopProblem, state: State, index: int) -> Grasp | None:
    """A grasp with which X can pick an object up with nothing else about, of many tried."""
    placement = state.placements[index]
    assert placement is not None
    rng = np.random.default_rng(problem.executor.seed)
    for _, grasp in zip(range(TRIES), _again(_grasps(problem.world, state, index)), strict=False):
        for narrow in (False, True):
            base = problem.sampler.bases.stand(state, index, placement, grasp, rng, narrow)
            if base is not None:
                there = state.driven(base)
                answer = Pick(index, grasp).motion(problem.executor, there, SEEDS)
                if not isinstance(answer, Rejection):
                    return grasp
    return None


def _executable_place(problem: TabletopProblem, state: State, index: int, goal: GoalSites) -> bool:
    """Whether X can put an object at a goal with nothing else about, of many tries."""
    world = problem.world
    rng = np.random.default_rng(problem.executor.seed)
    for _, grasp in zip(range(TRIES), _again(_grasps(world, state, index)), strict=False):
        held = state.picked(index, grasp)
        draw = Draw(held, 2, rng)
        for placement in problem.sampler.placements.at_goal(draw, goal, 2)[:2]:
            for narrow in (False, True):
                base = problem.sampler.bases.stand(held, index, placement, grasp, rng, narrow)
                if base is None:
                    continue
                there = held.driven(base)
                answer = Place(index, placement).motion(problem.executor, there, SEEDS)
                if not isinstance(answer, Rejection):
                    return True
    return False


def _again(grasps: list[Grasp]) -> Iterator[Grasp]:
    while grasps:
        yield from grasps


def _barred(world: TabletopWorld, state: State, index: int) -> str:
    """What fixed things bar the ways to an object that rests alone."""
    at = world.rests(state.placements, index)
    assert at is not None
    site = np.array([at[:3]])
    return _ways(world, index, site, lambda family: world.hold(index, family, at[3]))


def _why_goal(world: TabletopWorld, index: int, goal: GoalSites) -> str:
    yaw = goal.world_yaw
    return _ways(world, index, goal.xyz, lambda f: world.place_hold(index, f, yaw, None))


def _ways(world: TabletopWorld, index: int, sites: np.ndarray, hold_of: Any) -> str:
    """One clause for each family of approaches: what is in its way."""
    owners = [thing.name for thing in world.scene.world.fixed for _ in thing.body.parts]
    clauses = []
    for family in world.families:
        hold = hold_of(family)
        if not hold.fits:
            continue
        barring: Counter[str] = Counter()
        open_ways = 0
        for site in sites:
            bits = [
                swept.open_headings(
                    site[None], hold.rows, hold.height, world.own(index), row[None],
                    world.hand.sweeps[family],
                )[0]
                for row in world.statics
            ]  # fmt: skip
            both = int(np.bitwise_and.reduce(np.array(bits, dtype=np.int64))) if bits else swept.ALL
            open_ways |= both & hold.fits
            for owner, free in zip(owners, bits, strict=True):
                if hold.fits & ~int(free):
                    barring[owner] += 1
        if open_ways:
            clauses.append(f"{_from(family)} there is nowhere to stand, or the arm is too short")
        elif barring:
            things = [name for name, _ in barring.most_common(2)]
            are = "is" if len(things) == 1 else "are"
            clauses.append(f"{_from(family)} {' and '.join(things)} {are} in the way")
    return "; ".join(clauses) or "no hand fits there"


def _from(family: int) -> str:
    return ("from the side", "from above", "across its edge")[family]


def after(world: TabletopWorld, outcome: Outcome) -> list[Finding]:
    """What keeps each misplaced object from its goal where a search ended, by the estimate of
    the features and by what X refused."""
    state = outcome.state
    here = arrangement(world, state.placements)
    refused = Counter((r.about, r.step) for r in outcome.rejections)
    found = []
    held = set() if state.held is None else {state.held}
    for index in sorted(misplaced(state) | held):
        name = world.items[index].name
        goal = world.goal_sites(index, here)
        if goal is None:
            continue
        cannot = why_not(world.items[index], world.hand, world.families)
        ways = [here.places_of(index, goal, f).reachable.any() for f in world.families]
        barred = [world.items[i].name for i in here.in_the_way(index, goal)]
        if cannot is not None:
            found.append(_finding(name, "cannot be grasped", f"{name} {cannot}"))
        elif state.held != index and not here.is_reachable(index):
            text = f"{name} is out of reach: {_barred(world, state, index)}"
            found.append(_finding(name, "out of reach", text))
        elif not any(ways):
            text = f"the goal of {name} is out of reach: {_why_goal(world, index, goal)}"
            found.append(_finding(name, "goal out of reach", text))
        elif obstructions(state, index) and barred:
            text = f"{name} is obstructed, at its place or its goal, by {', '.join(barred)}"
            found.append(_finding(name, "obstructed", text))
        elif refused:
            steps = {step: n for (about, step), n in refused.items() if about == name}
            if steps:
                said = ", ".join(f"{n} by {step.replace('_', ' ')}" for step, n in steps.items())
                text = f"{name}: all ways that were tried were refused, {said}"
                if state.held == index:
                    ground = world.grounds[goal.support]
                    where = f"{ground.name}{_walls(world, ground)}"
                    text = f"{name} cannot be put on {where}: refused {said}"
                found.append(_finding(name, "refused", text))
        elif disturbances(state, index):
            text = f"{name} would obstruct others at its goal"
            found.append(_finding(name, "disturbs", text))
    return found


def _walls(world: TabletopWorld, ground: Ground) -> str:
    """How deep a support is between things that stand around it, in words."""
    if ground.owner is not None:
        return ""
    x, y = ground.outside(0.0, 0.0)
    near = math.hypot(*ground.half) + BESIDE
    depth = max(
        (
            float(row[2] + row[5]) - ground.height
            for row in world.statics
            if point_distance(row, x, y) < near and row[2] - row[5] < ground.height + BESIDE
        ),
        default=0.0,
    )
    return f" ({100 * depth:.0f} cm deep)" if depth > BESIDE else ""
