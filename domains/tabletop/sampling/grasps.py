"""Grasps to pick objects up with."""

from __future__ import annotations

import math

import numpy as np

from domains.tabletop.faces import faces_at, turns
from domains.tabletop.features import swept
from domains.tabletop.features.arrangement import Arrangement
from domains.tabletop.features.functions import (
    arrangement,
    disturbances,
    misplaced,
    obstructions,
)
from domains.tabletop.features.swept import HEADINGS, STEP, near_headings
from domains.tabletop.sampling.draw import GRASPS, Draw, pick_headings
from domains.tabletop.state import Grasp, State
from domains.tabletop.world import TabletopWorld

Picks = list[tuple[int, tuple[Grasp, ...]]]
"""Objects, each with the grasps to try."""

NEAREST = 14
"""At the first attempt only so many of the relevant objects, the nearest ones, are picked up:
a subgoal is rarely far, and what a subgoal costs shall not grow with the scene."""

NARROW = 1e-3
"""Metres by which a grasp may be wider than the narrowest one and still count as narrow."""


class GraspSampler:
    """Samples grasps for one task."""

    def __init__(self, world: TabletopWorld) -> None:
        self.world = world

    def picks(self, draw: Draw) -> Picks:
        """Grasps of the objects that matter; of all of them once a draw has failed."""
        picks = []
        for index in self._relevant(draw):
            grasps = self.of(draw, index)
            if grasps:
                picks.append((index, grasps))
        return picks

    def of(self, draw: Draw, index: int) -> tuple[Grasp, ...]:
        """Grasps of one object; families that nothing bars take turns."""
        chosen = [self._of_family(draw, index, family) for family in self.world.families]
        found: list[Grasp] = []
        for turn in range(max(map(len, chosen), default=0)):
            found += [grasps[turn] for grasps in chosen if turn < len(grasps)]
        return tuple(found[: GRASPS * draw.scale * (1 if draw.attempt == 0 else 2)])

    def _of_family(self, draw: Draw, index: int, family: int) -> list[Grasp]:
        world, state, attempt, rng = self.world, draw.state, draw.attempt, draw.rng
        here = arrangement(world, state.placements)
        at, placement = world.rests(state.placements, index), state.placements[index]
        if at is None or placement is None:
            return []
        hold = world.hold(index, family, at[3], placement.face)
        free = here.free_headings(index, family)
        if not free:
            if not draw.doubting:
                return []
            # The estimate may be wrong: try what geometry allows at all.
            free = int(here.picks[family].reachable[index])
        free = self._placeable(state, index, family, free) or free
        number = GRASPS * draw.scale
        narrow = free & _narrow(hold.rows[:, 0], hold.fits)
        headings = pick_headings(narrow, number, rng)
        if len(headings) < number:
            headings += pick_headings(free & ~narrow, number - len(headings), rng)
        # What the estimate holds for best stays in; what is tried besides strays from it.
        angles = self._turnable(state, index, family, free)[:number]
        angles = angles or [float(hold.angles[k]) for k in headings]
        if attempt > 0:
            strays = pick_headings(swept.ALL & hold.fits if draw.doubting else free, number, rng)
            # Where few headings are free, each is tried in several ways.
            strays += pick_headings(free, number, rng) * (number // max(1, free.bit_count()) - 1)
            angles += [k * STEP + rng.uniform(-STEP / 2, STEP / 2) for k in strays]
        grasps = []
        for angle in angles:
            flipped = attempt > 0 and rng.random() < 0.3
            grasp = world.grasp(index, placement.face, family, angle - at[3])
            if grasp is not None:
                grasps.append(grasp._replace(flipped=flipped))
        return grasps

    def _placeable(self, state: State, index: int, family: int, free: int) -> int:
        """Those of some headings with which an object can also be put at its goal, where
        its heading there is prescribed and the grasp ties the two together."""
        world = self.world
        here = arrangement(world, state.placements)
        goal = world.goal_sites(index, here)
        at = world.rests(state.placements, index)
        if goal is None or goal.world_yaw is None or at is None:
            return free
        ways = here.places_of(index, goal, family)
        own = (ways.barred[:, index, None] >> np.arange(HEADINGS)) & 1
        place = (ways.counts - own).min(axis=0)
        turn = round((goal.world_yaw - at[3]) / STEP)
        fitting = 0
        for k in range(HEADINGS):
            ends = range((k + turn) % goal.modulus, HEADINGS, goal.modulus)
            if any(place[end] == place.min() for end in ends):
                fitting |= 1 << k
        # Where the heading is prescribed, room is tight: narrow grasps before wide ones.
        hold = world.hold(index, family, at[3])
        return (free & fitting & _narrow(hold.rows[:, 0], hold.fits)) or (free & fitting)

    def _turnable(self, state: State, index: int, family: int, free: int) -> list[float]:
        """The headings along which an object that has to be put on another face can be taken,
        where they are next to free ones; none where it need not be."""
        world, placement = self.world, state.placements[index]
        at = world.rests(state.placements, index)
        goal = world.goal_sites(index, arrangement(world, state.placements))
        faces = faces_at(world, index, goal)
        if placement is None or at is None or faces == (placement.face,):
            return []
        angles = {
            turn.angle + at[3]
            for face in faces
            for turn in turns(world, index, placement.face, face)
            if turn.family == family and free & near_headings(turn.angle + at[3])
        }
        return sorted(angles)

    def regrasps(self, draw: Draw, face: int) -> Picks:
        """Other grasps of the held object: where it cannot go to its goal with the grasp
        that holds it, it is put down on a face, gripped anew and placed, all in one
        subproblem."""
        index, _ = draw.held
        item, number = self.world.item(index, face), GRASPS * draw.scale
        # The first angles are along the sides of the object, the narrowest ones.
        angles = np.arange(number) * 2 * math.pi / number
        if draw.attempt > 1:
            angles += draw.rng.uniform(0.0, 2 * math.pi / number)
        grasps = []
        for family in self.world.families:
            hold = item.holds(self.world.hand, family, angles)
            for k, angle in enumerate(angles.tolist()):
                flipped = draw.rng.random() < 0.3
                if hold is not None and hold.fits[k]:
                    grasps.append(item.grasp(hold, k, angle, flipped))
        return [(index, tuple(grasps))]

    def is_ready(self, state: State, index: int) -> bool:
        """Whether an object is misplaced, nothing obstructs it and it would disturb nothing."""
        return (
            index in misplaced(state)
            and obstructions(state, index) == 0
            and disturbances(state, index) == 0
        )

    def are_tied(self, state: State) -> bool:
        """Whether all misplaced objects could go, but each would be in the way of another: one
        of them is to be picked up and put elsewhere in one subproblem."""
        wrong = misplaced(state)
        return (
            bool(wrong)
            and all(obstructions(state, i) == 0 for i in wrong)
            and not any(self.is_ready(state, i) for i in wrong)
        )

    def _can_come(self, here: Arrangement, index: int) -> bool:
        """Whether nothing bars some way to an object."""
        return any(here.free_headings(index, family) for family in self.world.families)

    def _relevant(self, draw: Draw) -> list[int]:
        """Misplaced objects that nothing obstructs or disturbs, then other misplaced ones and
        those that have to go first, as far as nothing bars them, the nearest first; all after a
        failure."""
        world, state = self.world, draw.state
        here = arrangement(world, state.placements)
        standing = [i for i in range(len(state.placements)) if here.present[i]]
        wrong = misplaced(state)
        blocked = {i for i in wrong if obstructions(state, i) > 0}
        if draw.attempt == 0:
            relevant = set(wrong) | world.wanted_held
            for index in blocked:
                goal = world.goal_sites(index, here)
                if goal is not None:
                    relevant |= set(here.in_the_way(index, goal))
            # What is barred itself has to wait, and is not to keep others out of the nearest.
            standing = [i for i in standing if i in relevant and self._can_come(here, i)]
        x, y, _ = state.base.pose
        away = (here.sites[:, 0] - x) ** 2 + (here.sites[:, 1] - y) ** 2
        # Most subgoals begin with something near: what is far is not asked whether it is ready.
        most = NEAREST if draw.attempt == 0 else len(standing)
        ready: list[int] = []
        waiting: list[int] = []
        for index in sorted(standing, key=lambda i: away[i]):
            if len(ready) == most:
                break
            (ready if self.is_ready(state, index) else waiting).append(index)
        return [*ready, *waiting][:most]


def _narrow(widths: np.ndarray, fits: int) -> int:
    """Headings along which the gripper need not open much wider than it must at best: those
    along the sides of a box, where its fingers lie flat."""
    fitting = [k for k in range(HEADINGS) if (fits >> k) & 1]
    if not fitting:
        return 0
    least = min(widths[k] for k in fitting)
    return sum(1 << k for k in fitting if widths[k] < least + NARROW)
