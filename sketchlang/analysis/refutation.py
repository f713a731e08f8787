"""A run that never ends, as a person reads it: its steps, and what would break it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sketchlang.analysis.bits import LOWERS, RAISES
from sketchlang.analysis.limits import Budget, LimitReachedError
from sketchlang.analysis.loops import Loops, nested_loops
from sketchlang.analysis.repair import Proposal, find_repairs
from sketchlang.analysis.termination import NonTerminating, Terminating, decide_termination
from sketchlang.analysis.words import effect, literal
from sketchlang.model import Effect, Kind, SketchModel
from sketchlang.source import Span

RECHECK_SECONDS = 0.5
"""Time to find out which of the remedies make the sketch terminate."""

REPAIR_SECONDS = 0.7
"""Time to look for a repair where none of the remedies does."""

MOST_LISTED = 1000
"""Steps of a cycle up to which all of them are listed; longer ones are told as loops."""

FIRST = 40
"""Steps of a longer cycle that are listed all the same."""


@dataclass(frozen=True, slots=True)
class Change:
    """What one feature does in one step. `written` is the effect, empty if it is not named."""

    feature: int
    written: str
    before: int
    after: int


@dataclass(frozen=True, slots=True)
class CycleStep:
    """A valuation of the cycle in numbers, the rule used there, and what it changes."""

    values: tuple[int, ...]
    rule: int
    changes: tuple[Change, ...]


@dataclass(frozen=True, slots=True)
class Edit:
    """An effect to write in place of another; None: the rule must not make this change at all."""

    rule: int
    feature: int
    effect: Effect | None
    span: Span | None


@dataclass(frozen=True, slots=True)
class Remedy:
    """One way to break the cycle: make all these changes.

    `reason` says why it breaks. `bound` is a feature to declare bounded instead of an edit.
    `suffices` tells whether the sketch terminates then; None if that was not found out.
    """

    reason: str
    edits: tuple[Edit, ...]
    bound: int | None
    suffices: bool | None


@dataclass(frozen=True, slots=True)
class Refutation:
    """`growing` are nats that rise every time around the cycle; all else comes back.

    Of more than `MOST_LISTED` steps only the first are in `steps`, `total` says how many there
    are, and `loops` tells all of them (None if a limit of time came before that). `remedies`
    are those that suffice; `repair` is the smallest one where there is none of them. `idle`
    says that no rule on the cycle changes anything for good.
    """

    rules: tuple[int, ...]
    steps: tuple[CycleStep, ...]
    total: int
    loops: Loops | None
    last: tuple[int, ...]
    growing: tuple[int, ...]
    remedies: tuple[Remedy, ...]
    repair: Proposal | None
    idle: bool


def refutation(
    model: SketchModel, verdict: NonTerminating, limits: Budget | None = None
) -> Refutation:
    """The evidence of a negative verdict. Remedies come with the fewest changes first."""
    limits = limits or Budget()
    total = len(verdict.walk)
    listed = total if total <= MOST_LISTED else FIRST
    values = verdict.run.values
    steps = tuple(
        CycleStep(before, move.rule, _changes(model, move.rule, before, after))
        for move, before, after in zip(verdict.walk[:listed], values, values[1:], strict=False)
    )
    rules = tuple(dict.fromkeys(move.rule for move in verdict.walk))
    used = sorted(rules)
    found = [*_by_counters(model, used), *_by_bounds(model, verdict.run.growing)]
    if not found:
        found = list(_by_booleans(model, used))
    budget = limits.within(RECHECK_SECONDS)
    checked = [replace(remedy, suffices=_suffices(model, remedy, budget)) for remedy in found]
    enough = sorted((r for r in checked if r.suffices), key=lambda r: len(r.edits) or 1)
    repair = None
    if not enough:
        proposals = find_repairs(model, limits.within(REPAIR_SECONDS), 1).proposals
        repair = proposals[0] if proposals else None
    loops = _loops(verdict, limits) if total > MOST_LISTED else None
    last, growing = values[-1], verdict.run.growing
    return Refutation(rules, steps, total, loops, last, growing, tuple(enough), repair, not found)


def _loops(verdict: NonTerminating, limits: Budget) -> Loops | None:
    try:
        return nested_loops([move.rule for move in verdict.walk], limits)
    except LimitReachedError:
        return None


def _changes(
    model: SketchModel, rule: int, before: Sequence[int], after: Sequence[int]
) -> tuple[Change, ...]:
    effects = model.rules[rule].effects
    return tuple(
        Change(f, effect(model, f, effects[f]), before[f], after[f])
        for f in range(len(model.features))
        if f in effects
    )


def _by_counters(model: SketchModel, used: Sequence[int]) -> list[Remedy]:
    """For every nat that is strictly changed on the cycle: do not change it back."""
    remedies = []
    for feature, declared in enumerate(model.features):
        if declared.kind is not Kind.NAT:
            continue
        effects = {rule: model.rules[rule].effects.get(feature) for rule in used}
        falls = [rule for rule, e in effects.items() if e is Effect.DEC]
        rises = [rule for rule, e in effects.items() if e is Effect.INC]
        ways = []
        if falls:
            ways.append(("falls", falls, RAISES, Effect.NOT_INC))
        elif rises and declared.bounded:
            ways.append(("rises", rises, LOWERS, Effect.NOT_DEC))
        for verb, strict, against, instead in ways:
            edits = tuple(
                _edit(model, rule, feature, instead) for rule, e in effects.items() if e in against
            )
            opposite = "rise" if verb == "falls" else "fall"
            names = " and ".join(model.rules[rule].name for rule in strict)
            reason = f"{declared.name} {verb} in {names} and must not {opposite} elsewhere"
            remedies.append(Remedy(reason, edits, None, None))
    return remedies


def _by_bounds(model: SketchModel, growing: Sequence[int]) -> list[Remedy]:
    return [
        Remedy(f"{model.features[f].name} grows without end", (), f, None)
        for f in growing
        if not model.features[f].bounded
    ]


def _by_booleans(model: SketchModel, used: Sequence[int]) -> list[Remedy]:
    """For every Boolean that the rules of the cycle set and clear: do not change it back."""
    remedies = []
    for feature, declared in enumerate(model.features):
        if declared.kind is not Kind.BOOL:
            continue
        effects = {rule: model.rules[rule].effects.get(feature) for rule in used}
        setters = [rule for rule, e in effects.items() if e in (Effect.SET, Effect.ANY)]
        clearers = [rule for rule, e in effects.items() if e in (Effect.CLEAR, Effect.ANY)]
        if not setters or not clearers:
            continue
        for makers, undoers, value in ((setters, clearers, True), (clearers, setters, False)):
            edits = tuple(_edit(model, rule, feature, None) for rule in undoers)
            names = " and ".join(model.rules[rule].name for rule in makers)
            done = literal(model, feature, value)
            remedies.append(
                Remedy(f"{names} gives {done} and nothing must undo it", edits, None, None)
            )
    return remedies


def _edit(model: SketchModel, rule: int, feature: int, instead: Effect | None) -> Edit:
    spans = model.rules[rule].effect_spans
    return Edit(rule, feature, instead, spans.get(feature) if spans else None)


def _suffices(model: SketchModel, remedy: Remedy, budget: Budget) -> bool | None:
    """Whether the sketch with the remedy in place is proved to terminate; None if the time was over
    before that was known."""
    try:
        budget.check()  # rule elimination does not look at the time
    except LimitReachedError:
        return None
    rules = list(model.rules)
    for edit in remedy.edits:
        if edit.effect is not None:
            changed_rule = rules[edit.rule]
            effects = {**changed_rule.effects, edit.feature: edit.effect}
            rules[edit.rule] = replace(changed_rule, effects=effects)
    # A rule that only loses a change could still fire, and for ever: it has to go.
    gone = {edit.rule for edit in remedy.edits if edit.effect is None}
    rules = [rule for index, rule in enumerate(rules) if index not in gone]
    features = list(model.features)
    if remedy.bound is not None:
        features[remedy.bound] = replace(features[remedy.bound], bounded=True)
    changed = replace(model, rules=tuple(rules), features=tuple(features))
    verdict = decide_termination(changed, budget)
    if isinstance(verdict, Terminating):
        return True
    return False if isinstance(verdict, NonTerminating) else None
