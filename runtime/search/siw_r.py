"""SIW_R: one IW search a subgoal, guided by a sketch (Bonet & Geffner 2021; paper, SIW_R).

From a state s, IW looks for a closest state s' such that the pair (s, s') satisfies a rule,
or for a goal state; then s := s', until the goal. A subproblem that fails is sampled anew,
more densely. What becomes of a run that gets stuck is in `retreat.py`.

Lazy-SIIW_R is the same loop around an IW that validates actions lazily.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Protocol, runtime_checkable

import numpy as np

from runtime.search.guide import Guide, Subgoal, Values
from runtime.search.iw import Node, iw
from runtime.search.lazy_iw import LazyIW
from runtime.search.limits import DrawnBadlyError, Limits, OutOfPatienceError, OutOfTimeError
from runtime.search.problem import Action, Motion, Rejection, SearchProblem, State, Subproblem
from runtime.search.query import Effort, Query
from sketchlang.compile import CompiledSketch
from sketchlang.model import Kind


class End(Enum):
    """How a search ended that did not solve its problem."""

    NO_RULE = "no rule applies"
    NO_SUBGOAL = "no subgoal was found"
    CIRCLE = "a state came again"
    TIME = "the time was over"
    HOPELESS = "it did not begin: the domain knew that there is no plan"


@dataclass
class Outcome:
    """What a search reached, and the seconds it took. Where it did not solve the problem, `end`
    tells how it ended, `reason` says so in a sentence, `stuck` are the feature values there, and
    `rejections` what X refused in the last subproblem; `returned_to` is set where the state was
    that after so many subgoals again: the sketch runs in a circle. `last` is the guide with what
    it knows of the last subproblem, and the samples of each attempt at it; `why` are findings
    about what is in the way of what. `retreats` are those of the run on its way there."""

    solved: bool = False
    subgoals: list[Subgoal] = field(default_factory=list)
    effort: Effort = field(default_factory=Effort)
    state: State = None
    reason: str | None = None
    stuck: Values | None = None
    rejections: list[Rejection] = field(default_factory=list)
    seconds: float = 0.0
    returned_to: int | None = None
    end: End | None = None
    last: tuple[Guide, tuple[Subproblem, ...]] | None = field(default=None, repr=False)
    why: list[dict[str, Any]] = field(default_factory=list)
    retreats: list[Retreat] = field(default_factory=list)


@dataclass(frozen=True)
class Retreat:
    """A run got `stuck` after so many subgoals, and went `back` to where it had so many."""

    stuck: int
    back: int


Progress = Callable[["Subgoal | Retreat", float], None]
"""Is told of each subgoal that was found, and of each retreat, with the seconds from the start."""


Step = tuple[Action, Motion, State]
"""An action, its motion and the state after it."""

Turns = Callable[[Limits, bool], Iterator[tuple[int, int]]]
"""(attempt, k) in the order in which a subproblem is tried."""

Search = Callable[[Query], "tuple[list[Step], str] | None"]
"""Looks for a subgoal of a state: the steps to it and the rule that it satisfies."""


@runtime_checkable
class Searching(Protocol):
    """A subproblem that does IW(k) itself, since it knows a quicker way. All its actions are
    executable, so there is nothing to be lazy about."""

    def search(self, query: Query) -> tuple[list[Step], str] | None:
        """The steps to a subgoal and the rule that it satisfies."""
        ...


def eager(query: Query) -> tuple[list[Step], str] | None:
    """The search of SIW_R: every edge is validated before the search goes on."""
    if isinstance(query.subproblem, Searching):
        return query.subproblem.search(query)
    return steps_to(iw(query))


def steps_to(found: tuple[Node, str] | None) -> tuple[list[Step], str] | None:
    """The steps from the root to a node that was found with a rule."""
    if found is None:
        return None
    node, rule = found
    return [(n.action, n.motion, n.state) for n in node.path()], rule


def lazy(query: Query) -> tuple[list[Step], str] | None:
    """The search of Lazy-SIIW_R: only the actions of potential subplans are validated."""
    if isinstance(query.subproblem, Searching):
        return query.subproblem.search(query)
    found = LazyIW(query).run()
    if found is None:
        return None
    path, rule = found
    return [(edge.action, edge.motion, edge.child.state) for edge in path], rule


def schedule(limits: Limits, guided: bool) -> Iterator[tuple[int, int]]:
    """(attempt, k) in the order in which a subproblem is tried: IW(1) on samples of growing
    density first, then the wider searches, which grow faster, on samples of middling density.

    Where the sketch has rules and none applies, it has nothing to say: one look for a goal
    state that is near, and no more.
    """
    if not guided:
        yield 0, 1
        return
    for attempt in range(limits.attempts):
        yield attempt, 1
    for k in range(2, limits.k_max + 1):
        yield limits.attempts // 2, k


def subgoals(
    search: Search,
    sketch: CompiledSketch,
    problem: SearchProblem,
    limits: Limits,
    rng: np.random.Generator,
    outcome: Outcome,
    turns: Turns = schedule,
    hasty: int = 0,
) -> Iterator[Subgoal]:
    """The subgoals on the way to the goal, each searched for when it is asked for. `outcome`, one
    that has not ended, tells what has been reached, and at the end why it ended there. There is
    less patience with the subproblems after fewer than `hasty` subgoals."""
    guide = Guide(sketch)
    been: dict[State, int] = {problem.initial: 0}
    for number, subgoal in enumerate(outcome.subgoals, start=1):
        been.setdefault(subgoal.states[-1], number)
    tried: list[Subproblem] = []
    try:
        while True:
            values = guide.values(outcome.state)
            if guide.is_goal(values, outcome.state):
                outcome.solved = True
                break
            outcome.rejections, tried = [], []
            patience = limits.hasty() if len(outcome.subgoals) < hasty else limits
            found = find_subgoal(
                search, guide, problem, outcome.state, patience, rng, outcome.effort,
                outcome.rejections, tried, turns,
            )  # fmt: skip
            if found is None:
                outcome.stuck = values
                outcome.end, outcome.reason = _why(guide, values)
                break
            outcome.subgoals.append(found)
            outcome.state = found.states[-1]
            guide.forget()
            yield found
            before = been.setdefault(outcome.state, len(outcome.subgoals))
            if before < len(outcome.subgoals):
                outcome.stuck, outcome.returned_to = guide.values(outcome.state), before
                outcome.end, outcome.reason = End.CIRCLE, _loop(outcome, before)
                break
    except OutOfTimeError:
        outcome.stuck = guide.values(outcome.state)
        outcome.end = End.TIME
        outcome.reason = f"the time limit of {limits.timeout:g} s is over"
    outcome.last = guide, tuple(tried)


def find_subgoal(
    search: Search,
    guide: Guide,
    problem: SearchProblem,
    state: State,
    limits: Limits,
    rng: np.random.Generator,
    effort: Effort,
    rejections: list[Rejection],
    tried: list[Subproblem] | None = None,
    turns: Turns = schedule,
) -> Subgoal | None:
    """One round: a subplan from a state to a subgoal, or None. Nodes are added to `effort`,
    what X refuses to `rejections`, and the samples of each attempt to `tried`; `turns` says in
    which order densities and widths are tried.

    Raises:
        OutOfTimeError: when the limits say so.
    """
    values = guide.values(state)
    guided = not guide.model.rules or bool(guide.usable(values))
    spent = 0
    for attempt, k in turns(limits, guided):
        limits.check()
        subproblem = problem.subproblem(state, attempt, rng)
        if tried is not None:
            tried.append(subproblem)
        query = Query(
            guide, subproblem, state, values, k, limits,
            rejections=rejections, spent=spent, stop=len(rejections) + limits.refusals,
        )  # fmt: skip
        try:
            found = search(query)
        except DrawnBadlyError:
            found = None
        except OutOfPatienceError:
            return None
        finally:
            spent += query.effort.generated
            effort.expanded += query.effort.expanded
            effort.generated += query.effort.generated
        if found is not None:
            steps, rule = found
            return Subgoal(
                rule=rule,
                before=values,
                after=guide.values(steps[-1][2]),
                actions=tuple(action for action, _, _ in steps),
                motions=tuple(motion for _, motion, _ in steps),
                states=tuple(state for _, _, state in steps),
                attempt=attempt,
                width=k,
                expanded=query.effort.expanded,
                generated=query.effort.generated,
                rejected=dict(Counter(rejection.step for rejection in rejections)),
                values=tuple(guide.values(state) for _, _, state in steps),
            )
    return None


def _why(guide: Guide, values: Values) -> tuple[End, str]:
    rules = guide.model.rules
    usable = [rules[number].name for number in guide.usable(values)]
    if rules and not usable:
        return End.NO_RULE, f"no rule of the sketch applies at {{{_valuation(guide, values)}}}"
    if not rules:
        return End.NO_SUBGOAL, "no goal state was found"
    return End.NO_SUBGOAL, f"no subgoal of {' or '.join(usable)} was found"


def _valuation(guide: Guide, values: Values) -> str:
    return ", ".join(
        (feature.name if value else f"!{feature.name}")
        if feature.kind is Kind.BOOL
        else f"{feature.name} {'> 0' if value else '= 0'}"
        for feature, value in zip(guide.model.features, values, strict=True)
    )


def _loop(outcome: Outcome, before: int) -> str:
    rules = list(dict.fromkeys(subgoal.rule for subgoal in outcome.subgoals[before:]))
    where = f"after subgoal {before}" if before else "at the start"
    return f"the state {where} came again: {' and '.join(rules)} run in a circle"
