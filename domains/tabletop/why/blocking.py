"""A smallest set of things without which an object gets to its goal: found, and tested by
planning without them."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from domains.tabletop.features.functions import arrangement
from domains.tabletop.state import State
from domains.tabletop.why import barriers
from domains.tabletop.why.relaxed import Thing, is_free, things_of, without
from domains.tabletop.world import TabletopWorld
from runtime.reasons.smallest import Smallest, smallest
from runtime.reporting import Solves
from sketchlang.analysis.words import listed

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem


class Blame:
    """Looks for smallest sets, one object after the other, for so many seconds in all."""

    def __init__(self, problem: TabletopProblem, solves: Solves | None, seconds: float) -> None:
        self.problem, self.solves = problem, solves
        self.deadline = time.process_time() + seconds

    def of(self, state: State, index: int) -> Smallest[Thing] | None:
        """A smallest set of things that keeps an object from its goal, where other things do."""
        left, solves = self.deadline - time.process_time(), self.solves
        if solves is None or left <= 0 or self.problem.world.scene.word is not None:
            return None

        def possible(gone: frozenset[Thing]) -> bool:
            relaxed = without(self.problem, state, index, gone)
            return is_free(relaxed, relaxed.initial, index) and solves(relaxed)

        # What is nearest comes last: of equally small sets, that one is found which is told.
        near = _nearest(self.problem.world, state, index)
        things = things_of(self.problem.world, state, index)
        return smallest(sorted(things, key=lambda t: t.name in near), possible, left)


def _nearest(world: TabletopWorld, state: State, index: int) -> set[str]:
    """What bars the nearest ways to an object and to its goal."""
    ways = [] if state.held == index else barriers.to_object(world, state, index)
    goal = world.goal_sites(index, arrangement(world, state.placements))
    if goal is not None:
        ways += barriers.to_goal(world, state, index, goal)
    return {name for way in ways for name in way.nearest}


def in_words(name: str, found: Smallest[Thing] | None) -> str:
    """What would help, as a clause; empty where that was not found."""
    if found is None:
        return ""
    names = listed([thing.name for thing in found.things])
    sure = "" if found.proved else " (perhaps fewer do)"
    return f"without {names} there is a plan for {name}{sure}"


def as_data(found: Smallest[Thing] | None) -> dict[str, Any]:
    """The same as plain data."""
    if found is None:
        return {}
    return {"blocking": [thing.name for thing in found.things], "smallest": found.proved}
