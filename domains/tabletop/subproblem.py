"""One subproblem of pick and place as the search sees it: samples, and whether they can be done."""

from __future__ import annotations

from dataclasses import dataclass

from domains.tabletop.actions.actions import Action
from domains.tabletop.actions.executability import Executor
from domains.tabletop.sampling.samples import Samples
from domains.tabletop.state import State
from runtime.motion.motion import Motion
from runtime.search.problem import Rejection


@dataclass(frozen=True, eq=False)
class TabletopSubproblem:
    """The samples of a subproblem, and X on them."""

    samples: Samples
    executor: Executor
    seeds: int
    sampled = True

    def actions(self, state: State) -> list[tuple[Action, State]]:
        """Sampled ground actions and the states they lead to."""
        return list(self.samples.actions(state))

    def execute(self, state: State, action: Action) -> Motion | Rejection:
        """X: the motion of an action, or the step that refused it."""
        return action.motion(self.executor, state, self.seeds)
