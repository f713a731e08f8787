"""What a failed search came near to: its samples looked at again, when all else is over.

A search records nothing for this. The guide still knows the feature values of all states of the
subproblem that failed; this finds those that miss a rule by least, and the actions that lead
there: breadth-first over the same samples, asking X only about what is to be told.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field

from runtime.search.guide import Guide, Values
from runtime.search.iw import Node
from runtime.search.novelty import NoveltyTable
from runtime.search.problem import Action, Rejection, State, Subproblem
from sketchlang.model import Effect

MOST_EDGES = 4_000
"""Actions that one exploration looks at."""

PATIENCE = 0.6
"""Seconds of processor time after which no further exploration begins and none goes on."""

ALIKE = 6
"""States with the same feature values that X is asked about, until one of them can be reached."""

NEAREST = 3
"""Feature values, nearest to a rule first, that actions are looked for."""


@dataclass(frozen=True)
class Deviation:
    """A feature that did not change as a rule demands; `effect` None: it is to stay as it is."""

    feature: int
    before: int
    after: int
    effect: Effect | None

    @property
    def is_idle(self) -> bool:
        """Whether what the rule asks for did not happen, or its opposite did where that is the
        wrong way: no other effect would help."""
        if self.effect is Effect.DEC:
            return self.after >= self.before
        return self.effect in (Effect.SET, Effect.CLEAR, Effect.INC) and self.after == self.before

    @property
    def weight(self) -> int:
        """How far a rule is from being satisfied by it: what is idle tells least."""
        return 2 if self.is_idle else 1


@dataclass(frozen=True)
class Miss:
    """A state that nearly satisfies a rule: its feature values, what is wrong with them, and the
    actions to it, empty where they were not found. `executable` tells whether X allows them."""

    rule: int
    after: Values
    wrong: tuple[Deviation, ...]
    actions: tuple[Action, ...] = ()
    executable: bool = False

    @property
    def weight(self) -> int:
        """The smaller, the nearer."""
        return sum(deviation.weight for deviation in self.wrong)

    @property
    def is_idle(self) -> bool:
        """Whether something that the rule asks for did not happen."""
        return any(deviation.is_idle for deviation in self.wrong)


@dataclass(frozen=True)
class Found:
    """A subgoal that the search did not get to: its rule or `GOAL`, and the actions to it.
    `refusal` is what X says of them; None: they can be done, but the search drops a state on the
    way, since nothing in it is new. `states` are those after each action."""

    rule: str
    actions: tuple[Action, ...]
    states: tuple[State, ...]
    refusal: Rejection | None


@dataclass
class Retrospect:
    """All that is known of a failed subproblem: the nearest miss of each rule that applies, the
    nearest first, and the subgoals that there were; `states` counts those that were seen."""

    misses: list[Miss] = field(default_factory=list)
    subgoals: list[Found] = field(default_factory=list)
    states: int = 0


def look_back(
    guide: Guide, subproblems: Sequence[Subproblem], start: State, before: Values
) -> Retrospect:
    """What the search for a subgoal of `start` came near to, with the samples that it had."""
    return _LookBack(guide, subproblems, start, before).run()


class _LookBack:
    def __init__(
        self, guide: Guide, subproblems: Sequence[Subproblem], start: State, before: Values
    ) -> None:
        self.guide, self.start, self.before = guide, start, before
        # The first samples are the most sensible ones, the last ones the densest.
        ends = list(subproblems[:1]) + list(subproblems[1:][-1:])
        sampled = bool(ends) and getattr(ends[0], "sampled", False)
        self.subproblems = ends if sampled else ends[:1]
        self.deadline = time.process_time() + PATIENCE
        # States by their feature values, a few of each, with the samples that lead to them.
        self.reached: dict[Values, list[tuple[Node, Subproblem]]] = {}

    def run(self) -> Retrospect:
        found = Retrospect()
        for subproblem in self.subproblems:
            self._explore(subproblem, 1)
        found.subgoals = self._subgoals()
        if not found.subgoals:
            for subproblem in self.subproblems[:1]:
                self._explore(subproblem, None)
            found.subgoals = self._subgoals()
        seen = {**self.guide.seen(), **self.reached}
        found.states = self.guide.known
        misses = [self._miss(number, seen) for number in self.guide.usable(self.before)]
        found.misses = sorted((m for m in misses if m is not None), key=lambda miss: miss.weight)
        return found

    # -- states ------------------------------------------------------------------------------

    def _explore(self, subproblem: Subproblem, k: int | None) -> None:
        for node in self._nodes(subproblem, k):
            alike = self.reached.setdefault(self.guide.values(node.state), [])
            if len(alike) < ALIKE:
                alike.append((node, subproblem))

    def _nodes(self, subproblem: Subproblem, k: int | None) -> Iterator[Node]:
        """States breadth first, without asking X; those with something new by IW(k), or all."""
        table = None if k is None else NoveltyTable(k)
        if table is not None:
            table.add(self.guide.atoms(self.start))
        known = {self.start}
        queue = deque([Node(self.start)])
        edges = 0
        while queue:
            node = queue.popleft()
            for action, state in subproblem.actions(node.state):
                edges += 1
                if edges > MOST_EDGES or time.process_time() > self.deadline:
                    return
                if state in known:
                    continue
                known.add(state)
                child = Node(state, node, action)
                yield child
                if table is not None:
                    atoms = self.guide.atoms(state)
                    if not table.is_novel(atoms):
                        continue
                    table.add(atoms)
                queue.append(child)

    # -- what they are worth -----------------------------------------------------------------

    def _subgoals(self) -> list[Found]:
        """One subgoal of each rule, and of the goal: one that X allows where there is one."""
        found: dict[str, Found] = {}
        for alike in self.reached.values():
            for node, subproblem in alike:
                rule = self.guide.fired(self.before, self.guide.values(node.state), node.state)
                if rule is None:
                    continue
                if rule not in found or found[rule].refusal is not None:
                    found[rule] = self._found(rule, node, subproblem)
        return list(found.values())

    def _found(self, rule: str, node: Node, subproblem: Subproblem) -> Found:
        path = node.path()
        refusal = self._refusal(node, subproblem)
        states = tuple(step.state for step in path)
        return Found(rule, tuple(step.action for step in path), states, refusal)

    def _refusal(self, node: Node, subproblem: Subproblem) -> Rejection | None:
        """What X says of the actions to a state, None if it allows them all."""
        state = self.start
        for step in node.path():
            answer = subproblem.execute(state, step.action)
            if isinstance(answer, Rejection):
                return answer
            state = step.state
        return None

    def _miss(self, number: int, seen: Collection[Values]) -> Miss | None:
        """The nearest miss of a rule: one with actions that X allows before others."""
        misses = [Miss(number, after, self._wrong(number, after)) for after in seen]
        misses = sorted((m for m in misses if m.wrong), key=self._nearness)
        for miss in misses[:NEAREST]:
            for node, subproblem in self.reached.get(miss.after, ()):
                if self._refusal(node, subproblem) is None:
                    actions = tuple(step.action for step in node.path())
                    return Miss(number, miss.after, miss.wrong, actions, True)
        return misses[0] if misses else None

    def _nearness(self, miss: Miss) -> tuple[int, int, int]:
        """Of equally near ones, those that fewest actions lead to; then those that raise least,
        for what rises is seldom meant."""
        reached = self.reached.get(miss.after, ())
        steps = min((len(node.path()) for node, _ in reached), default=MOST_EDGES)
        return miss.weight, steps, sum(d.after > d.before for d in miss.wrong)

    def _wrong(self, number: int, after: Values) -> tuple[Deviation, ...]:
        effects = self.guide.model.rules[number].effects
        found = []
        for f, (old, new) in enumerate(zip(self.before, after, strict=True)):
            effect = effects.get(f)
            if (old != new) if effect is None else not effect.allows(old, new):
                found.append(Deviation(f, old, new, effect))
        return tuple(found)
