"""What keeps each misplaced object from its goal where a search ended."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

from domains.tabletop.faces import faces_at
from domains.tabletop.features.functions import (
    arrangement,
    disturbances,
    misplaced,
    obstructions,
)
from domains.tabletop.features.goals import GoalSites
from domains.tabletop.features.swept import UNREACHABLE
from domains.tabletop.items import why_not
from domains.tabletop.state import State
from domains.tabletop.why import barriers, depth
from domains.tabletop.why.blocking import Blame, as_data, in_words
from domains.tabletop.why.crowded import crowded
from domains.tabletop.why.finding import Finding, finding
from domains.tabletop.why.relaxed import (
    families_to_goal,
    families_to_object,
    is_free,
    way_to_goal,
    way_to_object,
)
from domains.tabletop.why.tested import can_pick, can_place
from runtime.reporting import Solves
from runtime.search.siw_r import End, Outcome
from sketchlang.analysis.words import counted, listed

if TYPE_CHECKING:
    from domains.tabletop.problem import TabletopProblem

SECONDS = 0.8
"""What looking for smallest sets of things in the way may take."""

TESTED = 3
"""Objects that X is asked about; the features' estimate says something about all of them."""

DOUBTED = 20
"""Refusals from which on what the features estimate of an object is not believed."""

STEPS = {
    "in_arm_workspace": "beyond the arm's reach",
    "inverse_kinematics": "no posture of the arm is free",
    "motion_plan": "no motion gets there freely",
}
"""What it means that a step of X refused a manipulation."""


def after(problem: TabletopProblem, outcome: Outcome, solves: Solves) -> list[Finding]:
    """Findings object by object: what X says, else what the features estimate. X is asked, and
    smallest sets are looked for, only where the search came to an end by itself."""
    state = outcome.state
    here = arrangement(problem.world, state.placements)
    refused: dict[str, Counter[str]] = {}
    for rejection in outcome.rejections:
        if rejection.about is not None:
            refused.setdefault(rejection.about, Counter())[rejection.step] += 1
    held = [] if state.held is None else [state.held]
    ended = outcome.end in (End.NO_RULE, End.NO_SUBGOAL)
    blame = Blame(problem, solves if ended else None, SECONDS)
    found: list[Finding] = crowded(problem.world, state) if ended else []
    for index in [*held, *sorted(misplaced(state) - set(held))]:
        goal = problem.world.goal_sites(index, here)
        if goal is not None:
            object_ = _Stuck(problem, state, index, goal)
            no = refused.get(object_.name, Counter())
            one = object_.tested(no) if ended and len(found) < TESTED else None
            one = one or object_.estimated(no)
            if one is not None:
                found.append(_blamed(blame, state, index, one))
    return found


BLAMED = ("out of reach", "goal out of reach", "blocked", "refused", "obstructed")
"""Causes for which other things may be to blame."""


def _blamed(blame: Blame, state: State, index: int, one: Finding) -> Finding:
    if one["cause"] not in BLAMED:
        return one
    smallest = blame.of(state, index)
    words = in_words(one["object"], smallest)
    text = f"{one['text']}; {words}" if words else one["text"]
    return one | {"text": text} | as_data(smallest)


class _Stuck:
    """Why one object is not where it should be."""

    def __init__(self, problem: TabletopProblem, state: State, index: int, goal: GoalSites) -> None:
        self.problem, self.world, self.state = problem, problem.world, state
        self.index, self.goal = index, goal
        self.name = self.world.items[index].name
        self.ground = self.world.grounds[goal.support]
        self.is_held = state.held == index

    def tested(self, refused: Counter[str]) -> Finding | None:
        """What X confirms: no plan could change it. What X `refused` in the search, of this
        object, it is asked about whatever the features estimate."""
        world, state, index, name = self.world, self.state, self.index, self.name
        cannot = why_not(world.items[index], world.hand, world.families)
        if cannot is not None:
            return finding(name, "cannot be grasped", f"{name} {cannot}")
        placements = tuple(p if i == index else None for i, p in enumerate(state.placements))
        alone = replace(state, placements=placements)
        if not self._stands_fixed() or faces_at(world, index, self.goal) != (0,):
            return None
        doubted = sum(refused.values()) >= DOUBTED
        if not (self.is_held or self._can_be_taken(alone, doubted)):
            if doubted:
                return self._refused("out of reach", "cannot be picked up", refused)
            return self._said("out of reach", "is out of reach", alone, to_goal=False)
        if not self._can_be_put_down(alone, doubted):
            what = f"cannot be put on {self.ground.name}{self._depth()}"
            if doubted:
                return self._refused("goal out of reach", what, refused)
            return self._said("goal out of reach", what, alone, to_goal=True)
        if self.is_held or is_free(self.problem, state, index):
            return None
        to_goal = way_to_object(world, state, index)
        what = "cannot get to its goal for what nobody can move"
        if not to_goal:
            what = "is blocked by what nobody can move"
        return self._said("blocked", what, state, to_goal)

    def _can_be_taken(self, state: State, doubted: bool) -> bool:
        found = not doubted and way_to_object(self.world, state, self.index)
        return found or can_pick(self.problem, state, self.index)

    def _can_be_put_down(self, state: State, doubted: bool) -> bool:
        found = not doubted and way_to_goal(self.world, state, self.index, self.goal)
        return found or can_place(self.problem, state, self.index, self.goal)

    def _stands_fixed(self) -> bool:
        """Whether neither the object nor its goal are on something that moves."""
        placement = self.state.placements[self.index]
        grounds = self.world.grounds
        below = None if placement is None else grounds[placement.support].owner
        return below is None and self.goal.frame is None

    def _said(self, cause: str, what: str, state: State, to_goal: bool) -> Finding:
        if to_goal:
            ways = barriers.to_goal(self.world, state, self.index, self.goal)
        else:
            ways = barriers.to_object(self.world, state, self.index)
        text = f"{self.name} {what}: {barriers.in_words(ways)}"
        return finding(self.name, cause, text, ways=[way.as_json() for way in ways])

    def _refused(self, cause: str, what: str, refused: Counter[str]) -> Finding:
        said = listed([STEPS.get(step, step) for step, _ in refused.most_common()])
        text = f"{self.name} {what}: even with no other object about, {said}"
        return finding(self.name, cause, text, steps=dict(refused))

    def estimated(self, refused: Counter[str]) -> Finding | None:
        """What the features estimate, and what X refused."""
        world, state, index, name = self.world, self.state, self.index, self.name
        here = arrangement(world, state.placements)
        least = obstructions(state, index)
        # Beyond what can be counted: there is no way at all, with what stands about.
        if least >= UNREACHABLE or (least and here.in_the_way(index, self.goal)):
            return self._obstructed()
        if refused:
            said = ", ".join(
                f"{STEPS.get(s, s)} ({counted(n, 'time')})" for s, n in refused.most_common()
            )
            text = f"{name}: X refused every way that was tried: {said}"
            if self.is_held:
                where = f"{self.ground.name}{self._depth()}"
                text = f"{name} cannot be put on {where}: {said}"
            return finding(name, "refused", text, certain=False, steps=dict(refused))
        if disturbances(state, index):
            text = f"{name} would be in the way of others at its goal"
            return finding(name, "disturbs", text, certain=False)
        return None

    def _obstructed(self) -> Finding:
        world, state, index = self.world, self.state, self.index
        taken = [] if self.is_held else families_to_object(world, state, index)
        split = self._no_grasp_for_both(taken)
        if split:
            return finding(self.name, "obstructed", split, certain=False)
        if not self.is_held and not taken:
            ways = barriers.to_object(world, state, index)
            text = f"something stands in front of {self.name}: {barriers.in_words(ways)}"
        else:
            ways = barriers.to_goal(world, state, index, self.goal)
            text = f"the goal of {self.name} on {self.ground.name} is barred: "
            text += barriers.in_words(ways)
        data = [way.as_json() for way in ways]
        return finding(self.name, "obstructed", text, certain=False, ways=data)

    def _no_grasp_for_both(self, taken: list[int]) -> str:
        """What is said where there are ways to the object, of the families by which it is `taken`,
        and ways to its goal, but no grasp that does for both; else nothing."""
        world, state, index = self.world, self.state, self.index
        if not taken or faces_at(world, index, self.goal) != (0,):
            return ""
        put = families_to_goal(world, state, index, self.goal)
        if not put:
            return ""
        where = self.ground.name
        if set(taken) & set(put):
            return f"{self.name} can be taken, and put on {where}, but no grasp does for both"
        first, second = (listed([barriers.FROM[f] for f in each]) for each in (taken, put))
        return (
            f"{self.name} can be taken {first} only, and put on {where} {second} only: "
            "no grasp does for both"
        )

    def _depth(self) -> str:
        return depth.in_words(self.world, self.ground)
