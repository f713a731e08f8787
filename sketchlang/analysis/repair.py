"""The smallest changes after which a sketch terminates, each of them proved.

A cycle that can go on for ever stays one until a change takes one of its edges away, or
an effect that makes up for what the cycle lowers. So every set of changes that helps has one
that touches the cycle: the search branches on those, smaller sets first, and among sets of
one size those first that forbid less. Cycles that were found are kept, and tried before the
prover is asked again.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from sketchlang.analysis.bits import RuleBits, bounded_mask, rule_bits
from sketchlang.analysis.changes import (
    TIGHTER,
    Assume,
    Bound,
    Change,
    LeaveOut,
    Require,
    Tighten,
    assumptions,
    changed,
    forbids,
    place,
    removed,
    requirements,
    tightenings,
    without,
)
from sketchlang.analysis.coverage import usable_rules
from sketchlang.analysis.cubes import TooManyCubesError
from sketchlang.analysis.elimination import drop
from sketchlang.analysis.limits import Budget, LimitReachedError
from sketchlang.analysis.piece import Move
from sketchlang.analysis.termination import NonTerminating, Terminating, decide_termination
from sketchlang.model import Effect, Kind, SketchModel

MOST_PROPOSALS = 5
"""Proposals that are made if there are so many."""

MOST_CHANGES = 9
"""Changes of one proposal, a rule that is left out counted as `WHOLE_RULE`."""

LAST_SECONDS = 0.2
"""Time to find some way out when the limit came before the smallest repair."""

USABLE_WORK = 100_000
"""Steps of work to see whether changes leave every rule its use; beyond that they may not."""

WHOLE_RULE = 3
"""A rule that is left out counts as this many changes: it is rather a way out than a repair."""


@dataclass(frozen=True, slots=True)
class Proposal:
    """Changes after which the sketch is proved to terminate.

    `forbids` is the part of the policy graph's edges that they take away, at most. `smallest`
    says that no set of fewer changes does.
    """

    changes: tuple[Change, ...]
    forbids: Fraction
    smallest: bool


@dataclass(frozen=True, slots=True)
class Repair:
    """Proposals, the best one first. Not `complete` if a limit came before that many."""

    proposals: tuple[Proposal, ...]
    complete: bool


Universe = Callable[[Sequence[Move]], Iterator[Change]]
"""The changes to choose from that may touch a cycle."""


def find_repairs(
    model: SketchModel,
    budget: Budget,
    most: int = MOST_PROPOSALS,
    universe: Universe | None = None,
) -> Repair:
    """Proposals for a sketch that does not terminate; none if it does, or if none was found.

    Where the universe is given, changes may make rules useless, as long as some can be used.
    """
    useless = universe is not None
    found = _Search(model, budget, universe or _everything(model), useless).run(most)
    if found.proposals or universe is not None:
        return found
    # A way out after all, even if it is not the smallest: rules that are left out, and bounds.
    rest = _Search(model, budget.extended(LAST_SECONDS), _way_out(model), True).run(1)
    return Repair(tuple(replace(one, smallest=False) for one in rest.proposals), False)


def _way_out(model: SketchModel) -> Universe:
    def touching(cycle: Sequence[Move]) -> Iterator[Change]:
        yield from (Bound(f) for f in unbounded(model))
        yield from (LeaveOut(index) for index in sorted({move.rule for move in cycle}))

    return touching


def unbounded(model: SketchModel) -> list[int]:
    """The nats that may be declared bounded."""
    return [f for f, x in enumerate(model.features) if x.kind is Kind.NAT and not x.bounded]


def _everything(model: SketchModel) -> Universe:
    """Effects, conditions, bounds, short invariants, and rules that are left out."""

    def touching(cycle: Sequence[Move]) -> Iterator[Change]:
        for index in sorted({move.rule for move in cycle}):
            rule = model.rules[index]
            yield from tightenings(rule, index, model)
            yield from requirements(rule, index, model)
            yield LeaveOut(index)
        yield from assumed(model, cycle)

    return touching


def assumed(model: SketchModel, cycle: Sequence[Move]) -> Iterator[Change]:
    """What can be assumed about features so that a cycle is none: bounds and invariants."""
    yield from (Bound(f) for f in unbounded(model))
    seen: set[Change] = set()
    for valuation in dict.fromkeys(move.before for move in cycle):
        for change in assumptions(valuation, len(model.features)):
            if change not in seen:
                seen.add(change)
                yield change


def _covers(changes: frozenset[Change], weaker: frozenset[Change]) -> bool:
    """Whether each of the weaker changes is made, or a stricter one in its place."""
    return all(
        one in changes
        or (isinstance(one, Tighten) and any(_stricter(other, one) for other in changes))
        for one in weaker
    )


def _stricter(change: Change, than: Tighten) -> bool:
    if isinstance(change, LeaveOut):
        return change.rule == than.rule
    if not isinstance(change, Tighten) or place(change) != place(than) or than.effect is None:
        return False
    return any(change.effect in kinds for kinds in TIGHTER.get(than.effect, {}).values())


def _weight(change: Change) -> int:
    return WHOLE_RULE if isinstance(change, LeaveOut) else 1


@dataclass(order=True)
class _Node:
    """A set of changes that is to be tried. Of those that forbid as much, what only keeps a
    feature from changing comes before `demands` that something happens: that may be impossible."""

    size: int
    forbids: Fraction
    demands: int
    serial: int
    changes: tuple[Change, ...] = field(compare=False)


def _demands(change: Change) -> bool:
    """Whether an effect has to happen now, and may not stay away."""
    return isinstance(change, Tighten) and change.effect in (
        Effect.DEC, Effect.INC, Effect.SET, Effect.CLEAR,
    )  # fmt: skip


class _Search:
    def __init__(
        self, model: SketchModel, budget: Budget, universe: Universe, useless: bool
    ) -> None:
        self.model = model
        self.useless = useless
        # To leave out rules is always enough, if it may be all of them.
        self.most = WHOLE_RULE * len(model.rules) if useless else MOST_CHANGES
        self.budget = budget
        self.universe = universe
        self.cycles: list[tuple[Move, ...]] = []
        self.costs: dict[Change, Fraction] = {}
        self.sketches = _Masks(model)
        self.used: frozenset[int] | None = None

    def run(self, most: int) -> Repair:
        found: list[Proposal] = []
        try:
            for node in self._solutions():
                if not node.changes:
                    break  # nothing to repair
                found.append(self._proposal(node, found))
                if len(found) == most:
                    break
        except LimitReachedError:
            return Repair(tuple(found), False)
        return Repair(tuple(found), True)

    def _solutions(self) -> Iterator[_Node]:
        """Sets of changes that suffice, without supersets of others, the smallest first."""
        serial = itertools.count()
        queue = [_Node(0, Fraction(0), 0, next(serial), ())]
        seen: set[frozenset[Change]] = set()
        found: list[frozenset[Change]] = []
        while queue:
            self.budget.check()
            node = heapq.heappop(queue)
            chosen = frozenset(node.changes)
            if any(_covers(chosen, weaker) for weaker in found) or self._absurd(node.changes):
                continue
            if node.size > self.most:
                return
            cycle = self._cycle(node.changes)
            if cycle is None:
                found.append(chosen)
                yield node
                continue
            for change in self._breaking(node.changes, cycle):
                if chosen | {change} not in seen:
                    seen.add(chosen | {change})
                    size, cost = node.size + _weight(change), node.forbids + self._cost(change)
                    changes = (*node.changes, change)
                    demands = node.demands + _demands(change)
                    heapq.heappush(queue, _Node(size, cost, demands, next(serial), changes))

    def _proposal(self, node: _Node, found: Sequence[Proposal]) -> Proposal:
        least = sum(map(_weight, found[0].changes)) if found else node.size
        changes = tuple(sorted(node.changes, key=lambda c: (self._cost(c), repr(c))))
        return Proposal(changes, node.forbids, node.size == least)

    def _cost(self, change: Change) -> Fraction:
        if change not in self.costs:
            self.costs[change] = forbids(self.model, change)
        return self.costs[change]

    def _cycle(self, changes: tuple[Change, ...]) -> tuple[Move, ...] | None:
        """A cycle that the changes leave, None if the prover says that there is none.

        Raises:
            LimitReachedError: a limit was hit before that was known.
        """
        masks = self.sketches.of(changes)
        for cycle in self.cycles:
            if masks.allows(cycle):
                return cycle
        gone = removed(changes)
        kept = [r for r in range(len(self.model.rules)) if r not in gone]
        verdict = decide_termination(without(changed(self.model, changes), gone), self.budget)
        if isinstance(verdict, Terminating):
            return None
        if isinstance(verdict, NonTerminating):
            cycle = tuple(Move(m.before, kept[m.rule], m.after) for m in verdict.walk)
            self.cycles.append(cycle)
            return cycle
        raise LimitReachedError(verdict.kind, verdict.limit)

    def _breaking(self, changes: tuple[Change, ...], cycle: tuple[Move, ...]) -> Iterator[Change]:
        """The changes that touch a cycle: an edge of it, or what makes up for what it lowers."""
        places = {place(change) for change in changes}
        gone = removed(changes)
        masks = self.sketches.of(changes)
        moves = set(cycle)
        for change in self.universe(cycle):
            self.budget.check()
            if place(change) in places or getattr(change, "rule", None) in gone:
                continue
            if masks.touched(moves, change, self.sketches.of((*changes, change))):
                yield change

    def _absurd(self, changes: tuple[Change, ...]) -> bool:
        """Whether changes do what leaving out a rule does, by another name."""
        if all(isinstance(change, LeaveOut | Bound) for change in changes):
            return False
        try:
            if self.used is None:
                self.used = usable_rules(self.model, USABLE_WORK)
            usable = usable_rules(changed(self.model, changes), USABLE_WORK)
        except TooManyCubesError:
            return False
        if self.useless:
            return bool(self.used) and not usable
        return not self.used - removed(changes) <= usable


class _Masks:
    """Sketches with changes as masks; what was made of one rule is kept."""

    def __init__(self, model: SketchModel) -> None:
        self.model = model
        self._base = rule_bits(model)
        self._made: dict[frozenset[Change], RuleBits] = {}

    def of(self, changes: Sequence[Change]) -> _Changed:
        by_rule: dict[int, list[Change]] = {}
        for change in changes:
            if isinstance(change, Tighten | Require):
                by_rule.setdefault(change.rule, []).append(change)
        rules = list(self._base)
        for rule, own in by_rule.items():
            key = frozenset(own)
            if key not in self._made:
                self._made[key] = rule_bits(changed(self.model, own))[rule]
            rules[rule] = self._made[key]
        bounded = bounded_mask(self.model)
        for change in changes:
            bounded |= 1 << change.feature if isinstance(change, Bound) else 0
        assumed = [change for change in changes if isinstance(change, Assume)]
        return _Changed(
            tuple(rules), removed(changes), bounded, tuple(_broken(one) for one in assumed)
        )


def _broken(change: Assume) -> tuple[int, int]:
    """The valuations that break an invariant: (mask, bits)."""
    mask = sum(1 << f for f, _ in change.literals)
    return mask, sum(1 << f for f, positive in change.literals if not positive)


@dataclass(frozen=True, slots=True)
class _Changed:
    """What decides whether a cycle of the original sketch is still one. Goal and invariants
    of the original do not matter: its cycles keep clear of them."""

    rules: tuple[RuleBits, ...]
    gone: frozenset[int]
    bounded: int
    broken: tuple[tuple[int, int], ...]

    def allows(self, cycle: Sequence[Move]) -> bool:
        """Whether a cycle can still go on for ever."""
        used = sorted({move.rule for move in cycle})
        return (
            not self.gone & set(used)
            and drop([self.rules[r] for r in used], self.bounded) is None
            and all(self.has(move) for move in set(cycle))
        )

    def has(self, move: Move) -> bool:
        """Whether the policy graph has an edge, and no new invariant is in its way."""
        rule = self.rules[move.rule]
        if (move.before ^ rule.wants) & rule.needs:
            return False
        base, free = rule.fan(move.before)
        return not (move.after ^ base) & ~free and all(
            move.before & mask != bits for mask, bits in self.broken
        )

    def touched(self, moves: set[Move], change: Change, after: _Changed) -> bool:
        """Whether a change takes an edge of a cycle, or a rise or a fall of one of its rules."""
        match change:
            case LeaveOut():
                return True
            case Bound(feature):
                return any(self.rules[move.rule].rises >> feature & 1 for move in moves)
            case Assume():
                mask, bits = _broken(change)
                return any(move.before & mask == bits for move in moves)
            case Tighten(rule, _, _) | Require(rule, _, _):
                old, new = self.rules[rule], after.rules[rule]
                return (
                    (old.may_rise, old.may_fall) != (new.may_rise, new.may_fall)
                    or (old.falls, old.rises) != (new.falls, new.rises)
                    or not all(after.has(move) for move in moves if move.rule == rule)
                )
