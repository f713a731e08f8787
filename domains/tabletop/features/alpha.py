"""alpha: the cost of taking away what is in the way of an object (paper, Sketch, SIW_R).

What bars the ways is read from an arrangement; what depends on it alone is remembered there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.faces import Turn, faces_at, turned, turns
from domains.tabletop.features import clearing, swept
from domains.tabletop.features.clearing import NEVER
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.features.towers import serving
from domains.tabletop.features.ways import face_of, place_barred
from domains.tabletop.state import Grasp
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement
    from domains.tabletop.world import Ints


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


def obstructions_with(
    here: Arrangement, index: int, goal: GoalSites, grasp: Grasp | None, extra: Thought | None
) -> int:
    """The cost of taking away what is in the way of picking an object up and putting it at a goal,
    with the same grasp for both, and with one more object thought to be there, if any."""
    families = here.world.families if grasp is None else (grasp.family,)
    if here.waits(goal):
        if not here.present[index]:
            return 0
        return _of_picking(here, index, serving(here, index, families), extra)
    if len(here.world.faces[index]) > 1:
        faces = faces_at(here.world, index, goal)
        if faces != (0,) or here.face(index, grasp):
            return _over_faces(here, faces, index, goal, grasp, extra)
    return min(_of_family(here, f, index, goal, grasp, extra) for f in families)


def _over_faces(
    here: Arrangement,
    faces: Sequence[int],
    index: int,
    goal: GoalSites,
    grasp: Grasp | None,
    extra: Thought | None,
) -> int:
    """The same for an object that may be put on one of some faces, whatever face it is
    on: the grasp is turned along with it."""
    fewest = 2 * swept.UNREACHABLE
    for turn in _turns(here, faces, index, grasp):
        ways = here.places_of(index, goal, turn.there.family, turn.there)
        plus = np.zeros(len(goal.xyz), dtype=np.int64)
        if extra is not None:
            plus = place_barred(here.world, ways, turn.there.family, extra.box[None])[:, 0]
        place = int(swept.residue_minima(ways.counts, ways.barred[:, index], plus, 1)[0])
        pick = _barring(here, turn, index, extra)
        least = pick + place
        if least > 0 and max(pick, place) < swept.UNREACHABLE:
            cost, _ = _cleared(here, turn.family, index, goal, grasp, extra, turn=turn)
            least = cost if cost < NEVER else swept.UNREACHABLE + least
        fewest = min(fewest, least)
    return fewest


def _turns(
    here: Arrangement, faces: Sequence[int], index: int, grasp: Grasp | None
) -> Iterable[Turn]:
    """The ways to put an object on one of some faces: of taking it, too, where it rests."""
    world, face = here.world, here.face(index, grasp)
    for to in faces:
        if grasp is None:
            yield from turns(world, index, face, to)
            continue
        there = turned(world, index, grasp, to)
        if there is not None:
            yield Turn(grasp.family, grasp.heading, there)


def _barring(here: Arrangement, turn: Turn, index: int, extra: Thought | None) -> int:
    """How many objects bar the way to take an object as a turn does; none where it is held."""
    if not here.present[index]:
        return 0
    bits, counts = _headings(here, turn, index), here.picks[turn.family].counts[index]
    plus = 0 if extra is None else int(_pick_barred(here, turn.family, index, extra.box)[0])
    near = [k for k in range(HEADINGS) if (bits >> k) & 1]
    return min(int(counts[k]) + ((plus >> k) & 1) for k in near)


def _headings(here: Arrangement, turn: Turn, index: int) -> int:
    """Bits of the headings next to that along which a turn takes an object where it rests."""
    at = here.world.rests(here.placements, index)
    assert at is not None
    return swept.near_headings(turn.angle + at[3])


def barred_from_picking(here: Arrangement, index: int) -> int:
    """The cost of taking away what is in the way of picking an object up that rests."""
    return _of_picking(here, index, here.world.families, None) if here.present[index] else 0


def _of_picking(
    here: Arrangement, index: int, families: Sequence[int], extra: Thought | None
) -> int:
    """The cost of taking away what is in the way of picking an object up."""
    fewest = 2 * swept.UNREACHABLE
    none = np.zeros(1, dtype=np.int64)
    for family in families:
        plus = none if extra is None else _pick_barred(here, family, index, extra.box)
        counts = here.picks[family].counts[index : index + 1]
        fewest = min(fewest, int(swept.residue_minima(counts, none, plus, 1).min()))
    if 0 < fewest < swept.UNREACHABLE:
        cost = int((here.costs if extra is None else extra.costs)[index])
        # The cost is that of the cheapest family, which may not be among these.
        return max(cost, fewest) if cost < NEVER else swept.UNREACHABLE + fewest
    return fewest


def _of_family(
    here: Arrangement,
    family: int,
    index: int,
    goal: GoalSites,
    grasp: Grasp | None,
    extra: Thought | None,
) -> int:
    """The same with grasps of one family. What nothing bars needs no look at what bars what."""
    ways, picks = here.places_of(index, goal, family, grasp), here.picks[family]
    none, modulus = np.zeros(len(goal.xyz), dtype=np.int64), goal.modulus
    plus = none if extra is None else place_barred(here.world, ways, family, extra.box[None])
    place = swept.residue_minima(ways.counts, ways.barred[:, index], plus.reshape(-1), modulus)
    turn = _turn(here, index, goal, grasp) % modulus
    if turn:
        place = np.roll(place, -turn)
    if here.present[index]:
        held_by = none[:1] if extra is None else _pick_barred(here, family, index, extra.box)
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
        return _of_family(here, family, index, goal, grasp, None)
    cost, _ = _cleared(here, family, index, goal, grasp, extra, modulus == 1 and place[0] == 0)
    return cost if cost < NEVER else swept.UNREACHABLE + at_most


def _turn(here: Arrangement, index: int, goal: GoalSites, grasp: Grasp | None) -> int:
    """Headings from the way to an object, or from bit 0 where a grasp holds it, to the way
    to a goal that prescribes its heading."""
    yaw = goal.world_yaw
    if yaw is None:
        return 0
    if not here.present[index]:
        return 0 if grasp is None else round((yaw + grasp.heading) / STEP)
    at = here.world.rests(here.placements, index)
    assert at is not None
    return round((yaw - at[3]) / STEP)


def _cleared(
    here: Arrangement,
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
    picks, there = here.picks[family], family if turn is None else turn.there.family
    ways = here.places_of(index, goal, there, grasp if turn is None else turn.there)
    costs = np.where(here.present > 0, here.costs if extra is None else extra.costs, -1)
    costs = np.append(costs, -1 if extra is None else 0)
    costs[index] = -1
    pick, pickable = np.append(picks.barred[index], 0), int(picks.reachable[index])
    if turn is not None and here.present[index]:
        pickable &= _headings(here, turn, index)
    place, reachable = np.zeros((1, len(costs)), dtype=np.int64), np.array([swept.ALL])
    if not placeable:
        plus = np.zeros((len(goal.xyz), 1), dtype=np.int64)
        if extra is not None:
            plus = place_barred(here.world, ways, there, extra.box[None])
        place, reachable = np.hstack([ways.barred, plus]), ways.reachable
    if not here.present[index]:
        pick[:], pickable = 0, swept.ALL if grasp is None else 1
    elif extra is not None:
        pick[-1] = extra.bars[here.world.families.index(family), index]
    onwards = _turn(here, index, goal, grasp) % goal.modulus
    found: tuple[int, NDArray[np.bool_]] = clearing.least_cost(
        pick, pickable, place, reachable, costs, goal.modulus, onwards
    )
    return found


def _pick_barred(here: Arrangement, family: int, index: int, box: Floats) -> Ints:
    """Bits (1,) of the headings to an object that a box bars."""
    picks, one = here.picks[family], slice(index, index + 1)
    found: Ints = swept.barred_matrix(
        here.sites[one],
        picks.holds[one],
        picks.heights[one],
        here.world.own(index, face_of(here.placements[index]))[None],
        box[None],
        here.world.hand.sweeps[family],
        0.0,
    )[0]
    return found


def in_the_way(here: Arrangement, index: int, goal: GoalSites) -> list[int]:
    """Objects to be taken away before an object can be picked up and put at its goal, along
    any of the cheapest ways; where there is none, those that bar a least barred heading."""
    chosen, faces = np.zeros(len(here.boxes), dtype=np.bool_), faces_at(here.world, index, goal)
    if here.waits(goal):
        fewest = int(here.costs[index])
        chosen[index] = True
    else:
        if faces == (0,):
            ways = [_cleared(here, family, index, goal, None, None) for family in here.picks]
        else:
            ways = [
                _cleared(here, turn.family, index, goal, None, None, turn=turn)
                for turn in _turns(here, faces, index, None)
            ]
        fewest = min((cost for cost, _ in ways), default=NEVER)
        for cost, bars in ways:
            if cost == fewest:
                chosen |= bars[:-1]
    if fewest >= NEVER:
        return _least_bars(here, index, goal)
    costs = np.where(here.present > 0, here.costs, -1)
    found = clearing.all_to_clear(chosen, *here.what_bars, costs)
    found[index] = False
    return [int(i) for i in np.flatnonzero(found)]


def _least_bars(here: Arrangement, index: int, goal: GoalSites) -> list[int]:
    """Objects that bar a least barred heading to an object, or to a site of its goal."""
    found: set[int] = set()
    for f in _best(here.picks[f].counts[index].min() for f in here.world.families):
        picks = here.picks[here.world.families[f]]
        counts = picks.counts[index]
        for k in np.flatnonzero(counts == counts.min()):
            found |= {int(j) for j in np.flatnonzero((picks.barred[index] >> k) & 1)}
    faces = faces_at(here.world, index, goal)
    ways = [here.places_of(index, goal, f) for f in here.world.families]
    if faces != (0,):
        there = [turn.there for turn in _turns(here, faces, index, None)]
        ways = [here.places_of(index, goal, g.family, g) for g in there] or ways
    for f in _best(way.counts.min() for way in ways):
        barred, counts = ways[f].barred, ways[f].counts
        fewest = counts.min()
        if fewest > 0:
            for site, k in np.argwhere(counts == fewest):
                found |= {int(j) for j in np.flatnonzero((barred[site] >> k) & 1)}
    found.discard(index)
    return sorted(found)


def _best(values: Iterable[int]) -> list[int]:
    known = list(values)
    return [i for i, value in enumerate(known) if value == min(known)]
