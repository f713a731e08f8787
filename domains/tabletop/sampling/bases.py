"""Base poses from which grasps can be taken."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Sequence

import numpy as np

from domains.tabletop.sampling.draw import BASES, Draw
from domains.tabletop.sampling.stands import first_with_room, stand
from domains.tabletop.state import DOWN, BasePose, Grasp, Placement, State
from domains.tabletop.world import TabletopWorld
from runtime.motion.roads import Roads
from runtime.motion.room import Room, room_around

ROOMS = 200
"""Rooms that are remembered."""

ROUNDS = 3
"""So many base poses for the same grasp, where there are few grasps."""

TRIES, NARROW_TRIES = 48, 16
"""Base poses that are drawn for a grasp, where the robot can turn and where it cannot."""

STRAYS = {tries: np.linspace(0.2, 1.2, tries) for tries in (TRIES, NARROW_TRIES)}
"""Standard deviation, in radians, of the bearing of each of them."""

Wanted = tuple[int, Sequence[tuple[Placement | None, Grasp]]]
"""An object, and grasps of it with where it rests or is to rest."""


class BaseSampler:
    """Samples base poses for one task. `roads_for` tells the roads in a state; without it those
    of the static scene are meant."""

    def __init__(
        self, world: TabletopWorld, roads_for: Callable[[State], Roads] | None = None
    ) -> None:
        self.world = world
        self.roads_for = roads_for
        self._rooms: OrderedDict[int, tuple[Roads, Room]] = OrderedDict()

    def room(self, state: State) -> Room:
        """Where the robot can get to and turn; what stands on the floor is in its way, too."""
        world = self.world
        roads = world.roads if self.roads_for is None else self.roads_for(state)
        if len(roads.boxes) == len(world.roads.boxes):
            return world.room
        known = self._rooms.get(id(roads))
        if known is None or known[0] is not roads:
            at = roads.lane(state.base.pose) or state.base.pose[:2]
            known = self._rooms[id(roads)] = (
                roads,
                room_around(roads.boxes, roads.clearance, *at),
            )
            if len(self._rooms) > ROOMS:
                self._rooms.popitem(last=False)
        return known[1]

    def poses(self, draw: Draw, wanted: Sequence[Wanted]) -> list[BasePose]:
        """Base poses from which the wanted grasps can be taken: one grasp of every object
        first, then the next of every object, and again, up to a number for each surface."""
        if self.world.is_fixed:
            return []
        bases, without = self._sampled(draw, wanted, narrow=False)
        if draw.attempt:
            without = {index for index, _ in wanted}
        barred = [targets for targets in wanted if targets[0] in without]
        return bases + self._sampled(draw, barred, narrow=True)[0]

    def _sampled(
        self, draw: Draw, wanted: Sequence[Wanted], narrow: bool
    ) -> tuple[list[BasePose], set[int]]:
        """Base poses, at which the robot can turn or which are `narrow`, and the objects for
        which they were drawn in vain."""
        limit = BASES * draw.scale
        count: dict[int, int] = {}
        bases: list[BasePose] = []
        served: set[int] = set()
        refused: set[int] = set()
        for turn in range(ROUNDS * max((len(targets) for _, targets in wanted), default=0)):
            for index, targets in wanted:
                if turn >= ROUNDS * len(targets):
                    continue
                placement, grasp = targets[turn % len(targets)]
                if placement is None or count.get(placement.support, 0) >= limit:
                    continue
                base = self.pose_for(draw.state, index, placement, grasp, draw.rng, narrow)
                if base is None:
                    refused.add(index)
                    continue
                bases.append(base)
                served.add(index)
                count[placement.support] = count.get(placement.support, 0) + 1
        return bases, refused - served

    def stand(
        self,
        state: State,
        index: int,
        placement: Placement,
        grasp: Grasp,
        rng: np.random.Generator,
        narrow: bool,
    ) -> BasePose | None:
        """A base pose for a grasp: where the robot stands, if it cannot drive."""
        if self.world.is_fixed:
            return None if narrow else state.base
        return self.pose_for(state, index, placement, grasp, rng, narrow)

    def pose_for(
        self,
        state: State,
        index: int,
        placement: Placement,
        grasp: Grasp,
        rng: np.random.Generator,
        narrow: bool = False,
    ) -> BasePose | None:
        """A random base pose from which the wrist of a grasp is in the arm's workspace, at
        which the robot can turn; with `narrow` one at which it cannot, but which it can leave
        straight backwards."""
        world = self.world
        at = world.rests_at(state.placements, index, placement)
        if at is None:
            return None
        x, y, height = grasp.centre(at)
        found = world.hand.workspace(grasp.family, height)
        if found is None:
            return None
        behind, inner, outer = found
        heading = at[3] + grasp.heading
        wrist = x - behind * math.cos(heading), y - behind * math.sin(heading)
        tries = NARROW_TRIES if narrow else TRIES
        if grasp.family in DOWN:
            # The wrist is above: the arm may come from anywhere.
            bearings = rng.uniform(-math.pi, math.pi, tries)
        else:
            # Straight behind the gripper is easiest for the arm; stray further try by try.
            bearings = heading + rng.normal(size=tries) * STRAYS[tries]
        reaches = rng.uniform(inner, outer, tries)
        turns = rng.uniform(-0.4, 0.4, tries)
        at_wrist = wrist, (x, y), world.robot.centre
        if not narrow:
            number, *pose = first_with_room(
                *at_wrist, bearings, reaches, turns, *self.room(state).floor
            )
            return None if number < 0 else BasePose.of(*pose)
        for drawn in zip(bearings, reaches, turns, strict=True):
            pose = stand(*at_wrist, *drawn)
            if world.is_narrow(*pose):
                return BasePose.of(*pose)
        return None
