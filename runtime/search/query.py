"""What one search for a subgoal is given, and what it takes."""

from __future__ import annotations

from dataclasses import dataclass, field

from runtime.search.guide import Guide, Values
from runtime.search.limits import DrawnBadlyError, Limits, OutOfPatienceError
from runtime.search.problem import Action, Motion, Rejection, State, Subproblem


@dataclass
class Effort:
    """Nodes expanded and generated."""

    expanded: int = 0
    generated: int = 0


@dataclass(frozen=True, eq=False)
class Query:
    """Find a subgoal of the state `start`, whose feature values are `before`, by IW(k).

    `effort` is counted up as the search goes on, so that it is known after a time-out, too.
    `spent` is what searches of the same subproblem have generated before. `stop` is the number of
    `rejections` at which this search ends; None: no other than that of the limits.
    """

    guide: Guide
    subproblem: Subproblem
    start: State
    before: Values
    k: int
    limits: Limits
    effort: Effort = field(default_factory=Effort)
    rejections: list[Rejection] = field(default_factory=list)
    spent: int = 0
    stop: int | None = None

    def generate(self) -> None:
        """Count a generated node.

        Raises:
            OutOfTimeError: the time is over.
            OutOfPatienceError: the subproblem has had its share of candidates.
        """
        self.limits.check()
        self.effort.generated += 1
        sampled = len(self.rejections) > 0 or getattr(self.subproblem, "sampled", False)
        most = self.limits.generated if self.guide.hopeful else self.limits.blind
        if sampled and self.spent + self.effort.generated > most:
            raise OutOfPatienceError

    def execute(self, state: State, action: Action) -> Motion | None:
        """X: the motion of an action, or None; what X refuses is noted.

        Raises:
            OutOfPatienceError: X has refused as many candidates of the subproblem as it may.
            DrawnBadlyError: it has refused as many of this attempt.
        """
        answer = self.subproblem.execute(state, action)
        if isinstance(answer, Rejection):
            self.rejections.append(answer)
            if len(self.rejections) >= self.limits.rejections:
                raise OutOfPatienceError
            if self.stop is not None and len(self.rejections) >= self.stop:
                raise DrawnBadlyError
            return None
        return answer
