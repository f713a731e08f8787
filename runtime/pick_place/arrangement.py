"""Obstructions and disturbances in one arrangement of the objects (paper, Sketch, SIW_R).

An arrangement is where every object stands (None: it is held, or thought away). Answers are
estimates by swept strips (`runtime.kernels.swept`), not by inverse kinematics: they depend
on the arrangement alone, so the same state always has the same features.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from runtime.kernels import swept
from runtime.kernels.swept import HEADINGS, STEP
from runtime.pick_place.goals import GoalSites
from runtime.pick_place.state import Grasp, Placement

if TYPE_CHECKING:
    from runtime.pick_place.task import Task
    from runtime.robot.model import Floats, Ints

Placements = tuple[Placement | None, ...]

FAR_OFF = np.array([1e3, 1e3, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
"""The box of an object that is away."""


class Arrangement:
    """The geometry of one arrangement, computed as far as it is asked for."""

    def __init__(self, task: Task, placements: Placements) -> None:
        self.task = task
        self.placements = placements
        n = len(placements)
        self.present = np.array([placement is not None for placement in placements], dtype=bool)
        # Objects that are away stand far off, where they bar nothing.
        self.boxes = np.tile(FAR_OFF, (n, 1))
        for i, placement in enumerate(placements):
            if placement is not None:
                self.boxes[i] = task.object_row(i, placement)
        self.xy = self.boxes[:, :2]
        self.misplaced: dict[Grasp | None, frozenset[int]] = {}
        self._alpha: dict[tuple[int, Grasp | None], int] = {}
        self._open: dict[int, tuple[Ints, Ints]] = {}
        self._places: dict[object, tuple[Ints, Ints]] = {}

    @cached_property
    def barred(self) -> Ints:
        """(n, n): headings at the place of object i that object j bars."""
        task = self.task
        barred: Ints = swept.barred_matrix(self.xy, self.grips, self.boxes, task.strip)
        np.fill_diagonal(barred, 0)
        return barred

    @cached_property
    def grips(self) -> Floats:
        """(n, K): half the width of each standing object across each heading, metres."""
        return np.array(
            [
                np.zeros(HEADINGS) if placement is None else self.task.grips(i, placement.pose[2])
                for i, placement in enumerate(self.placements)
            ]
        )

    @cached_property
    def letters(self) -> dict[int, GoalSites]:
        """Where the letters of the scene's word belong."""
        assert self.task.words is not None
        return self.task.words.assign(self)

    @cached_property
    def reachable(self) -> Ints:
        """(n,): headings from which the robot could come to each object."""
        return np.array(
            [
                0 if placement is None else self.task.reachable_at(placement)
                for placement in self.placements
            ],
            dtype=np.int64,
        )

    @cached_property
    def pick_counts(self) -> Ints:
        """(n, K): how many objects bar each heading to each object."""
        counts: Ints = swept.bar_counts(self.barred, self.present, self.reachable)
        return counts

    def free_headings(self, index: int) -> int:
        """Bits of the headings along which an object can be picked right away."""
        counts = self.pick_counts[index]
        return sum(1 << k for k in range(HEADINGS) if counts[k] == 0)

    def place_counts(self, goal: GoalSites, grip: float) -> tuple[Ints, Ints]:
        """For the sites of a goal and half the width of what is put there: (S, n) barred
        headings, (S, K) counts."""
        key = (goal.key, grip)
        if key not in self._places:
            grips = np.full((len(goal.xy), HEADINGS), grip)
            barred = swept.barred_matrix(goal.xy, grips, self.boxes, self.task.strip)
            counts = swept.bar_counts(barred, self.present, goal.reachable)
            self._places[key] = barred, counts
        return self._places[key]

    def obstructions(self, index: int, goal: GoalSites, grasp: Grasp | None = None) -> int:
        """alpha: fewest objects in the way of picking an object up and putting it at its
        goal, with the same grasp for both; of putting it alone where it is held already."""
        key = (index, grasp)
        if key not in self._alpha:
            self._alpha[key] = self._obstructions(index, goal, grasp, None)
        return self._alpha[key]

    def _obstructions(
        self, index: int, goal: GoalSites, grasp: Grasp | None, extra: tuple[int, Placement] | None
    ) -> int:
        task = self.task
        grip = task.place_grip(index, grasp)
        barred, counts = self.place_counts(goal, grip)
        plus_place = np.zeros(len(goal.xy), dtype=np.int64)
        plus_pick = np.zeros(1, dtype=np.int64)
        if extra is not None:
            box = task.object_row(*extra)[None]
            grips = np.full((len(goal.xy), HEADINGS), grip)
            plus_place = swept.barred_matrix(goal.xy, grips, box, task.strip)[:, 0]
            plus_pick = swept.barred_matrix(
                self.xy[index : index + 1], self.grips[index : index + 1], box, task.strip
            )[0]
        modulus = goal.modulus
        place = swept.residue_minima(counts, barred[:, index], plus_place, modulus)
        placement_now = self.placements[index]
        if placement_now is None:
            if grasp is None or goal.yaw is None:
                return int(place.min())
            # The grasp fixes the heading of the approach for each heading of the object.
            return int(place[round((goal.yaw + grasp.heading) / STEP) % modulus])
        none = np.zeros(1, dtype=np.int64)
        pick = swept.residue_minima(self.pick_counts[index : index + 1], none, plus_pick, modulus)
        if goal.yaw is None:
            return int(pick[0] + place[0])
        turn = round((goal.yaw - placement_now.pose[2]) / STEP)
        return int((pick + np.roll(place, -turn % modulus)).min())

    def in_the_way(self, index: int, goal: GoalSites) -> list[int]:
        """Objects that bar a least barred heading to an object, or to a site of its goal."""
        found = set()
        counts = self.pick_counts[index]
        for k in np.flatnonzero(counts == counts.min()):
            found |= {int(j) for j in np.flatnonzero((self.barred[index] >> k) & 1)}
        barred, counts = self.place_counts(goal, self.task.place_grip(index, None))
        fewest = counts.min()
        if fewest > 0:
            for site, k in np.argwhere(counts == fewest):
                found |= {int(j) for j in np.flatnonzero((barred[site] >> k) & 1)}
        found.discard(index)
        return sorted(found)

    def disturbed_by(self, index: int, placement: Placement, misplaced: frozenset[int]) -> int:
        """How many other misplaced objects would be obstructed more, were an object there.

        The object itself must be away in this arrangement.
        """
        return sum(
            self._is_disturbed(other, index, placement)
            for other in misplaced
            if other != index and self.placements[other] is not None
        )

    def _is_disturbed(self, other: int, index: int, placement: Placement) -> bool:
        """Whether alpha of `other` rises with object `index` at a placement."""
        goal = self.task.goal_sites(other, self)
        if goal is None:
            return False
        if goal.modulus > 1:
            before = self.obstructions(other, goal)
            return self._obstructions(other, goal, None, (index, placement)) > before
        # Pick and place do not depend on each other: alpha rises if one of them loses its
        # last least barred heading.
        task = self.task
        grip = task.place_grip(other, None)
        if other not in self._open:
            none = np.zeros(1, dtype=np.int64)
            barred, counts = self.place_counts(goal, grip)
            self._open[other] = (
                swept.least_barred(self.pick_counts[other : other + 1], none),
                swept.least_barred(counts, barred[:, other]),
            )
        box = task.object_row(index, placement)
        pick, place = self._open[other]
        sites = (
            (pick, self.xy[other : other + 1], self.grips[other : other + 1]),
            (place, goal.xy, np.full((len(goal.xy), HEADINGS), grip)),
        )
        return not all(
            swept.leaves_open(headings, xy, grips, box, task.strip) for headings, xy, grips in sites
        )
