"""Breadth-first search: every state once, nearest first (Russell & Norvig)."""

from __future__ import annotations

from collections import deque

from runtime.search.guide import GOAL
from runtime.search.iw import Node
from runtime.search.query import Query


def brfs(query: Query) -> tuple[Node, str] | None:
    """A nearest node whose state is a goal state, with `GOAL` for a rule, or None.

    Every edge of the tree is executable: its motion is planned before the child is kept.

    Raises:
        OutOfTimeError: when the limits say so.
    """
    guide, subproblem = query.guide, query.subproblem
    reached = {query.start}
    queue = deque([Node(query.start)])
    while queue:
        node = queue.popleft()
        query.effort.expanded += 1
        for action, state in subproblem.actions(node.state):
            query.generate()
            if state in reached:
                continue
            motion = query.execute(node.state, action)
            if motion is None:
                continue
            child = Node(state, node, action, motion)
            if guide.reaches_goal(state):
                return child, GOAL
            reached.add(state)
            queue.append(child)
    return None
