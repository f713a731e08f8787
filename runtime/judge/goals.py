"""Whether a world is as it is wanted, judged on exact final poses."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np

from runtime.judge.footing import REST, Poses, footings, support_pose
from runtime.world.goals import AnyOf, Goal, IsHeld, RestsAt, RestsOn, Spelled
from runtime.world.poses import Floats
from runtime.world.snap import middle_of, resting_heading
from runtime.world.world import Support, World

NUMERIC = 1e-4
"""Metres by which a plan's own rounding may miss a tolerance."""


def unmet(world: World, poses: Poses, held: Collection[str] = (), rest: float = REST) -> list[str]:
    """What the goals of a world still lack, with bodies at poses (4, 4) and some held; `rest`
    is by how much a body may miss the height at which it rests (m)."""
    decision = _Decision(world, poses, held, rest)
    return [lack for goal in world.goals if (lack := decision.lack(goal)) is not None]


class _Decision:
    def __init__(self, world: World, poses: Poses, held: Collection[str], rest: float) -> None:
        self.world, self.poses, self.held, self.rest = world, poses, held, rest
        self.supports = {support.name: support for support in world.supports}

    def lack(self, goal: Goal) -> str | None:
        """What is missing of a goal, None for nothing."""
        match goal:
            case RestsOn(body, support):
                return None if self._is_on(body, support) else f"{body} is not on {support}"
            case RestsAt():
                return self._lack_at(goal)
            case IsHeld(body):
                return None if body in self.held else f"{body} is not held"
            case Spelled(word, support):
                spelt = self._spells(goal)
                return None if spelt else f"the word {word} is not on {support}"
            case AnyOf(goals):
                lacks = [self.lack(each) for each in goals]
                return None if None in lacks else " and ".join(filter(None, lacks))

    def _is_on(self, body: str, support: str) -> bool:
        """Whether a body rests on a support, with its centre of mass over the region."""
        index = self.world.index(body)
        region = self.supports[support]
        local = self._local(index, region)
        if local is None:
            return False
        centre = (local @ [*self.world.movables[index].body.centre, 1.0])[:2]
        if np.any(np.abs(centre) > np.array(region.half) + NUMERIC):
            return False
        return bool(footings(self.world, self.poses, index, self.rest, [region]))

    def _local(self, index: int, support: Support) -> Floats | None:
        """The pose (4, 4) of a body in the frame of a support."""
        place = support_pose(self.world, support, self.poses)
        if index not in self.poses or place is None:
            return None
        local: Floats = np.linalg.inv(place) @ self.poses[index]
        return local

    def _lack_at(self, goal: RestsAt) -> str | None:
        # The point says where it has to be; its centre of mass may be over another support that
        # bears it as well, and whether all of that is stable is asked elsewhere.
        index = self.world.index(goal.body)
        region = self.supports[goal.support]
        if index not in self.poses or not footings(
            self.world, self.poses, index, self.rest, [region]
        ):
            return f"{goal.body} is not on {goal.support}"
        local = self._local(index, self.supports[goal.support])
        body = self.world.movables[index].body
        assert local is not None
        x, y, _ = middle_of(body, local[:3])
        error = math.hypot(x - goal.x, y - goal.y)
        if error > goal.tolerance + NUMERIC:
            return f"{goal.body} is {1000 * error:.1f} mm from its goal pose"
        if goal.yaw is not None:
            turn = 2 * math.pi / max(1, goal.symmetry)
            off = math.remainder(resting_heading(body, local[:3]) - goal.yaw, turn)
            if abs(off) > goal.yaw_tolerance + NUMERIC:
                return f"{goal.body} is turned {abs(off):.3f} rad from its goal pose"
        return None

    def _spells(self, goal: Spelled) -> bool:
        """Whether bodies spell a word in a row, in one of the support's four directions."""
        support = self.supports[goal.support]
        blocks = []
        for index, thing in enumerate(self.world.movables):
            if thing.label is not None and index in self.poses:
                local = self._local(index, support)
                if local is not None and self._is_on(thing.name, goal.support):
                    blocks.append((thing.label, float(local[0, 3]), float(local[1, 3])))
        slack = 2 * goal.tolerance + NUMERIC
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            for letter, x, y in blocks:
                if letter == goal.word[0] and all(
                    any(
                        label == wanted
                        and math.hypot(bx - x - i * goal.pitch * dx, by - y - i * goal.pitch * dy)
                        <= slack
                        for label, bx, by in blocks
                    )
                    for i, wanted in enumerate(goal.word)
                ):
                    return True
        return False
