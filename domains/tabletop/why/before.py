"""What makes a task hopeless, object by object, before any search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from domains.tabletop.faces import faces_at
from domains.tabletop.features import swept
from domains.tabletop.features.functions import arrangement, misplaced
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.items import why_not
from domains.tabletop.room import goes_over, has_room
from domains.tabletop.state import State
from domains.tabletop.why import barriers, depth
from domains.tabletop.why.blocking import Blame, as_data, in_words
from domains.tabletop.why.contradictions import contradictions
from domains.tabletop.why.finding import Finding, finding
from domains.tabletop.why.tested import can_pick, can_place
from runtime.reporting import Solves

if TYPE_CHECKING:
    from domains.tabletop.ground import Ground
    from domains.tabletop.problem import TabletopProblem

DEEP = "even with no other object about, no posture of the arm is free"

SECONDS = 1.0
"""What looking for smallest sets of things in the way may take."""


def before(problem: TabletopProblem, solves: Solves | None = None) -> list[Finding]:
    """What makes the task hopeless; empty where nothing does."""
    state = problem.world.initial
    here = arrangement(problem.world, state.placements)
    found = contradictions(problem.world)
    for index in sorted(misplaced(state)):
        goal = problem.world.goal_sites(index, here)
        if goal is not None:
            hopeless = _Hopeless(problem, state, index, goal).finding()
            if hopeless is not None:
                found.append(hopeless)
    return _blamed(problem, state, found, solves)


def _blamed(
    problem: TabletopProblem, state: State, found: Sequence[Finding], solves: Solves | None
) -> list[Finding]:
    """Findings about what is out of reach, with a smallest set of things that keep it there."""
    blame = Blame(problem, solves, SECONDS)
    names = [item.name for item in problem.world.items]
    told = []
    for one in found:
        smallest = None
        if one["cause"] in ("out of reach", "goal out of reach"):
            smallest = blame.of(state, names.index(one["object"]))
        words = in_words(one["object"], smallest)
        text = f"{one['text']}; {words}" if words else one["text"]
        told.append(one | {"text": text} | as_data(smallest))
    return told


class _Hopeless:
    """Why one misplaced object cannot get to its goal, whatever is done with all that moves."""

    def __init__(self, problem: TabletopProblem, state: State, index: int, goal: GoalSites) -> None:
        self.problem, self.world, self.index, self.goal = problem, problem.world, index, goal
        self.item = self.world.items[index]
        self.state = state
        placements = (p if i == index else None for i, p in enumerate(state.placements))
        self.alone = replace(state, placements=tuple(placements))

    def finding(self) -> Finding | None:
        """The reason, None where there is none."""
        world, name = self.world, self.item.name
        cannot = why_not(self.item, world.hand, world.families)
        if cannot is not None:
            return finding(name, "cannot be grasped", f"{name} {cannot}")
        if faces_at(world, self.index, self.goal) != (0,):
            return None  # on another side some way leads there
        ground = world.grounds[self.goal.support]
        if self.goal.region is not None and not has_room(ground, self.item):
            text = f"{name} does not fit on {ground.name}: it is larger than the room there"
            if ground.peg is not None and not goes_over(self.item, ground.peg):
                text = f"{name} does not go over {ground.name}: it is not hollow enough below"
            return finding(name, "does not fit", text)
        resting = self.state.placements[self.index]
        assert resting is not None
        start = world.grounds[resting.support]
        fixed = start.owner is None
        if fixed and depth.is_beyond_the_estimate(world, self.index, start):
            if not can_pick(self.problem, self.alone, self.index):
                where = f"{start.name}{depth.in_words(world, start)}"
                text = f"{name} is out of reach on {where}: {DEEP}"
                return finding(name, "out of reach", text)
        elif fixed and not self._can_be_taken():
            found = barriers.to_object(world, self.alone, self.index)
            text = f"{name} is out of reach: {barriers.in_words(found)}"
            return self._finding("out of reach", text, found)
        taken = self._taken()
        if taken is not None:
            return taken
        if fixed and self.goal.frame is None and self._is_too_deep(ground):
            where = f"{ground.name}{depth.in_words(world, ground)}"
            text = f"{name} cannot be put on {where}: {DEEP}"
            return finding(name, "goal out of reach", text)
        if fixed and self.goal.frame is None and not self._reaches_goal():
            found = barriers.to_goal(world, self.alone, self.index, self.goal)
            text = f"the goal of {name} on {ground.name} is out of reach: "
            return self._finding("goal out of reach", text + barriers.in_words(found), found)
        return None

    def _taken(self) -> Finding | None:
        """Whether something that no hand can take stands at all sites of the goal."""
        world, goal = self.world, self.goal
        if goal.frame is not None or goal.region is not None:
            return None
        for other, item in enumerate(world.items):
            at = world.rests(self.state.placements, other)
            if other == self.index or at is None or other in goal.bearers:
                continue
            box, own = world.box_row(other, at)[None], world.own(self.index)
            if not swept.occupied_sites(goal.xyz, own, box, -1).all():
                continue
            cannot = why_not(item, world.hand, world.families)
            if cannot is not None:
                text = f"the goal of {self.item.name} is taken by {item.name}, which {cannot}"
                return self._finding("goal out of reach", text, [])
        return None

    def _can_be_taken(self) -> bool:
        # What never moves is the same with all else away: no other arrangement has to be made.
        here = arrangement(self.world, self.state.placements)
        return here.is_reachable(self.index) or can_pick(self.problem, self.alone, self.index)

    def _is_too_deep(self, ground: Ground) -> bool:
        return depth.is_beyond_the_estimate(self.world, self.index, ground) and not can_place(
            self.problem, self.alone, self.index, self.goal
        )

    def _reaches_goal(self) -> bool:
        here = arrangement(self.world, self.state.placements)
        return any(
            here.places_of(self.index, self.goal, family).reachable.any()
            for family in self.world.families
        ) or can_place(self.problem, self.alone, self.index, self.goal)

    def _finding(self, cause: str, text: str, found: Sequence[barriers.Barrier]) -> Finding:
        ways = [barrier.as_json() for barrier in found]
        return finding(self.item.name, cause, text, ways=ways)
