"""Conditions, effects and goals: literals to the rules of a `SketchModel`."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from sketchlang.checking.declarations import Declarations, Placed
from sketchlang.checking.report import Report
from sketchlang.diagnostics import Label, Severity
from sketchlang.model import Effect, Feature, Kind, Rule
from sketchlang.source import Source, Span
from sketchlang.suggest import did_you_mean
from sketchlang.syntax import tree

EFFECT_SIGNS = ("--", "++", "?")
_EFFECTS = {
    (Kind.BOOL, False, ""): Effect.SET,
    (Kind.BOOL, True, ""): Effect.CLEAR,
    (Kind.BOOL, False, "?"): Effect.ANY,
    (Kind.NAT, False, "--"): Effect.DEC,
    (Kind.NAT, False, "++"): Effect.INC,
    (Kind.NAT, False, "?"): Effect.ANY,
    (Kind.NAT, True, "++"): Effect.NOT_INC,
    (Kind.NAT, True, "--"): Effect.NOT_DEC,
}


@dataclass
class RuleReader:
    """Reads literals; `features` and `index` list the features that are declared."""

    features: tuple[Feature, ...]
    index: Mapping[str, int]
    declarations: Declarations
    report: Report
    functions: Collection[str] = ()
    faulty: set[str] = field(default_factory=set)
    """Rules with literals that are left out because they are wrong."""

    def rule(self, placed: Placed[tree.RuleItem]) -> Rule:
        """The rule of an item, without the literals that are wrong."""
        item, source = placed.item, placed.source
        before = len(self.report.diagnostics)
        conditions, condition_spans = self.conditions(item.conditions, source)
        effects: dict[int, Effect] = {}
        effect_spans: dict[int, Span] = {}
        for literal in item.effects.literals:
            self._effect(literal, source, effects, effect_spans)
        found = self.report.diagnostics[before:]
        named = {
            literal.name.text for literal in (*item.conditions.literals, *item.effects.literals)
        }
        if not named <= self.index.keys() or any(d.severity is Severity.ERROR for d in found):
            self.faulty.add(item.name.text)
        return Rule(
            item.name.text,
            conditions,
            effects,
            item.span,
            condition_spans,
            effect_spans,
        )

    def conditions(
        self, block: tree.Block, source: Source
    ) -> tuple[dict[int, bool], dict[int, Span]]:
        """Truth values by feature, and where each was written."""
        values: dict[int, bool] = {}
        spans: dict[int, Span] = {}
        for literal in block.literals:
            feature = self._feature(literal, source)
            value = self._condition(literal, feature, source) if feature is not None else None
            if feature is None or value is None:
                continue
            if feature not in values:
                values[feature] = value
                spans[feature] = literal.span
                continue
            first = Label(source, spans[feature], "the other one")
            text = self.features[feature].name
            if values[feature] == value:
                message = f"this says about `{text}` what was said before"
                self.report.add("repeated-condition", message, Label(source, literal.span), first)
            else:
                message = f"`{text}` cannot satisfy both conditions"
                self.report.add(
                    "contradictory-conditions",
                    message,
                    Label(source, literal.span),
                    first,
                    hint="Remove one of them.",
                )
        return values, spans

    def _feature(self, literal: tree.Literal, source: Source) -> int | None:
        name = literal.name.text
        found = self.index.get(name)
        if found is None and name not in self.declarations.broken:
            if self.declarations.incomplete:
                return None
            hint = did_you_mean(name, self.index)
            if name in self.declarations.defines:
                hint = f"`{name}` is a definition: make it a feature to use it in rules."
            elif name in self.functions:
                hint = f"`{name}` is a function: define a feature with it and name that here."
            elif hint is None and self.index:
                listed = ", ".join(f"`{feature}`" for feature in [*self.index][:8])
                hint = f"Features: {listed}{', ...' if len(self.index) > 8 else '.'}"
            message = f"there is no feature `{name}`"
            self.report.add(
                "undefined-feature", message, Label(source, literal.name.span), hint=hint
            )
        return found

    def _condition(self, literal: tree.Literal, feature: int, source: Source) -> bool | None:
        """The truth value that a condition or goal literal asks for."""
        name, sign, number = literal.name.text, literal.sign, literal.number
        place = Label(source, literal.span)
        if sign in EFFECT_SIGNS:
            hint = "Effects stand on the right of `->`."
            message = f"`{name}{sign}` is an effect and cannot be a condition"
            self.report.add("effect-as-condition", message, place, hint=hint)
            return None
        declared = self._declared(name)
        if self.features[feature].kind is Kind.BOOL:
            if sign:
                self.report.add(
                    "wrong-condition",
                    f"`{name}` is a Boolean and cannot be compared with a number",
                    place,
                    declared,
                    hint=f"Write `{name}` or `!{name}`.",
                )
                return None
            return not literal.negated
        if not sign:
            self.report.add(
                "wrong-condition",
                f"`{name}` is a number, not a truth value",
                place,
                declared,
                hint=f"Write `{name} = 0`." if literal.negated else f"Write `{name} > 0`.",
            )
            return None
        value = _ZERO_TEST.get((sign, number or 0)) if (number or 0) <= 1 else None
        if value is None:
            self.report.add(
                "condition-beyond-zero",
                f"conditions can only tell whether `{name}` is 0",
                place,
                hint=f"Declare a Boolean feature that is `{name} {sign} {number}`.",
            )
            return None
        wanted = value != literal.negated
        if (sign, number) not in (("=", 0), (">", 0)) or literal.negated:
            better = f"{name} > 0" if wanted else f"{name} = 0"
            self.report.add(
                "odd-condition",
                f"this condition is written `{better}`",
                place,
                hint=f"Write `{better}`.",
            )
        return wanted

    def _declared(self, name: str) -> Label:
        placed = self.declarations.features[name]
        return placed.label(placed.item.name.span, f"declared as {placed.item.kind}")

    def _effect(
        self,
        literal: tree.Literal,
        source: Source,
        effects: dict[int, Effect],
        spans: dict[int, Span],
    ) -> None:
        feature = self._feature(literal, source)
        if feature is None:
            return
        name, place = literal.name.text, Label(source, literal.span)
        if literal.number is not None:
            self.report.add(
                "condition-as-effect",
                "effects say how a feature changes, not what value it has",
                place,
                hint=self._effect_for(literal, feature),
            )
            return
        kind = self.features[feature].kind
        effect = _EFFECTS.get((kind, literal.negated, literal.sign))
        if effect is None:
            self.report.add(
                "wrong-effect",
                self._why_wrong(literal, kind),
                place,
                self._declared(name),
                hint=_effects_of(name, kind),
            )
        elif feature not in effects:
            effects[feature] = effect
            spans[feature] = literal.span
        else:
            first = Label(source, spans[feature], "the other one")
            if effects[feature] is effect:
                message = f"this effect on `{name}` was given before"
                self.report.add("repeated-effect", message, place, first)
            else:
                message = f"`{name}` has two effects in one rule"
                hint = self._joint(name, {effects[feature], effect})
                self.report.add("contradictory-effects", message, place, first, hint=hint)

    def _effect_for(self, literal: tree.Literal, feature: int) -> str:
        name = literal.name.text
        if self.features[feature].kind is Kind.BOOL:
            return f"Write `{name}`, `!{name}` or `{name}?`."
        return f"Write `{name}--`, `{name}++`, `{name}?`, `!{name}++` or `!{name}--`."

    def _why_wrong(self, literal: tree.Literal, kind: Kind) -> str:
        name, sign = literal.name.text, literal.sign
        if sign == "?":
            return f"`{name}?` allows every change: its negation means nothing"
        if kind is Kind.BOOL:
            return f"`{name}` is a Boolean: it cannot rise or fall"
        return f"`{name}` is a number: it cannot be made true or false"

    @staticmethod
    def _joint(name: str, both: set[Effect]) -> str:
        if both == {Effect.NOT_INC, Effect.NOT_DEC}:
            return f"Leave both out if `{name}` must not change: what is not named stays."
        if Effect.ANY in both:
            return f"`{name}?` allows everything that the other one allows: keep one."
        return "Write two rules, or keep one of the effects."


# What a comparison of a nat with 0 or 1 says: positive, zero, or nothing.
_ZERO_TEST = {
    ("=", 0): False,
    ("<=", 0): False,
    ("<", 1): False,
    (">", 0): True,
    ("!=", 0): True,
    (">=", 1): True,
}


def _effects_of(name: str, kind: Kind) -> str:
    if kind is Kind.BOOL:
        return f"Effects on Booleans: `{name}`, `!{name}`, `{name}?`."
    return f"Effects on numbers: `{name}--`, `{name}++`, `{name}?`, `!{name}++`, `!{name}--`."
