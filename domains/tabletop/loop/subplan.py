"""Plan one subgoal from a state, and make a trace of it."""

from __future__ import annotations

import numpy as np

from domains.tabletop.actions.document import document
from domains.tabletop.problem import TabletopProblem
from domains.tabletop.state import State
from runtime.plan.model import Plan
from runtime.search.guide import Guide, Subgoal
from runtime.search.limits import Limits, OutOfTimeError
from runtime.search.query import Effort
from runtime.search.siw_r import Outcome, find_subgoal, lazy


def next_subgoal(
    guide: Guide,
    problem: TabletopProblem,
    state: State,
    limits: Limits,
    rng: np.random.Generator,
) -> Subgoal | None:
    """One round of Lazy-SIIW_R: a subplan from a state to a subgoal; None where there is none,
    or none was found within the limits."""
    guide.forget()
    try:
        return find_subgoal(lazy, guide, problem, state, limits, rng, Effort(), [])
    except OutOfTimeError:
        return None


def plan_of(problem: TabletopProblem, guide: Guide, state: State, subgoal: Subgoal) -> Plan:
    """A subplan as a plan that starts in a state."""
    outcome = Outcome(solved=True, subgoals=[subgoal], state=subgoal.states[-1])
    plan = document(problem.world, guide.model, outcome, "lazy-siiw-r", problem.executor.seed)
    return Plan(**{**vars(plan), "base_start": state.base.pose})
