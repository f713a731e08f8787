"""What X says of an object, asked many times: whether it can be picked up, and put at its goal."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.actions.actions import Pick, Place
from domains.tabletop.actions.executability import seeds_at
from domains.tabletop.features import swept
from domains.tabletop.features.functions import arrangement
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import HEADINGS, STEP, UNREACHABLE
from domains.tabletop.items import Item
from domains.tabletop.sampling.draw import Draw
from domains.tabletop.state import Grasp, State
from domains.tabletop.world import TabletopWorld
from runtime.search.problem import Rejection

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem

TRIES = 80
"""Manipulations that X is asked for before something counts as impossible."""

FEW = 30
"""The same where only the things in the way change from question to question."""

SEEDS = seeds_at(1)
"""Starting points for inverse kinematics: more than at a first attempt, so that ways are searched
for as well."""

FLIPPED = 0.3
"""Share of the further grasps for which the hand is turned over."""


def grasps_of(world: TabletopWorld, state: State, index: int) -> list[Grasp]:
    """Grasps of an object where it rests, or where it began if it is held: those first in whose
    way the fewest things stand, a heading of each family at a time."""
    resting = state
    if state.placements[index] is None:
        placements = (
            *state.placements[:index], world.initial.placements[index],
            *state.placements[index + 1 :],
        )  # fmt: skip
        resting = replace(state, placements=placements)
    at = world.rests(resting.placements, index)
    if at is None:
        return []
    here = arrangement(world, resting.placements)
    placement = resting.placements[index]
    face = 0 if placement is None else placement.face
    item = world.item(index, face)
    found = []
    for family in world.families:
        hold = world.hold(index, family, at[3], face)
        site, own, sweep = np.array([at[:3]]), world.own(index, face), world.hand.sweeps[family]
        statics = world.statics_at(at[0], at[1])
        fixed = swept.open_headings(site, hold.rows, hold.height, own, statics, sweep)
        open_ways, counts = int(fixed[0]), here.picks[family].counts[index]
        for k in range(HEADINGS):
            angle = float(hold.angles[k]) - at[3]
            each = item.holds(world.hand, family, np.array([angle]))
            if each is not None and each.fits[0]:
                barred = (int(counts[k]) % UNREACHABLE) + 1 - (open_ways >> k & 1)
                found.append((barred, k % 6, k % 3, k, family, item.grasp(each, 0, angle)))
    return [entry[-1] for entry in sorted(found, key=lambda entry: entry[:-1])]


def can_pick(problem: TabletopProblem, state: State, index: int, tries: int = TRIES) -> bool:
    """Whether X can pick an object up where it rests, of many ways tried."""
    placement = state.placements[index]
    assert placement is not None
    rng = np.random.default_rng(problem.executor.seed)
    item = problem.world.item(index, placement.face)
    grasps = _again(problem.world, item, grasps_of(problem.world, state, index), rng)
    for _, grasp in zip(range(tries), grasps, strict=False):
        for narrow in (False, True):
            base = problem.sampler.bases.stand(state, index, placement, grasp, rng, narrow)
            if base is not None:
                answer = Pick(index, grasp).motion(problem.executor, state.driven(base), SEEDS)
                if not isinstance(answer, Rejection):
                    return True
    return False


def can_place(
    problem: TabletopProblem, state: State, index: int, goal: GoalSites, tries: int = TRIES
) -> bool:
    """Whether X can put an object at a goal, whatever way it is held, of many ways tried."""
    world = problem.world
    rng = np.random.default_rng(problem.executor.seed)
    grasps = grasps_of(world, state, index)
    if state.held == index and state.grasp is not None:
        grasps = [state.grasp, *grasps]
    grasps_again = _again(world, world.items[index], grasps, rng)
    for _, grasp in zip(range(tries), grasps_again, strict=False):
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


def _again(
    world: TabletopWorld, item: Item, grasps: list[Grasp], rng: np.random.Generator
) -> Iterator[Grasp]:
    """The grasps once, and then again and again with the hand a little turned, or flipped."""
    yield from grasps
    while grasps:
        for grasp in grasps:
            angle = grasp.heading + rng.uniform(-STEP / 2, STEP / 2)
            hold = item.holds(world.hand, grasp.family, np.array([angle]))
            flipped = bool(rng.random() < FLIPPED)
            if hold is not None and hold.fits[0]:
                yield item.grasp(hold, 0, angle, flipped)
            else:
                yield grasp
