"""Samples of a subproblem, and the actions they give."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from domains.tabletop.actions.actions import Action, ActionSchema, MoveBase, Pick, Place
from domains.tabletop.actions.executability import Executor, Target
from domains.tabletop.faces import turned
from domains.tabletop.features.functions import arrangement
from domains.tabletop.room import goes_over
from domains.tabletop.sampling.bases import BaseSampler, Wanted
from domains.tabletop.sampling.draw import BASES, DOUBT, Draw
from domains.tabletop.sampling.few import kept, sample_few
from domains.tabletop.sampling.grasps import GraspSampler
from domains.tabletop.sampling.placements import PlacementSampler
from domains.tabletop.sampling.shut_in import leading_on
from domains.tabletop.state import BasePose, Grasp, Placement, State
from domains.tabletop.world import TabletopWorld

READY = 2
"""Base poses for an object that is ready to go, for one of any other."""

REGRASP_PLACES = 4
"""Places at which the held object may be put down to grip it anew."""


@dataclass(frozen=True, eq=False)
class Samples:
    """The sampled parameters of one subproblem: A(s) for all its states s."""

    executor: Executor
    bases: tuple[BasePose, ...]
    picks: tuple[tuple[int, tuple[Grasp, ...]], ...]
    places: tuple[Placement, ...]
    placed: int | None  # the object that `places` are for; None: any
    added: tuple[tuple[ActionSchema, Action], ...] = ()

    def actions(self, state: State) -> Iterator[tuple[Action, State]]:
        """Sampled ground actions in a state, and where each leads if it is executable.

        Manipulations have passed InArmWorkspace. They come before base moves, and near
        bases before far ones: within a layer of the breadth-first search, cheap first.
        """
        executor = self.executor
        targets: list[Target] = []
        standing = arrangement(executor.world, state.placements)
        if state.held is None:
            for index, grasps in self.picks:
                placement = state.placements[index]
                if placement is not None and standing.can_be_taken(index):
                    targets.extend(
                        (index, placement, grasp)
                        for grasp in grasps
                        if grasp.face == placement.face
                    )
        elif state.grasp is not None and self.placed in (None, state.held):
            for placement in self.places_in(state):
                if not is_open(executor.world, state, state.held, placement):
                    continue
                seen = turned(executor.world, state.held, state.grasp, placement.face)
                if seen is not None:
                    targets.append((state.held, placement, seen))
        for index, placement, grasp in executor.in_arm_workspace(state, state.base, targets):
            action = Pick(index, grasp) if state.held is None else Place(index, placement)
            yield action, action.after(state)
        for schema, added in self.added:
            if schema.applicable(state, added):
                yield added, added.after(state)
        here = state.base
        for base in sorted(self.bases, key=lambda b: (b.x - here.x) ** 2 + (b.y - here.y) ** 2):
            if base != here:
                move = MoveBase(base)
                yield move, move.after(state)

    def places_in(self, state: State) -> Iterable[Placement]:
        """The placements to try for what is held."""
        return self.places


def is_open(world: TabletopWorld, state: State, index: int, placement: Placement) -> bool:
    """Whether an object may rest on a support at all; and where that is around a peg or a hole,
    whether nothing else is there, and it goes over what rises there."""
    if not world.may_rest(index, placement.support, placement.face):
        return False
    if world.grounds[placement.support].peg is None:
        return True
    at = world.rests_at(state.placements, index, placement)
    peg = None if at is None else world.peg_over(placement.support, at)
    if peg is not None and not goes_over(world.item(index, placement.face), peg):
        return False
    return all(p is None or p.support != placement.support for p in state.placements)


class Sampler:
    """Samples the subproblems of one task; `schemas` are actions that the domain adds."""

    def __init__(
        self, world: TabletopWorld, executor: Executor, schemas: Sequence[ActionSchema] = ()
    ) -> None:
        self.executor = executor
        self.schemas = tuple(schemas)
        self.grasps = GraspSampler(world)
        self.placements = PlacementSampler(world)
        self.bases = BaseSampler(world, executor.roads_for)

    def sample(self, state: State, attempt: int, rng: np.random.Generator) -> Samples:
        """Samples for the subproblem that starts in a state; `attempt` counts its failures."""
        draw, few = Draw(state, attempt, rng), kept(self.executor.world)
        if not few or (state.held is not None and state.held not in few):
            return self._sample(draw)
        drawn = sample_few(self.executor.world, self.grasps, self.placements, self.bases, draw)
        added = tuple(self._added(draw))
        found = Samples(self.executor, drawn.bases, tuple(drawn.picks), drawn.places, None, added)
        if state.held is not None or len(few) == len(state.placements):
            return found
        others = self._sample(draw)
        return replace(
            found,
            bases=found.bases + others.bases,
            picks=found.picks + tuple(pick for pick in others.picks if pick[0] not in few),
            places=found.places + others.places,
        )

    def _added(self, draw: Draw) -> list[tuple[ActionSchema, Action]]:
        return [
            (schema, action)
            for schema in self.schemas
            for action in schema.sample(draw.state, draw.attempt, draw.rng)
        ]

    def _sample(self, draw: Draw) -> Samples:
        """Samples for objects that can be put anywhere."""
        state, attempt = draw.state, draw.attempt
        wanted: list[Wanted] = []
        if state.held is None:
            picks = self.grasps.picks(draw)
            if attempt == 0:
                picks = leading_on(self.grasps.world, self.bases.room, state, picks)
            ready = {index for index, _ in picks if self.grasps.is_ready(state, index)}
            # What is ready to go deserves more places to stand than what is in its way, and half
            # of all in the end.
            copies = min(READY * draw.scale, BASES * draw.scale // (2 * max(1, len(ready))))
            for index, grasps in picks:
                targets = [(state.placements[index], grasp) for grasp in grasps]
                for k in range(max(READY, copies) if index in ready else 1):
                    first = k % len(targets)
                    wanted.append((index, targets[first:] + targets[:first]))
            places, largest = self.placements.anywhere(draw) if draw.doubting else ([], 0)
            wanted += [(largest, [(p, Grasp.of(0.0, 0.0))]) for p in places]
            if self.grasps.are_tied(state):
                for index, grasps in picks:
                    elsewhere = self._elsewhere(draw, index, grasps[0])
                    places += elsewhere
                    put = self._put(index, grasps[0], elsewhere)
                    wanted += [(index, [target for _, targets in put for target in targets])]
        else:
            index, held = draw.held
            places = self.placements.of_held(draw)
            wanted += self._put(index, held, places)
            picks = []
            for face in sorted({p.face for p in places[:REGRASP_PLACES]}) if attempt > 0 else ():
                aside = [p for p in places[:REGRASP_PLACES] if p.face == face]
                picks += self.grasps.regrasps(draw, face)
                for grasp in picks[-1][1]:
                    goals = self.placements.with_grasp(draw, grasp)
                    places += goals
                    wanted += self._put(index, grasp, goals + aside)
            if attempt > DOUBT:
                picks += self.grasps.picks(draw)
        bases = self.bases.poses(draw, wanted)
        placed = state.held if attempt <= DOUBT else None
        added = tuple(self._added(draw))
        return Samples(self.executor, tuple(bases), tuple(picks), tuple(places), placed, added)

    def _elsewhere(self, draw: Draw, index: int, grasp: Grasp) -> list[Placement]:
        """Placements for an object that rests somewhere, were it in the hand."""
        placements = draw.state.placements
        away = (*placements[:index], None, *placements[index + 1 :])
        holding = replace(draw.state, placements=away, held=index, grasp=grasp)
        return self.placements.aside(replace(draw, state=holding))

    def _put(self, index: int, grasp: Grasp, places: Sequence[Placement]) -> list[Wanted]:
        """What is wanted of the base to put an object at some places with a grasp."""
        seen = [(p, turned(self.executor.world, index, grasp, p.face)) for p in places]
        return [(index, [(place, there)]) for place, there in seen if there is not None]
