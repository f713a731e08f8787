"""Does every run that follows the sketch end? The verdict, with its evidence.

Termination here is a property of the rules alone (paper, Sketch termination): no infinite
sequence of feature values exists in which each pair of neighbours satisfies a rule, all
satisfy the invariants, and none but the last satisfies the goal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sketchlang.analysis.bits import RuleBits, bounded_mask, rule_bits
from sketchlang.analysis.elimination import eliminate
from sketchlang.analysis.limits import Budget, LimitReachedError, WorkDoneError
from sketchlang.analysis.proof import Step
from sketchlang.model import SketchModel

# Most sketches that people prove need no Sieve, and then should not wait for it.
if TYPE_CHECKING:
    from sketchlang.analysis.numbers import Run
    from sketchlang.analysis.piece import Move
    from sketchlang.analysis.sieve import SieveResult

SMALL_WORK = 6_000
"""Steps of Sieve before anything is imported that takes longer than they do: some 5 ms."""

EDGES_A_STEP = 600
"""Where all valuations can be listed, Sieve is given a step more for so many edges: a tenth of the
time that listing them takes (measured)."""


@dataclass(frozen=True, slots=True)
class Terminating:
    """`steps` leave no rule. `method` is the strongest that was needed: `rule-elimination`,
    `potentials`, or `sieve`."""

    steps: tuple[Step, ...]
    method: str

    @property
    def by_sieve(self) -> bool:
        """Whether valuations had to be looked at."""
        return self.method == "sieve"


@dataclass(frozen=True, slots=True)
class NonTerminating:
    """A closed walk of valuations that rules can follow for ever, and numbers for it.

    `steps` are what could be eliminated before.
    """

    walk: tuple[Move, ...]
    run: Run
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Undecided:
    """`kind` is `time` or `memory`, `limit` says how much there was of it."""

    kind: str
    limit: str


Verdict = Terminating | NonTerminating | Undecided


def decide_termination(model: SketchModel, budget: Budget | None = None) -> Verdict:
    """Proves or refutes that a sketch terminates, or stops at a limit of the budget.

    The cheapest first: rule elimination; a little Sieve, which proves what people write; short
    cycles; potentials; and Sieve without restraint.
    """
    rules = rule_bits(model)
    quick = eliminate([rule for rule in rules if not rule.dead], bounded_mask(model))
    if not quick.left:
        return Terminating(quick.steps, "rule-elimination")
    try:
        return _Search(model, rules, budget or Budget()).run(quick.steps, quick.left)
    except LimitReachedError as reached:
        return Undecided(reached.kind, reached.limit)
    except MemoryError:
        return Undecided("memory", "memory of this machine")


class _Search:
    """The methods behind rule elimination, for one sketch."""

    def __init__(self, model: SketchModel, rules: Sequence[RuleBits], budget: Budget) -> None:
        self.model = model
        self.rules = rules
        self.bounded = bounded_mask(model)
        self.budget = budget

    def run(self, quick: tuple[Step, ...], kept: frozenset[int]) -> Verdict:
        left = [rule for rule in self.rules if rule.index in kept]
        try:
            return self._verdict(quick, self._sieve(left, self.budget.attempt(SMALL_WORK)))
        except WorkDoneError:
            pass
        from sketchlang.analysis.short_cycles import short_cycle

        cycle = short_cycle(self.model, self.rules, left, self.budget)
        if cycle:
            return self._refuted(quick, cycle)
        steps, left = self._potentials(quick, left)
        if not left:
            return Terminating(steps, "potentials")
        return self._listed(steps, left)

    def _listed(self, steps: tuple[Step, ...], left: list[RuleBits]) -> Verdict:
        """By more Sieve; or, when that would take longer, by all valuations. Where these are many,
        cycles are looked for in firing counts first."""
        from sketchlang.analysis.listed_graph import MOST_EDGES, TooManyEdgesError
        from sketchlang.analysis.listing import Listing, applications

        edges = applications(self.model, left)
        if edges is None or edges // EDGES_A_STEP > SMALL_WORK:
            from sketchlang.analysis.balance import balanced_cycle

            balanced = balanced_cycle(self.model, self.rules, left, self.budget)
            if balanced:
                return self._refuted(steps, balanced)
        if edges is None or edges > MOST_EDGES:
            return self._verdict(steps, self._sieve(left, self.budget))
        if edges // EDGES_A_STEP > SMALL_WORK:  # that much was done in vain
            try:
                attempt = self.budget.attempt(edges // EDGES_A_STEP)
                return self._verdict(steps, self._sieve(left, attempt))
            except WorkDoneError:
                pass
        try:
            found = Listing(self.model, left, self.budget).run()
        except TooManyEdgesError:
            return self._verdict(steps, self._sieve(left, self.budget))
        if found.step is not None:
            return Terminating((*steps, found.step), "sieve")
        from sketchlang.analysis.region import Outside
        from sketchlang.analysis.walk import close, propose

        assert found.stuck is not None
        walk = propose(found.stuck, self.bounded, self.budget, found.graph)
        cycle, _ = close(walk, found.stuck.tracked, self.model, self.rules, Outside(self.model))
        return self._refuted(steps, tuple(cycle))

    def _potentials(
        self, quick: tuple[Step, ...], left: list[RuleBits]
    ) -> tuple[tuple[Step, ...], list[RuleBits]]:
        """Steps by potentials and rule elimination in turn, and the rules that they leave.

        They start from all rules again: a sum may say in one line what takes many steps.
        """
        from sketchlang.analysis.potential import potential

        steps: list[Step] = []
        rest = [rule for rule in self.rules if not rule.dead]
        while rest:
            found = potential(rest, self.bounded, self.budget)
            if found is None:
                break
            steps.append(found)
            rest = [rule for rule in rest if rule.index not in found.rules]
            more = eliminate(rest, self.bounded)
            steps += more.steps
            rest = [rule for rule in rest if rule.index in more.left]
        return (tuple(steps), rest) if len(rest) < len(left) else (quick, left)

    def _sieve(self, left: list[RuleBits], budget: Budget) -> SieveResult:
        from sketchlang.analysis.sieve import Sieve

        return Sieve(self.model, self.rules, budget).run(left)

    def _verdict(self, steps: tuple[Step, ...], result: SieveResult) -> Verdict:
        if result.cycle:
            return self._refuted(steps + result.steps, result.cycle)
        return Terminating(steps + result.steps, "sieve")

    def _refuted(self, steps: tuple[Step, ...], cycle: tuple[Move, ...]) -> NonTerminating:
        from sketchlang.analysis.numbers import concrete_run

        return NonTerminating(cycle, concrete_run(self.model, cycle), steps)


def endless_rules(model: SketchModel) -> frozenset[int] | None:
    """All rules that some endless run uses for ever, None if there are too many features."""
    from sketchlang.analysis.sieve import Sieve

    rules = rule_bits(model)
    return Sieve(model, rules, Budget()).survivors()
