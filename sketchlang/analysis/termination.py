"""Does every run that follows the sketch end? The verdict, with its evidence.

Termination here is a property of the rules alone (paper, Sketch termination): no infinite
sequence of feature values exists in which each pair of neighbours satisfies a rule, all
satisfy the invariants, and none but the last satisfies the goal.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sketchlang.analysis.bits import bounded_mask, rule_bits
from sketchlang.analysis.elimination import eliminate
from sketchlang.analysis.limits import Budget, LimitReachedError
from sketchlang.analysis.proof import Step
from sketchlang.model import SketchModel

# Most sketches that people prove need no Sieve, and then should not wait for it.
if TYPE_CHECKING:
    from sketchlang.analysis.numbers import Run
    from sketchlang.analysis.walk import Move


@dataclass(frozen=True, slots=True)
class Terminating:
    """`steps` leave no rule. Without Sieve, rule elimination was enough."""

    steps: tuple[Step, ...]
    by_sieve: bool


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
    """Proves or refutes that a sketch terminates, or stops at a limit of the budget."""
    rules = rule_bits(model)
    quick = eliminate([rule for rule in rules if not rule.dead], bounded_mask(model))
    left = [rule for rule in rules if rule.index in quick.left]
    if not left:
        return Terminating(quick.steps, by_sieve=False)

    from sketchlang.analysis.sieve import Sieve

    try:
        result = Sieve(model, rules, budget or Budget()).run(left)
    except LimitReachedError as reached:
        return Undecided(reached.kind, reached.limit)
    except MemoryError:
        return Undecided("memory", "memory of this machine")
    if result.cycle:
        from sketchlang.analysis.numbers import concrete_run

        run = concrete_run(model, result.cycle)
        return NonTerminating(result.cycle, run, quick.steps + result.steps)
    return Terminating(quick.steps + result.steps, by_sieve=True)


def endless_rules(model: SketchModel) -> frozenset[int] | None:
    """All rules that some endless run uses for ever, None if there are too many features."""
    from sketchlang.analysis.sieve import Sieve

    rules = rule_bits(model)
    return Sieve(model, rules, Budget()).survivors()
