"""Small changes that take runs away from a sketch, and what each of them forbids.

Every change is a restriction: what the changed sketch can do, the sketch could do before. So a
set of changes that makes it terminate still does so with more of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations

from sketchlang.analysis.bits import RuleBits, rule_bits
from sketchlang.analysis.words import effect, literal
from sketchlang.model import Effect, Invariant, Kind, Literal, Or, Rule, SketchModel

TIGHTER: dict[Effect, dict[Kind, tuple[Effect | None, ...]]] = {
    Effect.ANY: {
        Kind.BOOL: (Effect.SET, Effect.CLEAR, None),
        Kind.NAT: (Effect.NOT_INC, Effect.NOT_DEC, Effect.DEC, Effect.INC, None),
    },
    Effect.NOT_INC: {Kind.NAT: (Effect.DEC, None)},
    Effect.NOT_DEC: {Kind.NAT: (Effect.INC, None)},
}
"""What an effect can be tightened to; None is to keep the value."""


@dataclass(frozen=True, slots=True)
class Tighten:
    """Another effect on a feature; None: the rule keeps its value."""

    rule: int
    feature: int
    effect: Effect | None


@dataclass(frozen=True, slots=True)
class Require:
    """One more condition of a rule."""

    rule: int
    feature: int
    positive: bool


@dataclass(frozen=True, slots=True)
class LeaveOut:
    """A rule less."""

    rule: int


@dataclass(frozen=True, slots=True)
class Bound:
    """A nat that is declared bounded."""

    feature: int


@dataclass(frozen=True, slots=True)
class Assume:
    """An invariant: one of these literals (feature, truth value) holds in every state."""

    literals: tuple[tuple[int, bool], ...]


Change = Tighten | Require | LeaveOut | Bound | Assume


def place(change: Change) -> tuple[int, int] | Change:
    """Two changes at one place do not go together."""
    return (change.rule, change.feature) if isinstance(change, Tighten | Require) else change


def changed(model: SketchModel, changes: Iterable[Change]) -> SketchModel:
    """The sketch with changes made. Rules keep their numbers: one that is left out has a
    condition that is never true, see `removed`."""
    rules, features, invariants = list(model.rules), list(model.features), list(model.invariants)
    for change in changes:
        match change:
            case Tighten(r, f, instead):
                effects = {g: e for g, e in rules[r].effects.items() if g != f}
                if instead is not None:
                    effects[f] = instead
                rules[r] = replace(rules[r], effects=effects)
            case Require(r, f, positive):
                rules[r] = replace(rules[r], conditions={**rules[r].conditions, f: positive})
            case Bound(f):
                features[f] = replace(features[f], bounded=True)
            case Assume(literals):
                formula = Or(tuple(Literal(f, positive) for f, positive in literals))
                invariants.append(Invariant(formula, as_words(model, change)))
            case LeaveOut():
                pass
    return replace(
        model, rules=tuple(rules), features=tuple(features), invariants=tuple(invariants)
    )


def removed(changes: Iterable[Change]) -> frozenset[int]:
    """The rules that are left out."""
    return frozenset(change.rule for change in changes if isinstance(change, LeaveOut))


def without(model: SketchModel, rules: frozenset[int]) -> SketchModel:
    """The sketch without some rules."""
    kept = tuple(rule for r, rule in enumerate(model.rules) if r not in rules)
    return replace(model, rules=kept)


def forbids(model: SketchModel, change: Change) -> Fraction:
    """The part of all edges of the policy graph that a change takes away, 0 for a bound."""
    bits = rule_bits(model)
    total = sum(_edges(rule, range(len(model.features))) for rule in bits) or 1
    match change:
        case Bound():
            return Fraction(0)
        case Assume(literals):
            gone = sum(_edges_through(rule, model, literals) for rule in bits)
            return Fraction(gone, total)
        case LeaveOut(rule):
            return Fraction(_edges(bits[rule], range(len(model.features))), total)
        case Tighten(rule, _, _) | Require(rule, _, _):
            after = rule_bits(changed(model, [change]))[rule]
            features = range(len(model.features))
            return Fraction(_edges(bits[rule], features) - _edges(after, features), total)


def _edges(rule: RuleBits, features: Iterable[int]) -> int:
    count = 0 if rule.dead else 1
    for feature in features:
        count *= len(rule.pairs(feature))
    return count


def _edges_through(
    rule: RuleBits, model: SketchModel, literals: tuple[tuple[int, bool], ...]
) -> int:
    """Edges with all the literals false before, or after."""
    if rule.dead:
        return 0
    before = after = both = everything = 1
    wrong = {f: int(not positive) for f, positive in literals}
    for feature in range(len(model.features)):
        pairs = rule.pairs(feature)
        everything *= len(pairs)
        bad = wrong.get(feature)
        before *= sum(bad is None or b == bad for b, _ in pairs)
        after *= sum(bad is None or a == bad for _, a in pairs)
        both *= sum(bad is None or b == a == bad for b, a in pairs)
    return before + after - both


def as_words(model: SketchModel, change: Change) -> str:
    """The change in one phrase, in the language's own words."""
    match change:
        case Tighten(r, f, instead):
            rule = model.rules[r]
            written = effect(model, f, rule.effects[f])
            if instead is None:
                return f"{rule.name} without `{written}`"
            return f"{rule.name} with `{effect(model, f, instead)}`, not `{written}`"
        case Require(r, f, positive):
            return f"{model.rules[r].name} only where {literal(model, f, positive)}"
        case LeaveOut(r):
            return f"leave out {model.rules[r].name}"
        case Bound(f):
            return f"declare {model.features[f].name} bounded, if it is"
        case Assume():
            return f"invariant {invariant_text(model, change)}"


def invariant_text(model: SketchModel, change: Assume) -> str:
    """The formula of an invariant, as an implication where it has two literals."""

    def written(feature: int, positive: bool) -> str:
        text = literal(model, feature, positive)
        return f"not {text[1:]}" if text.startswith("!") else text

    *premises, (last, positive) = change.literals
    given = " and ".join(written(f, not value) for f, value in premises)
    return f"{given} -> {written(last, positive)}" if given else written(last, positive)


def tightenings(rule: Rule, index: int, model: SketchModel) -> Iterator[Tighten]:
    """All ways to tighten one effect of a rule."""
    for feature, written in rule.effects.items():
        for instead in TIGHTER.get(written, {}).get(model.features[feature].kind, ()):
            yield Tighten(index, feature, instead)


def requirements(rule: Rule, index: int, model: SketchModel) -> Iterator[Require]:
    """All conditions that a rule can have in addition, and still happen."""
    for feature in range(len(model.features)):
        if feature in rule.conditions:
            continue
        for positive in (False, True):
            # `n--` is only possible where n > 0 as it is.
            if rule.effects.get(feature) is not Effect.DEC:
                yield Require(index, feature, positive)


def assumptions(valuation: int, features: int) -> Iterator[Assume]:
    """Invariants of one or two literals that a valuation breaks."""
    literals = [(f, not valuation >> f & 1) for f in range(features)]
    for size in (1, 2):
        for chosen in combinations(literals, size):
            yield Assume(chosen)
