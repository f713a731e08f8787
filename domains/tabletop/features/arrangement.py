"""Obstructions and disturbances in one arrangement of the objects (paper, Sketch, SIW_R).

An arrangement is where every object rests (None: it is held, or thought away). Answers are
estimates by swept volumes (`swept.py`), not by inverse kinematics: they depend on the
arrangement alone, so the same state always has the same features.

`moved` makes the arrangement in which something rests elsewhere: what that does not touch is
carried over and equals, value by value, what would be computed afresh.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.faces import Turn, faces_at, turned, turns
from domains.tabletop.features import clearing, swept
from domains.tabletop.features.clearing import NEVER
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.harmless import SiteTable
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.features.towers import serving
from domains.tabletop.footprints import footprints_meet
from domains.tabletop.loads import load_of, tall
from domains.tabletop.state import Grasp, Placement
from runtime.kernels.plane import point_distance
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.world import Ints, Placements, SiteHold, TabletopWorld

ALL = slice(None)

FAR_OFF = np.array([1e3, 1e3, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
"""The box of an object that is away."""


NOTHING_BARRED: NDArray[np.bool_] = np.ones(1, dtype=np.bool_)
"""All of some boxes are fine."""


@dataclass(frozen=True, eq=False)
class Picks:
    """For one family of approaches, the ways to the objects where they rest.

    `barred` (n, n): headings at object i that object j bars. `holds` (n, K, 3) and `heights`
    (n,): how each is taken. `reachable` (n,): headings from which the robot could come.
    `counts` (n, K): how many objects bar each heading.
    """

    barred: Ints
    holds: Floats
    heights: Floats
    reachable: Ints
    counts: Ints


@dataclass(frozen=True, eq=False)
class Places:
    """The same for the sites of a goal: `barred` (S, n), `counts` (S, K), `reachable` (S,).
    `stands` (S, 8) are boxes around the object at the sites where its heading there is known;
    `spared` is which boxes, by what they are known as, leave a way free (`Arrangement`)."""

    goal: GoalSites
    hold: SiteHold
    own: Floats
    barred: Ints
    counts: Ints
    reachable: Ints
    stands: Floats | None = None
    spared: dict[Hashable, NDArray[np.bool_]] = field(default_factory=dict)

    @cached_property
    def extent(self) -> float:
        """Metres from a site to the corners of the object there, where its heading is known."""
        if self.stands is None:
            return 0.0
        return float(np.hypot(self.stands[:, 3], self.stands[:, 4]).max())

    @cached_property
    def free(self) -> Ints:
        """Bits of the headings to each site that nothing bars (S,)."""
        found: Ints = ((self.counts == 0) << np.arange(HEADINGS)).sum(axis=1)
        return found

    @cached_property
    def repeated(self) -> tuple[Floats, Floats, Floats]:
        """The hold's rows, its height and the object's own size, once for each site."""
        n = len(self.goal.xyz)
        return (
            np.tile(self.hold.rows, (n, 1, 1)),
            np.full(n, self.hold.height),
            np.tile(self.own, (n, 1)),
        )


@dataclass(frozen=True, eq=False)
class Thought:
    """An object that is thought to rest in an arrangement besides: its index and its box (8,)."""

    among: Arrangement
    index: int
    box: Floats

    @cached_property
    def bars(self) -> Ints:
        """The headings to each object that it bars, for each family (F, n)."""
        return self.among.bars(self.box[None])[:, :, 0]

    @cached_property
    def costs(self) -> Ints:
        """The cost of taking away each object (n,)."""
        return self.among.costs_with(self.bars) if self.bars.any() else self.among.costs


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
                _pick_row(world, i, family, sites[i], yaws[i], placements[i], present[i])
                for i in range(n)
            ]
            holds, heights, reachable = _columns(rows)
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
            row = _pick_row(world, i, family, sites[i], yaws[i], placements[i], present[i])
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
            columns = _place_barred(self.world, known, family, to.boxes[list(changed)])
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
        reach = radius + max(self._reach(known.hold), known.extent)
        return not any(
            one.present[index] and point_distance(one.boxes[index], x, y) <= reach
            for one in (self, to)
        )

    def _reach(self, hold: SiteHold) -> float:
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
        for (index, grasp), alpha in self.alpha.items():
            if (
                grasp is None
                and unbarred[index]
                and (alpha == 0 or alike)
                and index not in changed
                and index in goals
                and goals[index].key not in touched
            ):
                to.alpha[index, None] = alpha

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
            barred = _place_barred(world, known, family, self.boxes)
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
        families = self.world.families if grasp is None else (grasp.family,)
        if self.waits(goal):
            if not self.present[index]:
                return 0
            return self._of_picking(index, serving(self, index, families), extra)
        if len(self.world.faces[index]) > 1:
            faces = faces_at(self.world, index, goal)
            if faces != (0,) or self._face(index, grasp):
                return self._over_faces(faces, index, goal, grasp, extra)
        return min(self._of_family(f, index, goal, grasp, extra) for f in families)

    def _face(self, index: int, grasp: Grasp | None) -> int:
        """The face on which an object stands, or in whose frame its grasp is given."""
        return grasp.face if grasp is not None else face_of(self.placements[index])

    def _over_faces(
        self,
        faces: Sequence[int],
        index: int,
        goal: GoalSites,
        grasp: Grasp | None,
        extra: Thought | None,
    ) -> int:
        """The same for an object that may be put on one of some faces, whatever face it is
        on: the grasp is turned along with it."""
        fewest = 2 * swept.UNREACHABLE
        for turn in self._turns(faces, index, grasp):
            ways = self.places_of(index, goal, turn.there.family, turn.there)
            plus = np.zeros(len(goal.xyz), dtype=np.int64)
            if extra is not None:
                plus = _place_barred(self.world, ways, turn.there.family, extra.box[None])[:, 0]
            place = int(swept.residue_minima(ways.counts, ways.barred[:, index], plus, 1)[0])
            pick = self._barring(turn, index, extra)
            least = pick + place
            if least > 0 and max(pick, place) < swept.UNREACHABLE:
                cost, _ = self._cleared(turn.family, index, goal, grasp, extra, turn=turn)
                least = cost if cost < NEVER else swept.UNREACHABLE + least
            fewest = min(fewest, least)
        return fewest

    def _turns(self, faces: Sequence[int], index: int, grasp: Grasp | None) -> Iterable[Turn]:
        """The ways to put an object on one of some faces: of taking it, too, where it rests."""
        world, face = self.world, self._face(index, grasp)
        for to in faces:
            if grasp is None:
                yield from turns(world, index, face, to)
                continue
            there = turned(world, index, grasp, to)
            if there is not None:
                yield Turn(grasp.family, grasp.heading, there)

    def _barring(self, turn: Turn, index: int, extra: Thought | None) -> int:
        """How many objects bar the way to take an object as a turn does; none where it is held."""
        if not self.present[index]:
            return 0
        bits, counts = self._headings(turn, index), self.picks[turn.family].counts[index]
        plus = 0 if extra is None else int(self._pick_barred(turn.family, index, extra.box)[0])
        near = [k for k in range(HEADINGS) if (bits >> k) & 1]
        return min(int(counts[k]) + ((plus >> k) & 1) for k in near)

    def _headings(self, turn: Turn, index: int) -> int:
        """Bits of the headings next to that along which a turn takes an object where it rests."""
        at = self.world.rests(self.placements, index)
        assert at is not None
        return swept.near_headings(turn.angle + at[3])

    def barred_from_picking(self, index: int) -> int:
        """The cost of taking away what is in the way of picking an object up that rests."""
        return self._of_picking(index, self.world.families, None) if self.present[index] else 0

    def _of_picking(self, index: int, families: Sequence[int], extra: Thought | None) -> int:
        """The cost of taking away what is in the way of picking an object up."""
        fewest = 2 * swept.UNREACHABLE
        none = np.zeros(1, dtype=np.int64)
        for family in families:
            plus = none if extra is None else self._pick_barred(family, index, extra.box)
            counts = self.picks[family].counts[index : index + 1]
            fewest = min(fewest, int(swept.residue_minima(counts, none, plus, 1).min()))
        if 0 < fewest < swept.UNREACHABLE:
            cost = int((self.costs if extra is None else extra.costs)[index])
            # The cost is that of the cheapest family, which may not be among these.
            return max(cost, fewest) if cost < NEVER else swept.UNREACHABLE + fewest
        return fewest

    def _of_family(
        self, family: int, index: int, goal: GoalSites, grasp: Grasp | None, extra: Thought | None
    ) -> int:
        """The same with grasps of one family. What nothing bars needs no look at what bars what."""
        ways, picks = self.places_of(index, goal, family, grasp), self.picks[family]
        none, modulus = np.zeros(len(goal.xyz), dtype=np.int64), goal.modulus
        plus = none if extra is None else _place_barred(self.world, ways, family, extra.box[None])
        place = swept.residue_minima(ways.counts, ways.barred[:, index], plus.reshape(-1), modulus)
        turn = self._turn(index, goal, grasp) % modulus
        if turn:
            place = np.roll(place, -turn)
        if self.present[index]:
            held_by = none[:1] if extra is None else self._pick_barred(family, index, extra.box)
            counts = picks.counts[index : index + 1]
            pick = swept.residue_minima(counts, none[:1], held_by, modulus)
        else:
            pick = np.zeros(modulus, dtype=np.int64)
            if grasp is not None:  # it fixes the heading of the approach for each of the object
                pick[1:] = 2 * swept.UNREACHABLE
        at_most = int((pick + place).min())
        if at_most == 0 or int(np.maximum(pick, place).min()) >= swept.UNREACHABLE:
            return at_most
        if extra is not None and modulus == 1 and place[0] == 0 and not extra.bars.any():
            return self._of_family(family, index, goal, grasp, None)
        cost, _ = self._cleared(family, index, goal, grasp, extra, modulus == 1 and place[0] == 0)
        return cost if cost < NEVER else swept.UNREACHABLE + at_most

    def _turn(self, index: int, goal: GoalSites, grasp: Grasp | None) -> int:
        """Headings from the way to an object, or from bit 0 where a grasp holds it, to the way
        to a goal that prescribes its heading."""
        yaw = goal.world_yaw
        if yaw is None:
            return 0
        if not self.present[index]:
            return 0 if grasp is None else round((yaw + grasp.heading) / STEP)
        at = self.world.rests(self.placements, index)
        assert at is not None
        return round((yaw - at[3]) / STEP)

    def _cleared(
        self,
        family: int,
        index: int,
        goal: GoalSites,
        grasp: Grasp | None,
        extra: Thought | None,
        placeable: bool = False,
        turn: Turn | None = None,
    ) -> tuple[int, NDArray[np.bool_]]:
        """The cost of what is to be taken away before an object can be picked up and put at its
        goal with grasps of a family, or as a turn does, and what bars the cheapest ways (n + 1,).
        `placeable`: nothing bars the latter."""
        picks, there = self.picks[family], family if turn is None else turn.there.family
        ways = self.places_of(index, goal, there, grasp if turn is None else turn.there)
        costs = np.where(self.present > 0, self.costs if extra is None else extra.costs, -1)
        costs = np.append(costs, -1 if extra is None else 0)
        costs[index] = -1
        pick, pickable = np.append(picks.barred[index], 0), int(picks.reachable[index])
        if turn is not None and self.present[index]:
            pickable &= self._headings(turn, index)
        place, reachable = np.zeros((1, len(costs)), dtype=np.int64), np.array([swept.ALL])
        if not placeable:
            plus = np.zeros((len(goal.xyz), 1), dtype=np.int64)
            if extra is not None:
                plus = _place_barred(self.world, ways, there, extra.box[None])
            place, reachable = np.hstack([ways.barred, plus]), ways.reachable
        if not self.present[index]:
            pick[:], pickable = 0, swept.ALL if grasp is None else 1
        elif extra is not None:
            pick[-1] = extra.bars[self.world.families.index(family), index]
        onwards = self._turn(index, goal, grasp) % goal.modulus
        found: tuple[int, NDArray[np.bool_]] = clearing.least_cost(
            pick, pickable, place, reachable, costs, goal.modulus, onwards
        )
        return found

    @cached_property
    def costs(self) -> Ints:
        """The cost of taking away each object (n,)."""
        return self.costs_with(np.zeros((len(self.picks), len(self.boxes)), dtype=np.int64))

    def costs_with(self, bars: Ints) -> Ints:
        """The same, with one more object that bars some headings to the others (F, n)."""
        found: Ints = clearing.clearing_costs(*self._barred, bars, self.present)
        return found

    @property
    def _barred(self) -> tuple[Ints, Ints]:
        """What bars what (F, n, n), and how many bar each heading (F, n, K)."""
        barred = np.array([picks.barred for picks in self.picks.values()])
        return barred, np.array([picks.counts for picks in self.picks.values()])

    def _pick_barred(self, family: int, index: int, box: Floats) -> Ints:
        """Bits (1,) of the headings to an object that a box bars."""
        picks, one = self.picks[family], slice(index, index + 1)
        found: Ints = swept.barred_matrix(
            self.sites[one],
            picks.holds[one],
            picks.heights[one],
            self.world.own(index, face_of(self.placements[index]))[None],
            box[None],
            self.world.hand.sweeps[family],
            0.0,
        )[0]
        return found

    def in_the_way(self, index: int, goal: GoalSites) -> list[int]:
        """Objects to be taken away before an object can be picked up and put at its goal, along
        any of the cheapest ways; where there is none, those that bar a least barred heading."""
        chosen, faces = np.zeros(len(self.boxes), dtype=np.bool_), faces_at(self.world, index, goal)
        if self.waits(goal):
            fewest = int(self.costs[index])
            chosen[index] = True
        else:
            if faces == (0,):
                ways = [self._cleared(family, index, goal, None, None) for family in self.picks]
            else:
                ways = [
                    self._cleared(turn.family, index, goal, None, None, turn=turn)
                    for turn in self._turns(faces, index, None)
                ]
            fewest = min((cost for cost, _ in ways), default=NEVER)
            for cost, bars in ways:
                if cost == fewest:
                    chosen |= bars[:-1]
        if fewest >= NEVER:
            return self._least_bars(index, goal)
        costs = np.where(self.present > 0, self.costs, -1)
        found = clearing.all_to_clear(chosen, *self._barred, costs)
        found[index] = False
        return [int(i) for i in np.flatnonzero(found)]

    def _least_bars(self, index: int, goal: GoalSites) -> list[int]:
        """Objects that bar a least barred heading to an object, or to a site of its goal."""
        found: set[int] = set()
        for f in self._best(self.picks[f].counts[index].min() for f in self.world.families):
            picks = self.picks[self.world.families[f]]
            counts = picks.counts[index]
            for k in np.flatnonzero(counts == counts.min()):
                found |= {int(j) for j in np.flatnonzero((picks.barred[index] >> k) & 1)}
        faces = faces_at(self.world, index, goal)
        ways = [self.places_of(index, goal, f) for f in self.world.families]
        if faces != (0,):
            there = [turn.there for turn in self._turns(faces, index, None)]
            ways = [self.places_of(index, goal, g.family, g) for g in there] or ways
        for f in self._best(way.counts.min() for way in ways):
            barred, counts = ways[f].barred, ways[f].counts
            fewest = counts.min()
            if fewest > 0:
                for site, k in np.argwhere(counts == fewest):
                    found |= {int(j) for j in np.flatnonzero((barred[site] >> k) & 1)}
        found.discard(index)
        return sorted(found)

    @staticmethod
    def _best(values: Iterable[int]) -> list[int]:
        known = list(values)
        return [i for i, value in enumerate(known) if value == min(known)]

    # -- beta -----------------------------------------------------------------------------------

    def disturbed_by(self, index: int, placement: Placement, misplaced: frozenset[int]) -> int:
        """How many other misplaced objects would be obstructed more, were an object there.

        The object itself must be away in this arrangement.
        """
        world = self.world
        at = world.rests_at(self.placements, index, placement)
        if at is None:
            return 1  # on something in the hand, or on what stands on the object itself
        box = world.box_row(index, at, placement.face)
        if world.owned:
            box[5] = tall(world, self.placements, index, placement.face) / 2
            box[2] = at[2] + box[5]
        extra = Thought(self, index, box)
        owner = world.grounds[placement.support].owner
        below = frozenset() if owner is None else self.standing_on(owner)
        others = frozenset(i for i in misplaced if i != index and self.present[i])
        count = len(others & below)
        if not count and not extra.bars.any() and self._leaves_places(box[None], others)[0]:
            return 0
        for other in others - below:
            goal = world.goal_sites(other, self)
            if goal is None:
                continue
            before = self.obstructions(other, goal)
            if not self._both_far(extra, other, goal) or (before > 0 and extra.bars.any()):
                count += self.obstructions_with(other, goal, None, extra) > before
        return count

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

    def has_harmless_site(self, index: int, goal: GoalSites, others: frozenset[int]) -> bool:
        """Whether an object could go to a site of its goal, on furniture, where it certainly is in
        nobody's way: it bars no heading to any object, and leaves a free one to the goals of the
        others. That holds, too, once the object itself is away."""
        world = self.world
        key = (goal.key, world.kinds[index])
        harmless = self.site_table(index, goal).harmless(index)
        if not harmless.any():
            return False
        groups = self._groups_of(others)
        alone = next((g for g in groups if groups[g] == (index,)), None)
        # Of one kind with one goal any will do, but where things ride on each other.
        question = (key, others, alone, index if world.owned else None)
        if question not in self.left:
            boxes = world.site_boxes(index, goal)
            asked = [group[group[0] == index] for g, group in groups.items() if g != alone]
            self.left[question] = self._leaves_places(boxes, asked, known_as=key)
        return bool((harmless & self.left[question]).any())

    def _groups_of(self, others: frozenset[int]) -> dict[Hashable, tuple[int, ...]]:
        """Objects that stand somewhere, the first two of each kind with the same goal."""
        if others not in self.groups:
            found: dict[Hashable, tuple[int, ...]] = {}
            for other in sorted(others):
                goal = self.world.goal_sites(other, self)
                if self.present[other] and goal is not None:
                    group = (goal.key, self.world.kinds[other], self._face(other, None))
                    found[group] = (*found.get(group, ()), other)[:2]
            self.groups[others] = found
        return self.groups[others]

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

    def _leaves_places(
        self, boxes: Floats, others: Iterable[int], known_as: Hashable = None
    ) -> NDArray[np.bool_]:
        """Which boxes (b, 8), thought to be there one at a time, bar nothing on the way to the
        goals of others, or leave free ways to other sites of these (b,). `known_as` names boxes
        that are always the same, and what they bar is remembered."""
        world, seen = self.world, set()
        fine = np.ones(len(boxes), dtype=np.bool_)
        for other in others:
            goal = world.goal_sites(other, self)
            if goal is None or self.waits(goal) or (goal.key, world.kinds[other]) in seen:
                continue
            if faces_at(world, other, goal) != (0,) or self._face(other, None):
                return np.zeros(len(boxes), dtype=np.bool_)  # it is turned on its way there
            seen.add((goal.key, world.kinds[other]))
            places = {f: self.places_of(other, goal, f) for f in world.families}
            # Where no site is reached anyway there is nothing to lose.
            open_ones = {f: ways for f, ways in places.items() if ways.reachable.any()}
            for family, ways in (open_ones or places).items():
                spared = ways.spared.get(known_as)
                if spared is None:
                    spared = self._spared(ways, family, boxes, known_as, world.kinds[other])
                    if known_as is not None:
                        ways.spared[known_as] = spared
                if spared is not NOTHING_BARRED:
                    fine &= spared
        return fine

    def _spared(
        self, ways: Places, family: int, boxes: Floats, known_as: Hashable, kind: int
    ) -> NDArray[np.bool_]:
        """Which boxes (b,) bar nothing on the ways to the sites of a goal, or leave a way free to
        one of them where any will do."""
        plus = self._barred_by(ways, family, boxes, known_as, kind)
        if plus is None:
            return NOTHING_BARRED
        harmless: NDArray[np.bool_] = np.logical_not(plus.any(axis=0))
        if ways.goal.modulus == 1:
            harmless |= (ways.free[:, None] & ~plus).any(axis=0)
        return harmless

    def _barred_by(
        self, ways: Places, family: int, boxes: Floats, known_as: Hashable, kind: int
    ) -> Ints | None:
        """Bits (S, b) of the headings to the sites of a goal that boxes bar; None where they bar
        none: most goals are far from each other."""

        def compute() -> Ints | None:
            found = _place_barred(self.world, ways, family, boxes)
            return found if found.any() else None

        if known_as is None or ways.goal.frame is not None:
            return compute()
        if self._all_far(ways, boxes):
            return None
        question = (known_as, ways.goal.key, kind, family, ways.hold.key)
        return self.world.memory.answer("sites bar sites", question, compute)

    def _all_far(self, ways: Places, boxes: Floats) -> bool:
        """Whether boxes (b, 8) are too far from the sites of a goal to bar a way to any of them, by
        circles around all of them."""
        (x, y), radius = ways.goal.circle
        reach = radius + max(self._reach(ways.hold), ways.extent)
        away = np.hypot(boxes[:, 0] - x, boxes[:, 1] - y) - np.hypot(boxes[:, 3], boxes[:, 4])
        return bool(away.min() > reach)

    def _both_far(self, extra: Thought, other: int, goal: GoalSites) -> bool:
        """Whether a box is too far from an object and from its goal to be in its way."""
        (x, y), radius = goal.circle
        hold = self.world.place_hold(other, self.world.families[0], goal.world_yaw, None)
        reach = self._reach(hold) + 2 * self.world.radius(other)
        site = self.sites[other]
        return bool(
            point_distance(extra.box, site[0], site[1]) > reach
            and point_distance(extra.box, x, y) > reach + radius
        )


def changes(world: TabletopWorld, before: Placements, after: Placements) -> list[int]:
    """What rests elsewhere, or on something that does."""
    changed = [
        i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a is not b and a != b
    ]
    for i in list(changed):
        riders = {*world.riders(before, i), *world.riders(after, i)}
        changed += [r for r in riders if r not in changed]
    return changed


def face_of(placement: Placement | None) -> int:
    """The face on which an object rests; that of the start where it is held."""
    return 0 if placement is None else placement.face


def _pick_row(
    world: TabletopWorld,
    index: int,
    family: int,
    site: Floats,
    yaw: float,
    placement: Placement | None,
    present: int,
) -> tuple[Floats, float, int]:
    """How an object is taken where it rests, and bits of the headings that the robot reaches."""
    if not present:
        return np.zeros((HEADINGS, 3)), 0.0, 0
    face = face_of(placement)
    hold = world.hold(index, family, yaw, face)
    x, y, z = site.tolist()
    return hold.rows, hold.height, world.reachable_at(index, family, (x, y, z, yaw), face)


def _columns(rows: Sequence[tuple[Floats, float, int]]) -> tuple[Floats, Floats, Ints]:
    holds = np.array([row[0] for row in rows]).reshape(-1, HEADINGS, 3)
    heights = np.array([row[1] for row in rows], dtype=np.float64)
    return holds, heights, np.array([row[2] for row in rows], dtype=np.int64)


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


def _place_barred(world: TabletopWorld, ways: Places, family: int, boxes: Floats) -> Ints:
    """Bits (S, n) of the headings to the sites of a goal that boxes (n, 8) bar."""
    holds, heights, owns = ways.repeated
    sweep = world.hand.sweeps[family]
    found: Ints = swept.barred_matrix(ways.goal.xyz, holds, heights, owns, boxes, sweep, 0.0)
    for s, stands in enumerate(() if ways.stands is None else ways.stands):
        # Where its heading is prescribed, what reaches into its corners is in its place, too.
        away = np.hypot(boxes[:, 0] - stands[0], boxes[:, 1] - stands[1])
        near = away < np.hypot(boxes[:, 3], boxes[:, 4]) + math.hypot(stands[3], stands[4])
        for j in np.flatnonzero(near & (found[s] != swept.ALL)):
            apart = abs(boxes[j, 2] - stands[2]) >= boxes[j, 5] + stands[5] - swept.LEVEL
            if not apart and footprints_meet(stands, boxes[j], 0.0):
                found[s, j] = swept.ALL
    return found
