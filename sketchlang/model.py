"""A sketch as the analyses see it: features without definitions, and rules over them.

This is the mathematical object of Bonet & Geffner (AAAI 2021): a set of features, Boolean
or non-negative integer (`nat`), and rules `C -> E`. The checker makes one from a syntax
tree; the termination and coverage analyses work on nothing else, and the interpreter uses
`Rule` to decide whether a pair of states satisfies a rule. Features are referred to by
their index.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from sketchlang.source import Span

NO_SPAN = Span(0, 0)


class Kind(Enum):
    """The type of a feature's value."""

    BOOL = "bool"
    NAT = "nat"


class Effect(Enum):
    """How a rule lets one feature change. A feature that a rule does not name keeps its value."""

    SET = "p"  # Boolean, true afterwards
    CLEAR = "!p"  # Boolean, false afterwards
    DEC = "n--"  # nat, falls (so it must be > 0 before)
    INC = "n++"  # nat, rises
    NOT_INC = "!n++"  # nat, does not rise
    NOT_DEC = "!n--"  # nat, does not fall
    ANY = "?"  # either kind, anything

    # That of Enum is a function in Python; there is one object of each.
    __hash__ = object.__hash__

    def allows(self, before: int, after: int) -> bool:
        """Whether a change of value satisfies this effect (Booleans count as 0 and 1)."""
        match self:
            case Effect.SET:
                return after == 1
            case Effect.CLEAR:
                return after == 0
            case Effect.DEC:
                return after < before
            case Effect.INC:
                return after > before
            case Effect.NOT_INC:
                return after <= before
            case Effect.NOT_DEC:
                return after >= before
            case Effect.ANY:
                return True


@dataclass(frozen=True, slots=True)
class Feature:
    """`bounded` declares that a nat never exceeds some fixed number along any run."""

    name: str
    kind: Kind
    bounded: bool = False
    span: Span = NO_SPAN


@dataclass(frozen=True, slots=True)
class Rule:
    """`conditions[f]` is the truth value that feature f must have: `p` / `n > 0` for True,
    `!p` / `n = 0` for False. `effects[f]` says how f may change; absent means unchanged.

    `condition_spans` and `effect_spans` tell where each was written.
    """

    name: str
    conditions: Mapping[int, bool]
    effects: Mapping[int, Effect]
    span: Span = NO_SPAN
    condition_spans: Mapping[int, Span] | None = None
    effect_spans: Mapping[int, Span] | None = None

    def applies(self, values: tuple[int, ...]) -> bool:
        """Whether the conditions hold for feature values (Booleans as 0 and 1)."""
        return all((values[f] > 0) == wanted for f, wanted in self.conditions.items())

    def satisfied_by(self, before: tuple[int, ...], after: tuple[int, ...]) -> bool:
        """Whether the pair of feature vectors satisfies the rule (paper, Sketches)."""
        if not self.applies(before):
            return False
        effects = self.effects
        for f, (old, new) in enumerate(zip(before, after, strict=True)):
            effect = effects.get(f)
            if effect is None:
                if old != new:
                    return False
            elif not effect.allows(old, new):
                return False
        return True


@dataclass(frozen=True, slots=True)
class Literal:
    """`p` / `n > 0` if `positive`, else `!p` / `n = 0`."""

    feature: int
    positive: bool


@dataclass(frozen=True, slots=True)
class Not:
    operand: Formula


@dataclass(frozen=True, slots=True)
class And:
    operands: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Or:
    operands: tuple[Formula, ...]


Formula = Literal | Not | And | Or
"""A statement about a valuation. An implication `a -> b` is `Or((Not(a), b))`."""


def holds(formula: Formula, values: tuple[int, ...]) -> bool:
    """Truth of a formula for feature values (Booleans as 0 and 1)."""
    match formula:
        case Literal(feature, positive):
            return (values[feature] > 0) == positive
        case Not(operand):
            return not holds(operand, values)
        case And(operands):
            return all(holds(operand, values) for operand in operands)
        case Or(operands):
            return any(holds(operand, values) for operand in operands)


@dataclass(frozen=True, slots=True)
class Invariant:
    """A fact about every reachable valuation, promised by the author, checked at run time."""

    formula: Formula
    text: str
    span: Span = NO_SPAN


@dataclass(frozen=True, slots=True)
class SketchModel:
    """Features, rules, goal and invariants of one sketch.

    `goal` is a conjunction (feature index -> truth value), or None where the sketch names
    none; goal valuations have no outgoing edges in the policy graph.
    """

    name: str
    features: tuple[Feature, ...]
    rules: tuple[Rule, ...]
    goal: Mapping[int, bool] | None = None
    invariants: tuple[Invariant, ...] = ()

    def is_goal(self, values: tuple[int, ...]) -> bool:
        """Whether feature values satisfy the goal (False where there is none)."""
        goal = self.goal
        return goal is not None and all((values[f] > 0) == v for f, v in goal.items())
