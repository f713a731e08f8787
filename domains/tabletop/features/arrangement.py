"""Obstructions and disturbances in one arrangement of the objects (paper, Sketch, SIW_R).

An arrangement is where every object rests (None: it is held, or thought away). Answers are
estimates by swept volumes (`swept.py`), not by inverse kinematics: they depend on the
arrangement alone, so the same state always has the same features.

`moved` makes the arrangement in which something rests elsewhere: what that does not touch is
carried over and equals, value by value, what would be computed afresh. How alpha and beta follow
from the ways is in `alpha.py` and `beta.py`.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.features import alpha, beta, clearing, swept
from domains.tabletop.features.alpha import Thought
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.harmless import SiteTable
from domains.tabletop.features.swept import HEADINGS
from domains.tabletop.features.ways import (
    Picks,
    Places,
    columns,
    face_of,
    pick_row,
    place_barred,
)
from domains.tabletop.footprints import footprints_meet
from domains.tabletop.loads import load_of
from domains.tabletop.state import Grasp, Placement
from runtime.kernels.plane import point_distance
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.holds import SiteHold
    from domains.tabletop.world import Ints, Placements, TabletopWorld

ALL = slice(None)

FAR_OFF = np.array([1e3, 1e3, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
"""The box of an object that is away."""


@dataclass(frozen=True, eq=False)
class Arrangement:
    """The geometry of one arrangement: `boxes` (n, 8) and `sites` (n, 3) of the objects, those
    that are away far off, and `present` (n,)."""

    world: TabletopWorld
    placements: Placements
    boxes: Floats
    sites: Floats
    present: Ints
    picks: dict[int, Picks]
    places: dict[object, Places] = field(default_factory=dict)
    alpha: dict[tuple[int, Grasp | None], int] = field(default_factory=dict)
    beta: dict[tuple[int, Grasp | None], int] = field(default_factory=dict)
    left: dict[object, NDArray[np.bool_]] = field(default_factory=dict)
    groups: dict[frozenset[int], dict[Hashable, tuple[int, ...]]] = field(default_factory=dict)
    misplaced: dict[Grasp | None, frozenset[int]] = field(default_factory=dict)
    letters: dict[str, dict[int, GoalSites]] = field(default_factory=dict)
    blockers: dict[int, frozenset[int]] = field(default_factory=dict)

    # -- making one --------------------------------------------------------------------------

    @classmethod
    def afresh(cls, world: TabletopWorld, placements: Placements) -> Arrangement:
        """The arrangement of some placements, computed from nothing."""
        n = len(placements)
        boxes, sites = np.tile(FAR_OFF, (n, 1)), np.tile(FAR_OFF[:3], (n, 1))
        present = np.zeros(n, dtype=np.int64)
        yaws = [0.0] * n
        for i in range(n):
            at = world.rests(placements, i)
            if at is not None:
                boxes[i] = world.box_row(i, at, face_of(placements[i]))
                sites[i], present[i], yaws[i] = at[:3], 1, at[3]
        picks = {}
        owns = world.owns_of(placements)
        for family in world.families:
            standing = ((i, face_of(placements[i]), yaws[i]) for i in range(n) if present[i])
            world.learn_holds(family, standing)
            rows = [
                pick_row(world, i, family, sites[i], yaws[i], placements[i], present[i])
                for i in range(n)
            ]
            holds, heights, reachable = columns(rows)
            barred = swept.barred_matrix(
                sites, holds, heights, owns, boxes, world.hand.sweeps[family], 0.0
            )
            np.fill_diagonal(barred, 0)
            _bar_riders(world, placements, family, boxes, sites, holds, heights, barred)
            counts = swept.bar_counts(barred, present, reachable)
            picks[family] = Picks(barred, holds, heights, reachable, counts)
        return cls(world, placements, boxes, sites, present, picks)

    def moved(self, placements: Placements) -> Arrangement:
        """The arrangement of placements of which few differ, by what is known of this one."""
        world = self.world
        changed = changes(world, self.placements, placements)
        boxes, sites, present = self.boxes.copy(), self.sites.copy(), self.present.copy()
        yaws = {}
        for i in changed:
            at = world.rests(placements, i)
            present[i], yaws[i] = at is not None, 0.0 if at is None else at[3]
            boxes[i] = FAR_OFF if at is None else world.box_row(i, at, face_of(placements[i]))
            sites[i] = FAR_OFF[:3] if at is None else at[:3]
        stacked = _is_stacked(world, self.placements, self.boxes) or _is_stacked(
            world, placements, boxes
        )
        picks = {
            family: self._moved_picks(
                family, placements, changed, yaws, boxes, sites, present, stacked
            )
            for family in world.families
        }
        found = Arrangement(world, placements, boxes, sites, present, picks)
        if world.scene.word is None and not stacked:
            self._carry_alpha(found, changed, self._carry_places(found, changed))
        return found

    def _moved_picks(
        self,
        family: int,
        placements: Placements,
        changed: Sequence[int],
        yaws: dict[int, float],
        boxes: Floats,
        sites: Floats,
        present: Ints,
        stacked: bool,
    ) -> Picks:
        world, known = self.world, self.picks[family]
        holds, heights = known.holds.copy(), known.heights.copy()
        reachable, barred = known.reachable.copy(), known.barred.copy()
        for i in changed:
            row = pick_row(world, i, family, sites[i], yaws[i], placements[i], present[i])
            holds[i], heights[i], reachable[i] = row
        hand = world.hand.sweeps[family]
        owns = world.owns_of(placements)
        barred[changed] = swept.barred_matrix(
            sites[changed], holds[changed], heights[changed], owns[changed], boxes, hand, 0.0
        )
        barred[:, changed] = swept.barred_matrix(
            sites, holds, heights, owns, boxes[changed], hand, 0.0
        )
        np.fill_diagonal(barred, 0)
        if stacked:
            _bar_riders(world, placements, family, boxes, sites, holds, heights, barred)
            return Picks(
                barred, holds, heights, reachable, swept.bar_counts(barred, present, reachable)
            )
        counts = known.counts
        for i in changed:
            counts = swept.shifted_counts(
                counts, known.barred[:, i] * self.present[i], barred[:, i] * present[i]
            )
        counts[changed] = swept.bar_counts(barred[changed], present, reachable[changed])
        return Picks(barred, holds, heights, reachable, counts)

    def _carry_places(self, to: Arrangement, changed: Sequence[int]) -> frozenset[Hashable]:
        """Ways to the sites of goals, as they are after some objects have moved; and the keys of
        goals some ways to which may be other ones."""
        moved: set[Hashable] = set()
        for key, known in self.places.items():
            if all(self._is_far(to, known, i) for i in changed):
                to.places[key] = known
                continue
            family = key[2]  # type: ignore[index]
            barred, counts = known.barred.copy(), known.counts
            columns = place_barred(self.world, known, family, to.boxes[list(changed)])
            for column, i in zip(columns.T, changed, strict=True):
                gone, come = barred[:, i] * self.present[i], column * to.present[i]
                if gone.any() or come.any():
                    counts = swept.shifted_counts(counts, gone, come)
                barred[:, i] = column
            to.places[key] = Places(
                known.goal, known.hold, known.own, barred, counts, known.reachable, known.stands
            )
            moved.add(known.goal.key)
        return frozenset(moved)

    def _is_far(self, to: Arrangement, known: Places, index: int) -> bool:
        """Whether an object that has moved is, before and after, too far from a goal to matter."""
        (x, y), radius = known.goal.circle
        reach = radius + max(self.reach(known.hold), known.extent)
        return not any(
            one.present[index] and point_distance(one.boxes[index], x, y) <= reach
            for one in (self, to)
        )

    def reach(self, hold: SiteHold) -> float:
        """Metres from a site beyond which nothing bars a hand of any family."""
        return self.world.widest + hold.reach

    def _carry_alpha(
        self, to: Arrangement, changed: Sequence[int], touched: frozenset[Hashable]
    ) -> None:
        """Alpha of objects whose ways what moved neither barred nor bars, to goals whose ways are
        not `touched`; and where something is to be taken away first, nobody's ways."""
        same = np.ones(len(self.boxes), dtype=np.bool_)
        for f, before in self.picks.items():
            gone = before.barred[:, changed] * self.present[changed]
            come = to.picks[f].barred[:, changed] * to.present[changed]
            same &= (gone == come).all(axis=1)
        alike, unbarred = bool(same.all()), same.tolist()
        goals = self.world.goals
        for (index, grasp), cost in self.alpha.items():
            if (
                grasp is None
                and unbarred[index]
                and (cost == 0 or alike)
                and index not in changed
                and index in goals
                and goals[index].key not in touched
            ):
                to.alpha[index, None] = cost

    # -- ways ---------------------------------------------------------------------------------

    def free_headings(self, index: int, family: int) -> int:
        """Bits of the headings along which an object can be picked right away."""
        counts = self.picks[family].counts[index]
        return sum(1 << k for k in range(HEADINGS) if counts[k] == 0)

    def is_reachable(self, index: int) -> bool:
        """Whether the robot could come to an object at all."""
        return any(picks.reachable[index] for picks in self.picks.values())

    def places_of(
        self, index: int, goal: GoalSites, family: int, grasp: Grasp | None = None
    ) -> Places:
        """The ways to the sites of a goal for an object, with the grasp that holds it if any."""
        world = self.world
        yaw = goal.world_yaw
        hold = world.place_hold(index, family, yaw, grasp)
        face = 0 if grasp is None else grasp.face
        load = load_of(world, self.placements, index) if world.owned else ()
        key = (goal.key, world.kinds[index], family, face, hold.key, load)
        known = self.places.get(key)
        if known is None:
            reachable = world.reachable_goal(goal, index, family, hold, face)
            empty = np.zeros((len(goal.xyz), 0), dtype=np.int64)
            own = world.own(index, face)
            stands = None
            if yaw is not None and world.item(index, face).is_box:
                sites = goal.xyz.tolist()
                stands = np.array([world.box_row(index, (x, y, z, yaw), face) for x, y, z in sites])
            known = Places(goal, hold, own, empty, empty, reachable, stands)
            barred = place_barred(world, known, family, self.boxes)
            if goal.frame is not None:  # what it is to stand on is not in the way of it
                owner = world.grounds[goal.support].owner
                assert owner is not None
                barred[:, owner] = 0
            barred[:, list(load)] = 0  # that goes with it
            counts = swept.bar_counts(barred, self.present, reachable)
            known = Places(goal, hold, known.own, barred, counts, reachable, stands)
            self.places[key] = known
        return known

    def unplaced(self) -> frozenset[int]:
        """Objects that rest somewhere, but not where their goal wants them."""
        world, found = self.world, set()
        for index in world.wanted(self):
            placement = self.placements[index]
            goal = world.goal_sites(index, self)
            if placement is None or goal is None:
                continue
            key = (goal.key, placement)
            holds = world.memory.table("well placed").get(key)
            if holds is None:
                holds = world.memory.table("well placed")[key] = goal.holds(placement)
            if not holds:
                found.add(index)
        return frozenset(found)

    @cached_property
    def settled(self) -> frozenset[int]:
        """Objects that rest where their goal, if they have one, wants them, and so do all that they
        stand on."""
        wrong, found = self.unplaced(), set()
        for index in np.flatnonzero(self.present).tolist():
            below = self.standing_on(index)
            if not below & wrong and all(self.present[i] for i in below):
                found.add(index)
        return frozenset(found)

    @cached_property
    def next_to_settle(self) -> frozenset[int]:
        """Objects with a goal that are not settled, though all that they are to stand on is."""
        return frozenset(
            index
            for index in self.world.wanted(self)
            if index not in self.settled
            and (goal := self.world.goal_sites(index, self)) is not None
            and self.settled.issuperset(goal.bearers)
        )

    def bars_settling(self, index: int, other: int) -> bool:
        """Whether something is to be taken away before an object that is next to settle can be
        put at its goal."""
        if index not in self.next_to_settle:
            return False
        if index not in self.blockers:
            goal = self.world.goal_sites(index, self)
            found = self.in_the_way(index, goal) if goal is not None and self.present[index] else ()
            self.blockers[index] = frozenset(found)
        return other in self.blockers[index]

    def waits(self, goal: GoalSites) -> bool:
        """Whether a goal is on something that is still to be moved itself, or in the hand: that
        counts as disturbed by whatever is put there, and is in nobody's way."""
        wrong = self.unplaced() if goal.bearers else frozenset()
        return any(
            not self.present[owner] or bool(self.standing_on(owner) & wrong)
            for owner in goal.bearers
        )

    def bears(self, index: int) -> list[int]:
        """Objects that rest on an object, on it alone or on others as well."""
        found = set(self.world.riders(self.placements, index))
        if index in self.world.owned:
            found |= set(np.flatnonzero(_borne(self.boxes, index) & (self.present > 0)).tolist())
        return sorted(found)

    def can_be_taken(self, index: int) -> bool:
        """Whether nothing rests on an object, or only what is carried along."""
        return set(self.bears(index)) <= set(load_of(self.world, self.placements, index))

    def standing_on(self, index: int) -> frozenset[int]:
        """An object, and those that it stands on."""
        found = {index}
        placement = self.placements[index]
        while placement is not None:
            owner = self.world.grounds[placement.support].owner
            if owner is None or owner in found:
                break
            found.add(owner)
            placement = self.placements[owner]
        return frozenset(found)

    # -- alpha ----------------------------------------------------------------------------------

    def obstructions(self, index: int, goal: GoalSites, grasp: Grasp | None = None) -> int:
        """alpha: the cost of taking away what is in the way of picking an object up and putting it
        at its goal, with the same grasp for both; of putting it there where it is held already."""
        key = (index, grasp)
        found = self.alpha.get(key)
        if found is None:
            found = self.alpha[key] = self.obstructions_with(index, goal, grasp, None)
        return found

    def obstructions_with(
        self, index: int, goal: GoalSites, grasp: Grasp | None, extra: Thought | None
    ) -> int:
        """The same, with one more object thought to be there."""
        return alpha.obstructions_with(self, index, goal, grasp, extra)

    def barred_from_picking(self, index: int) -> int:
        """The cost of taking away what is in the way of picking an object up that rests."""
        return alpha.barred_from_picking(self, index)

    def in_the_way(self, index: int, goal: GoalSites) -> list[int]:
        """Objects to be taken away before an object can be picked up and put at its goal, along
        any of the cheapest ways; where there is none, those that bar a least barred heading."""
        return alpha.in_the_way(self, index, goal)

    def face(self, index: int, grasp: Grasp | None) -> int:
        """The face on which an object stands, or in whose frame its grasp is given."""
        return grasp.face if grasp is not None else face_of(self.placements[index])

    @cached_property
    def costs(self) -> Ints:
        """The cost of taking away each object (n,)."""
        return self.costs_with(np.zeros((len(self.picks), len(self.boxes)), dtype=np.int64))

    def costs_with(self, bars: Ints) -> Ints:
        """The same, with one more object that bars some headings to the others (F, n)."""
        found: Ints = clearing.clearing_costs(*self.what_bars, bars, self.present)
        return found

    @property
    def what_bars(self) -> tuple[Ints, Ints]:
        """What bars what (F, n, n), and how many bar each heading (F, n, K)."""
        barred = np.array([picks.barred for picks in self.picks.values()])
        return barred, np.array([picks.counts for picks in self.picks.values()])

    # -- beta -----------------------------------------------------------------------------------

    def disturbed_by(self, index: int, placement: Placement, misplaced: frozenset[int]) -> int:
        """How many other misplaced objects would be obstructed more, were an object there.

        The object itself must be away in this arrangement.
        """
        return beta.disturbed_by(self, index, placement, misplaced)

    def has_harmless_site(self, index: int, goal: GoalSites, others: frozenset[int]) -> bool:
        """Whether an object could go to a site of its goal, on furniture, where it certainly is in
        nobody's way: it bars no heading to any object, and leaves a free one to the goals of the
        others. That holds, too, once the object itself is away."""
        return beta.has_harmless_site(self, index, goal, others)

    def free_sites(self, index: int, goal: GoalSites) -> NDArray[np.bool_]:
        """Which sites of a goal no other object occupies (S,)."""
        return self.site_table(index, goal).free(index)

    def site_table(self, index: int, goal: GoalSites) -> SiteTable:
        """What is known of the sites of a goal on furniture, for objects like this one."""
        key = (goal.key, self.world.kinds[index])
        # Whatever arrangement was asked last: most things are where they were then.
        last = self.world.memory.table("site tables")
        before, known = last.get(key, (None, None))
        if before is self.placements:
            return known  # type: ignore[no-any-return]
        changed = [] if before is None else changes(self.world, before, self.placements)
        if known is None or len(changed) > len(self.boxes) // 2:
            found = SiteTable.afresh(self, index, goal)
        else:
            found = known.moved(self, index, goal, changed)
        last[key] = self.placements, found
        return found

    def bars(self, boxes: Floats, chosen: Sequence[int] | slice = ALL) -> Ints:
        """The headings to each of some objects that boxes (b, 8) bar, for each family (F, n, b)."""
        owns = self.world.owns_of(self.placements)[chosen]
        bars = [
            swept.barred_matrix(
                self.sites[chosen], picks.holds[chosen], picks.heights[chosen], owns, boxes,
                self.world.hand.sweeps[family], 0.0,
            )
            for family, picks in self.picks.items()
        ]  # fmt: skip
        return np.array(bars) * self.present[chosen][:, None]


def changes(world: TabletopWorld, before: Placements, after: Placements) -> list[int]:
    """What rests elsewhere, or on something that does."""
    changed = [
        i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a is not b and a != b
    ]
    for i in list(changed):
        riders = {*world.riders(before, i), *world.riders(after, i)}
        changed += [r for r in riders if r not in changed]
    return changed


def _is_stacked(world: TabletopWorld, placements: Placements, boxes: Floats) -> bool:
    """Whether something rests on something that can be moved."""
    if not world.owned:
        return False
    grounds = world.grounds
    if any(p is not None and grounds[p.support].owner is not None for p in placements):
        return True
    owners = np.array(list(world.owned))
    tops = boxes[owners, 2] + boxes[owners, 5]
    level = np.abs(tops[:, None] - (boxes[:, 2] - boxes[:, 5])[None]) < LEVEL
    return any(_borne(boxes, int(owners[i])).any() for i in np.flatnonzero(level.any(axis=1)))


def _bar_riders(
    world: TabletopWorld,
    placements: Placements,
    family: int,
    boxes: Floats,
    sites: Floats,
    holds: Floats,
    heights: Floats,
    barred: Ints,
) -> None:
    """What rests on an object bars all ways to it; where it is carried along, only those that
    it is in. What stands in a tray is barred by its walls, not by the box around it; what goes
    over a peg is not barred by that."""
    hand = world.hand.sweeps[family]
    for i in world.owned:
        stands, inside = world.rests(placements, i), world.standing_in(placements, i)
        if stands is not None and inside and len(world.items[i].parts) > 1:
            rows = world.part_rows(i, stands, face_of(placements[i]))
            walls = swept.barred_matrix(
                sites[inside], holds[inside], heights[inside], np.zeros((len(inside), 2)), rows,
                hand, 0.0,
            )  # fmt: skip
            barred[inside, i] = np.bitwise_or.reduce(walls, axis=1)
        barred[i, _borne(boxes, i)] = swept.ALL
        for rider in world.riders(placements, i):
            barred[i, rider] = swept.ALL
        load, one = list(load_of(world, placements, i)), slice(i, i + 1)
        if load:
            barred[i, load] = swept.barred_matrix(
                sites[one], holds[one], heights[one], np.zeros((1, 2)), boxes[load], hand, 0.0
            )[0]


LEVEL = 0.006
"""Metres between the top of an object and the bottom of what rests on it, at most."""


def _borne(boxes: Floats, index: int) -> NDArray[np.bool_]:
    """Which upright boxes (n, 8) stand on the top of one of them: (n,)."""
    below = boxes[index]
    level = np.abs(boxes[:, 2] - boxes[:, 5] - below[2] - below[5]) < LEVEL
    found: NDArray[np.bool_] = np.zeros(len(boxes), dtype=np.bool_)
    for j in np.flatnonzero(level):
        found[j] = j != index and footprints_meet(below, boxes[j], -OVERLAP)
    return found


OVERLAP = 0.002
"""Metres by which footprints must overlap for one thing to bear the other."""
