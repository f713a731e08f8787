"""Plan one subgoal from a state, and make a trace of it."""

from __future__ import annotations

import numpy as np

from runtime.pick_place.document import document
from runtime.pick_place.problem import PickPlaceProblem
from runtime.pick_place.state import State
from runtime.plan import Plan
from runtime.search.guide import Guide, Subgoal
from runtime.search.limits import Limits
from runtime.search.query import Query
from runtime.search.siw_r import Outcome, lazy, schedule


def next_subgoal(
    guide: Guide,
    problem: PickPlaceProblem,
    state: State,
    limits: Limits,
    rng: np.random.Generator,
) -> Subgoal | None:
    """One round of Lazy-SIIW_R: a subplan from a state to a subgoal, or None."""
    guide.forget()
    values = guide.values(state)
    profile = problem.profile_dict()
    for attempt, k in schedule(limits):
        subproblem = problem.subproblem(state, attempt, rng)
        query = Query(guide, subproblem, state, values, k, limits)
        found = lazy(query)
        if found is None:
            continue
        steps, rule = found
        counts = problem.profile_dict()
        refused = {
            name: int(step["calls"] - step["successes"])
            - int(profile[name]["calls"] - profile[name]["successes"])
            for name, step in counts.items()
        }
        return Subgoal(
            rule=rule,
            before=values,
            after=guide.values(steps[-1][2]),
            actions=tuple(action for action, _, _ in steps),
            motions=tuple(motion for _, motion, _ in steps),
            states=tuple(after for _, _, after in steps),
            attempt=attempt,
            width=k,
            expanded=query.effort.expanded,
            generated=query.effort.generated,
            rejected=refused,
        )
    return None


def plan_of(problem: PickPlaceProblem, guide: Guide, state: State, subgoal: Subgoal) -> Plan:
    """A subplan as a plan that starts in a state."""
    outcome = Outcome(solved=True, subgoals=[subgoal], state=subgoal.states[-1])
    plan = document(problem.task, guide.model, outcome, "lazy-siiw-r", problem.executor.seed)
    return Plan(**{**vars(plan), "base_start": state.base.pose})
