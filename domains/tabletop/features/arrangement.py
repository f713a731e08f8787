"""Obstructions and disturbances in one arrangement of the objects (paper, Sketch, SIW_R).

An arrangement is where every object stands (None: it is held, or thought away). Answers are
estimates by swept strips (`swept.py`), not by inverse kinematics: they depend
on the arrangement alone, so the same state always has the same features.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from domains.tabletop.features import swept
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.state import Grasp, Placement

if TYPE_CHECKING:
    from domains.tabletop.world import Task
    from runtime.robot.model import Floats, Ints

Placements = tuple[Placement | None, ...]

MAX_HALF = 0.5
"""Metres; no object is larger than twice that across."""

FAR_OFF = np.array([1e3, 1e3, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
"""The box of an object that is away."""


class Arrangement:
    """The geometry of one arrangement, computed as far as it is asked for."""

    def __init__(
        self, task: Task, placements: Placements, origin: tuple[Arrangement, int] | None = None
    ) -> None:
        """`origin` is an arrangement that differs in the placement of one object only, and
        that object: what is known of it is carried over, and only what changed is computed."""
        self.task = task
        self.placements = placements
        self._origin = origin
        n = len(placements)
        if origin is None:
            # Objects that are away stand far off, where they bar nothing.
            self.boxes = np.tile(FAR_OFF, (n, 1))
            self.present = np.zeros(n, dtype=bool)
            changed = range(n)
        else:
            self.boxes = origin[0].boxes.copy()
            self.present = origin[0].present.copy()
            changed = range(origin[1], origin[1] + 1)
        for i in changed:
            placement = placements[i]
            self.present[i] = placement is not None
            self.boxes[i] = FAR_OFF if placement is None else task.object_row(i, placement)
        self.xy = self.boxes[:, :2]
        self.misplaced: dict[Grasp | None, frozenset[int]] = {}
        self._alpha: dict[tuple[int, Grasp | None], int] = {}
        self._inherited = False
        self._open: dict[int, tuple[Ints, Ints]] = {}
        self._places: dict[object, tuple[Ints, Ints]] = {}

    @cached_property
    def barred(self) -> Ints:
        """(n, n): headings at the place of object i that object j bars."""
        strip = self.task.strip
        barred: Ints
        if self._origin is None:
            barred = swept.barred_matrix(self.xy, self.grips, self.boxes, strip)
            np.fill_diagonal(barred, 0)
            return barred
        before, i = self._origin
        one = slice(i, i + 1)
        barred = before.barred.copy()
        barred[i] = swept.barred_matrix(self.xy[one], self.grips[one], self.boxes, strip)[0]
        barred[:, i] = swept.barred_matrix(self.xy, self.grips, self.boxes[one], strip)[:, 0]
        barred[i, i] = 0
        return barred

    @cached_property
    def grips(self) -> Floats:
        """(n, K): half the width of each standing object across each heading, metres."""
        if self._origin is None:
            return np.array([self._grips_of(i) for i in range(len(self.placements))])
        before, i = self._origin
        grips = before.grips.copy()
        grips[i] = self._grips_of(i)
        return grips

    def _grips_of(self, index: int) -> Floats:
        placement = self.placements[index]
        if placement is None:
            return np.zeros(HEADINGS)
        return self.task.grips(index, placement.pose[2])

    @cached_property
    def letters(self) -> dict[int, GoalSites]:
        """Where the letters of the scene's word belong."""
        assert self.task.words is not None
        return self.task.words.assign(self)

    @cached_property
    def reachable(self) -> Ints:
        """(n,): headings from which the robot could come to each object."""
        if self._origin is None:
            each = [self._reachable_of(i) for i in range(len(self.placements))]
            return np.array(each, dtype=np.int64)
        before, i = self._origin
        reachable = before.reachable.copy()
        reachable[i] = self._reachable_of(i)
        return reachable

    def _reachable_of(self, index: int) -> int:
        placement = self.placements[index]
        return 0 if placement is None else self.task.reachable_at(placement)

    @cached_property
    def pick_counts(self) -> Ints:
        """(n, K): how many objects bar each heading to each object."""
        counts: Ints
        if self._origin is None:
            counts = swept.bar_counts(self.barred, self.present, self.reachable)
            return counts
        before, i = self._origin
        one = slice(i, i + 1)
        counts = swept.shifted_counts(
            before.pick_counts,
            before.barred[:, i] * before.present[i],
            self.barred[:, i] * self.present[i],
        )
        counts[i] = swept.bar_counts(self.barred[one], self.present, self.reachable[one])[0]
        return counts

    def free_headings(self, index: int) -> int:
        """Bits of the headings along which an object can be picked right away."""
        counts = self.pick_counts[index]
        return sum(1 << k for k in range(HEADINGS) if counts[k] == 0)

    def place_counts(self, goal: GoalSites, grip: Floats) -> tuple[Ints, Ints]:
        """For the sites of a goal and half the width (K,) of what is put there, across each
        heading: (S, n) barred headings, (S, K) counts."""
        key = (goal.key, grip.tobytes())
        if key not in self._places:
            grips = np.tile(grip, (len(goal.xy), 1))
            strip = self.task.strip
            barred: Ints
            if self._origin is None:
                barred = swept.barred_matrix(goal.xy, grips, self.boxes, strip)
                counts = swept.bar_counts(barred, self.present, goal.reachable)
            else:
                before, i = self._origin
                known, counts = before.place_counts(goal, grip)
                if self._is_far(goal):
                    self._places[key] = known, counts
                    return known, counts
                column = swept.barred_matrix(goal.xy, grips, self.boxes[i : i + 1], strip)[:, 0]
                gone, come = known[:, i] * before.present[i], column * self.present[i]
                if gone.any() or come.any():
                    barred = known.copy()
                    barred[:, i] = column
                    counts = swept.shifted_counts(counts, gone, come)
                else:
                    barred = known
            self._places[key] = barred, counts
        return self._places[key]

    def _is_far(self, goal: GoalSites) -> bool:
        """Whether what moved is, before and after, too far from a goal to matter there."""
        assert self._origin is not None
        before, i = self._origin
        (x, y), radius = goal.circle
        reach = radius + self.task.strip[2] + self.task.strip[3] + MAX_HALF
        return not any(
            one.present[i] and math.hypot(one.xy[i, 0] - x, one.xy[i, 1] - y) < reach
            for one in (before, self)
        )

    def _inherit(self) -> None:
        """Carry over alpha of objects whose ways what moved neither barred nor bars."""
        if self._origin is None or self.task.words is not None:
            return
        before, i = self._origin
        gone, come = before.barred[:, i] * before.present[i], self.barred[:, i] * self.present[i]
        same = (gone == come).tolist()
        far: dict[object, bool] = {}
        for (index, grasp), alpha in before._alpha.items():
            goal = self.task.goals.get(index)
            if grasp is not None or index == i or not same[index] or goal is None:
                continue
            if goal.key not in far:
                far[goal.key] = self._is_far(goal)
            if far[goal.key]:
                self._alpha[index, None] = alpha

    def settle(self) -> None:
        """Compute what has been put off and let go of the origin."""
        if self._origin is not None:
            _ = self.barred, self.grips, self.reachable, self.pick_counts
            self._origin = None

    def obstructions(self, index: int, goal: GoalSites, grasp: Grasp | None = None) -> int:
        """alpha: fewest objects in the way of picking an object up and putting it at its
        goal, with the same grasp for both; of putting it alone where it is held already."""
        if not self._inherited:
            self._inherited = True
            self._inherit()
        key = (index, grasp)
        if key not in self._alpha:
            self._alpha[key] = self._obstructions(index, goal, grasp, None)
        return self._alpha[key]

    def _obstructions(
        self, index: int, goal: GoalSites, grasp: Grasp | None, extra: tuple[int, Placement] | None
    ) -> int:
        task = self.task
        grip = task.place_grips(index, goal, grasp)
        barred, counts = self.place_counts(goal, grip)
        plus_place = np.zeros(len(goal.xy), dtype=np.int64)
        plus_pick = np.zeros(1, dtype=np.int64)
        if extra is not None:
            box = task.object_row(*extra)[None]
            grips = np.tile(grip, (len(goal.xy), 1))
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
        turn = 0 if goal.yaw is None else round((goal.yaw - placement_now.pose[2]) / STEP)
        if turn % modulus:
            place = np.roll(place, -turn % modulus)
        at_least, at_most = int(np.maximum(pick, place).min()), int((pick + place).min())
        if at_least == at_most or at_least >= swept.UNREACHABLE:
            return at_most
        # Something bars both ways: it is to be moved once only.
        counted = np.append(self.present, extra is not None)
        counted[index] = False
        return int(
            swept.least_union(
                np.append(self.barred[index], plus_pick),
                self.reachable[index],
                np.column_stack([barred, plus_place]),
                goal.reachable,
                counted,
                modulus,
                turn,
            )
        )

    def in_the_way(self, index: int, goal: GoalSites) -> list[int]:
        """Objects that bar a least barred heading to an object, or to a site of its goal."""
        found = set()
        counts = self.pick_counts[index]
        for k in np.flatnonzero(counts == counts.min()):
            found |= {int(j) for j in np.flatnonzero((self.barred[index] >> k) & 1)}
        barred, counts = self.place_counts(goal, self.task.place_grips(index, goal, None))
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
        x, y, _ = placement.pose
        strip = self.task.strip
        reach = strip[2] + strip[3] + MAX_HALF
        near = np.hypot(self.xy[:, 0] - x, self.xy[:, 1] - y) < reach
        count = 0
        for other in misplaced:
            if other == index or self.placements[other] is None:
                continue
            goal = self.task.goal_sites(other, self)
            # Far from where it is and from where it belongs, nothing is in its way.
            if goal is not None and (near[other] or goal.surface == placement.surface):
                count += self._is_disturbed(other, goal, index, placement)
        return count

    def _is_disturbed(self, other: int, goal: GoalSites, index: int, placement: Placement) -> bool:
        """Whether alpha of `other` rises with object `index` at a placement."""
        before = self.obstructions(other, goal)
        if goal.modulus > 1 or before > 0:
            return self._obstructions(other, goal, None, (index, placement)) > before
        # Nothing bars the way: alpha rises if pick or place loses its last free heading.
        task = self.task
        grip = task.place_grips(other, goal, None)
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
            (place, goal.xy, np.tile(grip, (len(goal.xy), 1))),
        )
        return not all(
            swept.leaves_open(headings, xy, grips, box, task.strip) for headings, xy, grips in sites
        )
