"""Does every run that follows the sketch end? The verdict, with its evidence.

Termination here is a property of the rules alone (paper, Sketch termination): no infinite
sequence of feature values exists in which each pair of neighbours satisfies a rule, all
satisfy the invariants, and none but the last satisfies the goal.
"""

from __future__ import annotations

from dataclasses import dataclass

from sketchlang.analysis.bits import bounded_mask, rule_bits
from sketchlang.analysis.elimination import eliminate
from sketchlang.analysis.limits import Budget, LimitReachedError
from sketchlang.analysis.numbers import Run, concrete_run
from sketchlang.analysis.proof import Step
from sketchlang.analysis.sieve import Sieve
from sketchlang.analysis.walk import Move
from sketchlang.model import SketchModel


@dataclass(frozen=True, slots=True)
class Terminating:
    """`steps` leave no rule. Without Sieve, rule elimination was enough."""

    steps: tuple[Step, ...]
    by_sieve: bool


@dataclass(frozen=True, slots=True)
class NonTerminating:
    """A closed walk of valuations that rules can follow for ever, and numbers for it."""

    walk: tuple[Move, ...]
    run: Run


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
    try:
        result = Sieve(model, rules, budget or Budget()).run(left)
    except LimitReachedError as reached:
        return Undecided(reached.kind, reached.limit)
    except MemoryError:
        return Undecided("memory", "memory of this machine")
    if result.cycle:
        return NonTerminating(result.cycle, concrete_run(model, result.cycle))
    return Terminating(quick.steps + result.steps, by_sieve=True)
