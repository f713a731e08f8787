"""BFWS: best-first width search (Lipovetzky & Geffner 2017), as for combined task and motion
planning (Ferrer-Mestres, Frances & Geffner 2017).

States are ordered by <w, #g, #r>: #g counts the goals that are open and #r what is in the way of
them, and w is the size of the smallest tuple of atoms that is true for the first time among the
states with the same #g and #r. Nothing is pruned: the search is complete for its samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import count

from runtime.search.guide import GOAL, Guide
from runtime.search.iw import Node
from runtime.search.novelty import PartitionedNovelty
from runtime.search.problem import Action, State
from runtime.search.query import Query

Counters = tuple[int, ...]

MOST_WAITING = 400_000
"""States that wait to be looked at; where there are more, the better half is kept. They are what
takes the memory: about 1 KB each."""


@dataclass(frozen=True, eq=False)
class Waiting:
    """A state to which an action may lead from a node; X has not been asked yet."""

    parent: Node
    action: Action
    state: State
    counters: Counters
    is_goal: bool


class BestFirstWidth:
    """One best-first width search. `counters` are #g, and #r where that is known, of a state.

    X is asked when a state is the best one, so that novelty is about states that can be reached;
    what has lost its novelty while it waited goes back into the queue.
    """

    def __init__(self, query: Query, counters: Callable[[State], Counters]) -> None:
        self.query = query
        self.counters = counters
        self.novelty = PartitionedNovelty(query.k)
        self.reached: set[State] = {query.start}
        self._queue: list[tuple[tuple[int, ...], int, Waiting]] = []
        self._order = count()

    def run(self) -> tuple[Node, str] | None:
        """A node whose state is a goal state, with `GOAL` for a rule, or None.

        Raises:
            OutOfTimeError: when the limits say so.
        """
        node = Node(self.query.start)
        self.novelty.add(self.counters(node.state), self.query.guide.atoms(node.state))
        while True:
            self._expand(node)
            reached = self._next()
            if reached is None:
                return None
            node, is_goal = reached
            if is_goal:
                return node, GOAL

    def _expand(self, node: Node) -> None:
        query, guide = self.query, self.query.guide
        query.effort.expanded += 1
        for action, state in query.subproblem.actions(node.state):
            query.generate()
            if state in self.reached:
                continue
            is_goal = guide.reaches_goal(state)
            self._push(Waiting(node, action, state, self.counters(state), is_goal))
        if len(self._queue) > MOST_WAITING:
            self._queue.sort(key=lambda entry: entry[:2])
            del self._queue[MOST_WAITING // 2 :]
            heapify(self._queue)

    def _push(self, item: Waiting) -> None:
        heappush(self._queue, (self._place(item), next(self._order), item))

    def _place(self, item: Waiting) -> tuple[int, ...]:
        """<w, #g, #r>, or before all others for what would be a goal state."""
        if item.is_goal:
            return (0,)
        w = self.novelty.width(item.counters, self.query.guide.atoms(item.state))
        return (w, *item.counters)

    def _next(self) -> tuple[Node, bool] | None:
        """The best state that can be reached, as a node, and whether it is a goal state."""
        while self._queue:
            self.query.limits.check()
            place, _, item = heappop(self._queue)
            if item.state in self.reached:
                continue
            if self._place(item) > place:
                self._push(item)
                continue
            motion = self.query.execute(item.parent.state, item.action)
            if motion is None:
                continue
            self.reached.add(item.state)
            self.novelty.add(item.counters, self.query.guide.atoms(item.state))
            return Node(item.state, item.parent, item.action, motion), item.is_goal
        return None


def open_goals(guide: Guide, state: State) -> int:
    """#g by a sketch: what its goal wants to be 0 and is not, counted, and its other parts that do
    not hold."""
    values = guide.values(state)
    goal = guide.model.goal or {}
    return sum(
        1 if wanted else values[f] for f, wanted in goal.items() if bool(values[f]) != wanted
    )
