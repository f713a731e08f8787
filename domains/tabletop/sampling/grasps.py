"""Grasps to pick objects up with."""

from __future__ import annotations

import math

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.sampling.draw import GRASPS, Draw, pick_headings
from domains.tabletop.state import UNIT, Grasp, Placement, State
from domains.tabletop.world import Task

Picks = list[tuple[int, tuple[Grasp, ...]]]
"""Objects, each with the grasps to try."""

NEAREST = 14
"""At the first attempt only so many of the relevant objects, the nearest ones, are picked up:
a subgoal is rarely far, and what a subgoal costs shall not grow with the scene."""

NARROW = 1e-3
"""Metres by which a grasp may be wider than the narrowest one and still count as narrow."""


class GraspSampler:
    """Samples grasps for one task."""

    def __init__(self, task: Task) -> None:
        self.task = task

    def picks(self, draw: Draw) -> Picks:
        """Grasps of the objects that matter; of all of them once a draw has failed."""
        task, state, attempt, rng = self.task, draw.state, draw.attempt, draw.rng
        arrangement = task.arrangement(state.placements)
        picks = []
        for index in self._relevant(draw):
            placement = state.placements[index]
            assert placement is not None
            free = arrangement.free_headings(index)
            if not free:
                if attempt == 0:
                    continue
                # The estimate may be wrong: try what geometry allows at all.
                free = int(arrangement.reachable[index])
            free = self._placeable(state, index, free) or free
            if draw.doubting:
                free = swept.ALL
            number = GRASPS * draw.scale
            narrow = free & self._narrow(index, placement)
            headings = pick_headings(narrow, number, rng)
            if len(headings) < number:
                headings += pick_headings(free & ~narrow, number - len(headings), rng)
            jitter = 0.0 if attempt == 0 else STEP / 2
            height = task.shapes[index].grasp_height
            grasps = tuple(
                Grasp.of(
                    k * STEP + rng.uniform(-jitter, jitter) - placement.yaw * UNIT,
                    height,
                    flipped=attempt > 0 and rng.random() < 0.3,
                )
                for k in headings
            )
            if grasps:
                picks.append((index, grasps))
        return picks

    def _placeable(self, state: State, index: int, free: int) -> int:
        """Those of some headings with which an object can also be put at its goal, where
        its heading there is prescribed and the grasp ties the two together."""
        task = self.task
        arrangement = task.arrangement(state.placements)
        goal = task.goal_sites(index, arrangement)
        placement = state.placements[index]
        if goal is None or goal.yaw is None or placement is None:
            return free
        barred, counts = arrangement.place_counts(goal, task.place_grips(index, goal, None))
        own = (barred[:, index, None] >> np.arange(HEADINGS)) & 1
        place = (counts - own).min(axis=0)
        turn = round((goal.yaw - placement.pose[2]) / STEP)
        fitting = 0
        for k in range(HEADINGS):
            ends = [(k + turn + i * goal.modulus) % HEADINGS for i in range(goal.symmetry)]
            if any(place[end] == place.min() for end in ends):
                fitting |= 1 << k
        # Where the heading is prescribed, room is tight: narrow grasps before wide ones.
        return (free & fitting & self._narrow(index, placement)) or (free & fitting)

    def _narrow(self, index: int, placement: Placement) -> int:
        """Headings along which the gripper need not open much wider than it must at best:
        those along the sides of a box, where its fingers lie flat."""
        grips = self.task.grips(index, placement.pose[2])
        return sum(1 << k for k in range(HEADINGS) if grips[k] < grips.min() + NARROW)

    def regrasps(self, draw: Draw) -> Picks:
        """Other grasps of the held object: where it cannot go to its goal with the grasp
        that holds it, it is put down, gripped anew and placed, all in one subproblem."""
        index, _ = draw.held
        height = self.task.shapes[index].grasp_height
        number = GRASPS * draw.scale
        # The first angles are along the sides of the object, the narrowest ones.
        angles = np.arange(number) * 2 * math.pi / number
        if draw.attempt > 1:
            angles += draw.rng.uniform(0.0, 2 * math.pi / number)
        grasps = (Grasp.of(a, height, flipped=draw.rng.random() < 0.3) for a in angles)
        return [(index, tuple(grasps))]

    def _relevant(self, draw: Draw) -> list[int]:
        """Misplaced objects and those in their way, nearest first; all after a failure."""
        task, state = self.task, draw.state
        arrangement = task.arrangement(state.placements)
        standing = [i for i, placement in enumerate(state.placements) if placement is not None]
        if draw.attempt == 0:
            misplaced = task.misplaced(state)
            relevant = set(misplaced)
            for index in misplaced:
                goal = task.goal_sites(index, arrangement)
                if goal is not None and task.obstructions(state, index) > 0:
                    relevant |= set(arrangement.in_the_way(index, goal))
            standing = [i for i in standing if i in relevant]
        x, y = state.base.x, state.base.y
        nearest = sorted(
            standing,
            key=lambda i: (state.placements[i].x - x) ** 2 + (state.placements[i].y - y) ** 2,  # type: ignore[union-attr]
        )
        return nearest[:NEAREST] if draw.attempt == 0 else nearest
