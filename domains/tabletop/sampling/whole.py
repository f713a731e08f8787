"""Samples for a whole problem, for searches that no sketch cuts into subproblems.

They are drawn once, by the samplers of subproblems and as densely, from where the problem starts:
grasps of every object, placements on every surface, goal placements of every object, and base
poses from which the one can be taken and the other be used. What bars a way at the start need
not bar it later, so ways that are not free count as well.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from domains.tabletop.faces import turned
from domains.tabletop.features import swept
from domains.tabletop.features.functions import arrangement
from domains.tabletop.sampling.bases import Wanted
from domains.tabletop.sampling.draw import DOUBT, Draw, OpenDraw
from domains.tabletop.sampling.few import kept, sample_few
from domains.tabletop.sampling.samples import Sampler, Samples
from domains.tabletop.state import Grasp, Placement, State
from domains.tabletop.world import TabletopWorld


@dataclass(frozen=True, eq=False)
class WholeSamples(Samples):
    """The sampled parameters of a whole problem."""

    def places_in(self, state: State) -> Iterable[Placement]:
        """The placements that nothing occupies, as far as the estimate tells."""
        assert state.held is not None
        return unoccupied(self.executor.world, state, state.held, self.places)


def unoccupied(
    world: TabletopWorld, state: State, index: int, places: Iterable[Placement]
) -> list[Placement]:
    """Those of some placements where nothing else stands. On what can be moved itself they all
    count as free: X tells."""
    here = arrangement(world, state.placements)
    fixed: dict[int, list[tuple[Placement, tuple[float, float, float]]]] = {}
    found: list[Placement] = []
    for placement in places:
        if world.grounds[placement.support].owner is not None:
            found.append(placement)
            continue
        at = world.rests_at(state.placements, index, placement)
        if at is not None:
            fixed.setdefault(placement.face, []).append((placement, at[:3]))
    for face, group in fixed.items():
        sites = np.array([site for _, site in group])
        taken = swept.occupied_sites(sites, world.own(index, face), here.boxes, index)
        found += [p for (p, _), occupied in zip(group, taken, strict=True) if not occupied]
    return found


def sample_whole(
    sampler: Sampler, state: State, attempt: int, rng: np.random.Generator
) -> WholeSamples:
    """Samples for the problem that starts in a state, with empty hands or not; denser with each
    attempt."""
    world = sampler.executor.world
    draw, anyway = Draw(state, attempt, rng), OpenDraw(state, attempt, rng)
    picks = []
    for index, placement in enumerate(state.placements):
        grasps = draw.held[1:] if placement is None else sampler.grasps.of(anyway, index)
        if grasps:
            picks.append((index, grasps))
    rests = any(placement is not None for placement in state.placements)
    places, largest = sampler.placements.anywhere(draw) if rests else ([], 0)
    wanted: list[Wanted] = []
    for index, grasps in picks:
        wanted.append((index, [(state.placements[index], grasp) for grasp in grasps]))
        own = _goal_places(sampler, anyway, index, grasps)
        places += own
        wanted.append((index, _used(world, index, grasps, own, rng)))
    for index, grasps in picks:
        if index == largest:
            wanted.append((index, _used(world, index, grasps, places, rng)))
    bases = sampler.bases.poses(draw, wanted)
    if kept(world):
        few = sample_few(world, sampler.grasps, sampler.placements, sampler.bases, draw)
        places, bases = [*places, *few.places], [*few.bases, *bases]
    added = tuple(
        (schema, action)
        for schema in sampler.schemas
        for action in schema.sample(state, min(attempt, DOUBT), rng)
    )
    unique = tuple(dict.fromkeys(places))
    return WholeSamples(sampler.executor, tuple(bases), tuple(picks), unique, None, added)


def _goal_places(
    sampler: Sampler, draw: Draw, index: int, grasps: tuple[Grasp, ...]
) -> list[Placement]:
    """Goal placements of an object, were it held with each of its grasps."""
    state = draw.state
    away = (*state.placements[:index], None, *state.placements[index + 1 :])
    holding = replace(draw, state=replace(state, placements=away, held=index, grasp=grasps[0]))
    return [p for grasp in grasps for p in sampler.placements.with_grasp(holding, grasp)]


def _used(
    world: TabletopWorld,
    index: int,
    grasps: tuple[Grasp, ...],
    places: Iterable[Placement],
    rng: np.random.Generator,
) -> list[tuple[Placement | None, Grasp]]:
    """Placements in random order, each with a grasp that puts the object there."""
    found: list[tuple[Placement | None, Grasp]] = []
    drawn = list(places)
    for k in rng.permutation(len(drawn)).tolist():
        placement = drawn[k]
        seen = turned(world, index, grasps[int(rng.integers(len(grasps)))], placement.face)
        if seen is not None:
            found.append((placement, seen))
    return found
