"""Samples for objects that may rest in few places only, discs that go over pegs for instance.

Such an object cannot be put aside just anywhere: where it goes bars what goes there, and several of
them have to be moved, some more than once, before one of them is where it should be. So all of
them are sampled for every subproblem, on all supports on which they may rest, whether something
stands there now or not; and few base poses, those from which most of that is within reach.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from domains.tabletop.actions.executability import Target, within_reach
from domains.tabletop.features.functions import arrangement
from domains.tabletop.sampling.bases import BaseSampler, Wanted
from domains.tabletop.sampling.draw import Draw, OpenDraw
from domains.tabletop.sampling.grasps import GraspSampler, Picks
from domains.tabletop.sampling.placements import PlacementSampler
from domains.tabletop.state import BasePose, Grasp, Placement, State
from domains.tabletop.world import TabletopWorld

TURNS = 3
"""Headings in which an object is put over a peg; each turns the hand otherwise for each grasp."""

BASES = 2
"""Base poses that are kept at the first attempt."""


@dataclass(frozen=True, eq=False)
class FewPlaces:
    """Grasps of the objects that are kept to some supports, placements of them there, and base
    poses for both."""

    picks: Picks
    places: tuple[Placement, ...]
    bases: tuple[BasePose, ...]


def kept(world: TabletopWorld) -> tuple[int, ...]:
    """The objects that may rest on some supports only."""
    things = world.scene.objects
    return tuple(i for i, thing in enumerate(things) if thing.only_on is not None)


def sample_few(
    world: TabletopWorld,
    grasps: GraspSampler,
    placements: PlacementSampler,
    bases: BaseSampler,
    draw: Draw,
) -> FewPlaces:
    """The samples for the subproblem that starts in a state."""
    state, anyway = draw.state, OpenDraw(draw.state, draw.attempt, draw.rng)
    picks: Picks = []
    places: list[Placement] = []
    wanted: list[Wanted] = []
    for index in kept(world):
        placement = state.placements[index]
        if placement is None and index != state.held:
            continue  # it is thought away
        taken = (draw.held[1],) if placement is None else grasps.of(anyway, index)
        if not taken:
            continue
        if placement is not None:
            picks.append((index, taken))
        own = _places(world, placements, anyway, index, taken[0])
        places += own
        put = [(p, taken[k % len(taken)]) for k, p in enumerate(own)]
        now = [] if placement is None else [(placement, grasp) for grasp in taken]
        wanted.append((index, [pair for pair in put + now if pair[0].face == pair[1].face]))
    drawn = bases.poses(draw, wanted)
    return FewPlaces(
        picks,
        tuple(dict.fromkeys(places)),
        tuple(_reaching_most(world, state, drawn, wanted)[: BASES * draw.scale]),
    )


def _places(
    world: TabletopWorld, placements: PlacementSampler, draw: Draw, index: int, grasp: Grasp
) -> list[Placement]:
    """Placements of an object on all supports on which it may rest, were it held with a grasp."""
    only_on = world.scene.objects[index].only_on
    assert only_on is not None
    found: list[Placement] = []
    for support in sorted(only_on):
        ground = world.grounds[support]
        if not world.may_rest(index, support, grasp.face) or ground.owner == index:
            continue
        if ground.peg is None:
            away = (*draw.state.placements[:index], None, *draw.state.placements[index + 1 :])
            if ground.owner is None or arrangement(world, away).present[ground.owner]:
                state = replace(draw.state, placements=away, held=index, grasp=grasp)
                found += placements.on(replace(draw, state=state), support)
            continue
        x, y = ground.outside(0.0, 0.0)
        number, first = TURNS * draw.scale, draw.rng.uniform(0.0, 2 * math.pi)
        for k in range(number):
            yaw = first + 2 * math.pi * k / number
            found.append(Placement.of(x, y, yaw, support, grasp.face))
    return found


def _reaching_most(
    world: TabletopWorld, state: State, drawn: Sequence[BasePose], wanted: Sequence[Wanted]
) -> list[BasePose]:
    """Base poses, those first from which most of what is wanted is within reach."""
    targets: list[Target] = [
        (index, placement, grasp)
        for index, pairs in wanted
        for placement, grasp in pairs
        if placement is not None
    ]
    counts = [int(within_reach(world, state, base, targets).sum()) for base in drawn]
    return [drawn[k] for k in sorted(range(len(drawn)), key=lambda k: -counts[k])]
