"""The functions of the domain that speak of obstruction: misplaced, alpha, beta (paper, Sketch).

They are functions of where the objects are and of the grasp alone: not of the samples of a
subproblem, not of where the robot stands, not of what was asked before.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import TYPE_CHECKING

from domains.tabletop.faces import faces_at, turned
from domains.tabletop.features import swept
from domains.tabletop.features.arrangement import FAR_OFF, Arrangement
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.state import Placement, State

if TYPE_CHECKING:
    from domains.tabletop.world import Placements, TabletopWorld

CACHED_OBJECTS = 12_000
"""As many arrangements are remembered as hold so many objects together, ..."""

CACHED_PAIRS = 12_000_000
"""... and so many pairs of them, for each family of approaches: tables of what bars what are
square."""

FEWEST = 4
"""Arrangements that are remembered however large they are."""

SAME = 16
"""Tuples of placements that are known by themselves, without a look at what is in them."""

LOOK_BACK = 12
"""Arrangements that are looked through for one that differs in one object only."""


def arrangement(world: TabletopWorld, placements: Placements) -> Arrangement:
    """The geometry of an arrangement, from memory where it is known."""
    # Hashing the places of many objects takes its time: first whether it is the very same tuple.
    same = world.memory.table("arrangements of tuples")
    kept, found = same.get(id(placements), (None, None))
    if kept is placements:
        return found  # type: ignore[no-any-return]
    found = _remembered(world, placements)
    same[id(placements)] = placements, found  # keeps the tuple, so that its id is not used again
    if len(same) > min(SAME, _most(world)):
        same.popitem(last=False)
    return found


def _remembered(world: TabletopWorld, placements: Placements) -> Arrangement:
    known = world.memory.table("arrangements")
    found = known.get(placements)
    if found is None:
        origin = _origin(known.values(), placements)
        found = origin.moved(placements) if origin else Arrangement.afresh(world, placements)
        known[placements] = found
        if len(known) > _most(world):
            known.popitem(last=False)
    else:
        known.move_to_end(placements)
    return found


def _most(world: TabletopWorld) -> int:
    """How many arrangements are remembered."""
    number = max(1, len(world.items))
    pairs = number**2 * len(world.families)
    return max(FEWEST, min(CACHED_OBJECTS // number, CACHED_PAIRS // pairs))


def _origin(known: object, placements: Placements) -> Arrangement | None:
    """A recent arrangement that differs in one object only."""
    for candidate in islice(reversed(known), LOOK_BACK):  # type: ignore[call-overload]
        changed = 0
        for a, b in zip(candidate.placements, placements, strict=True):
            if a is not b and a != b:
                changed += 1
                if changed > 1:
                    break
        if changed <= 1:
            return candidate  # type: ignore[no-any-return]
    return None


def misplaced(state: State) -> frozenset[int]:
    """Objects that stand outside their goal, or are held and their goal is blocked."""
    here = arrangement(state.world, state.placements)
    known = here.misplaced.get(state.grasp)
    if known is None:
        found = set(here.unplaced())
        if state.held is not None:
            goal = state.world.goal_sites(state.held, here)
            if goal is not None and (
                here.waits(goal) or here.obstructions(state.held, goal, state.grasp) > 0
            ):
                found.add(state.held)
        known = here.misplaced[state.grasp] = frozenset(found)
    return known


def settled(state: State) -> frozenset[int]:
    """Objects that rest where the scene wants them, as do all that they stand on."""
    return arrangement(state.world, state.placements).settled


def next_to_settle(state: State) -> frozenset[int]:
    """Objects that are not settled, though all that they are to stand on is."""
    return arrangement(state.world, state.placements).next_to_settle


def bars_settling(state: State, other: int, index: int) -> bool:
    """Whether an object is to be taken away before another one, next to settle, can be put down."""
    return arrangement(state.world, state.placements).bars_settling(index, other)


def obstructions(state: State, index: int) -> int:
    """alpha of an object: what is to be taken away before it can be picked up and put at its
    goal with the same grasp (0 for an object without a goal)."""
    here = arrangement(state.world, state.placements)
    goal = state.world.goal_sites(index, here)
    if goal is None:
        return 0
    return here.obstructions(index, goal, state.grasp if state.held == index else None)


def bars(state: State, index: int) -> int:
    """What is to be taken away before an object can be picked up, wherever it goes then."""
    if state.held == index:
        return 0
    here = arrangement(state.world, state.placements)
    return here.barred_from_picking(index)


def goal_placements(state: State, index: int) -> tuple[Placement, ...]:
    """Goal placements of an object that no other object occupies."""
    here = arrangement(state.world, state.placements)
    goal = state.world.goal_sites(index, here)
    if goal is None:
        return ()
    found: list[Placement] = []
    boxes, ground = here.boxes, state.world.grounds[goal.support]
    if ground.peg is not None and ground.owner is not None:
        boxes = boxes.copy()  # what stands on an object goes over the peg of it
        boxes[ground.owner] = FAR_OFF
    for face in _faces(state, index, goal):
        own = state.world.own(index, face)
        taken = swept.occupied_sites(goal.xyz, own, boxes, index)
        sites = zip(goal.placements, taken, strict=True)
        found += [p._replace(face=face) if face else p for p, occupied in sites if not occupied]
    return tuple(found)


def _faces(state: State, index: int, goal: GoalSites) -> Sequence[int]:
    """The faces on which an object may be put at its goal; where it is held, those among them
    on which the grasp can put it."""
    faces, grasp = faces_at(state.world, index, goal), state.grasp
    if faces == (0,) or grasp is None or state.held != index:
        return faces
    return [f for f in faces if turned(state.world, index, grasp, f) is not None] or faces


def disturbed_by(state: State, index: int, placement: Placement) -> int:
    """How many other misplaced objects are obstructed more with the object there."""
    return _without(state, index).disturbed_by(index, placement, misplaced(state))


def disturbances(state: State, index: int) -> int:
    """beta of an object: fewest misplaced objects that a goal place of it blocks."""
    here = arrangement(state.world, state.placements)
    key = (index, state.grasp)
    if key not in here.beta:
        here.beta[key] = _disturbances(state, index, here)
    return here.beta[key]


def _disturbances(state: State, index: int, here: Arrangement) -> int:
    goal = state.world.goal_sites(index, here)
    if goal is None:
        return 0
    others = misplaced(state)
    owner = state.world.grounds[goal.support].owner
    if owner is not None and not here.present[owner]:
        # What it is to stand on is in the hand: on its way to its goal, or not.
        return int(owner in others)
    settled = owner is None and state.world.goals.keys() >= others
    # If no goal depends on where things are, what is certain need not be looked at without it.
    certain = settled and 0 in _faces(state, index, goal)
    if certain and here.has_harmless_site(index, goal, others):
        return 0
    fewest = len(others)
    for placement in goal_placements(state, index) or goal.placements:
        fewest = min(fewest, _without(state, index).disturbed_by(index, placement, others))
        if fewest == 0:
            break
    return fewest


def _without(state: State, index: int) -> Arrangement:
    placements = state.placements
    if placements[index] is not None:
        placements = (*placements[:index], None, *placements[index + 1 :])
    return arrangement(state.world, placements)
