"""Which rules apply at some feature values, and what their effects ask for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sketchlang.analysis.words import effect, literal
from sketchlang.model import Effect, Feature, Kind, Rule, SketchModel

Values = tuple[int, ...]


@dataclass(frozen=True)
class ConditionAt:
    """A condition as it is written, the value of its feature, and whether it holds."""

    text: str
    feature: str
    value: int | bool
    holds: bool


@dataclass(frozen=True)
class Demand:
    """What a rule asks of one feature of the state that it leads to: the effect as it is written
    (None where the rule does not name the feature, so that it keeps its value), and in words;
    `possible` tells whether any value satisfies it."""

    feature: str
    effect: str | None
    text: str
    possible: bool


@dataclass(frozen=True)
class RuleAt:
    """A rule at some feature values: its conditions, and what a subgoal of it would be."""

    name: str
    applies: bool
    conditions: tuple[ConditionAt, ...]
    demands: tuple[Demand, ...]

    @property
    def failing(self) -> tuple[ConditionAt, ...]:
        """The conditions that do not hold."""
        return tuple(condition for condition in self.conditions if not condition.holds)


def conditions_at(
    model: SketchModel, wanted: Mapping[int, bool], values: Values
) -> tuple[ConditionAt, ...]:
    """The conditions of a rule, or of the goal, at some values."""
    return tuple(
        ConditionAt(
            literal(model, index, positive),
            model.features[index].name,
            shown_value(model.features[index], values[index]),
            (values[index] > 0) == positive,
        )
        for index, positive in wanted.items()
    )


def rules_at(model: SketchModel, values: Values) -> tuple[RuleAt, ...]:
    """All rules of a sketch at some values."""
    return tuple(_rule_at(model, rule, values) for rule in model.rules)


def _rule_at(model: SketchModel, rule: Rule, values: Values) -> RuleAt:
    demands = tuple(
        _demand(model, index, rule.effects.get(index), values[index])
        for index in range(len(model.features))
    )
    conditions = conditions_at(model, rule.conditions, values)
    return RuleAt(rule.name, rule.applies(values), conditions, demands)


def _demand(model: SketchModel, index: int, kind: Effect | None, value: int) -> Demand:
    feature = model.features[index]
    written = None if kind is None else effect(model, index, kind)
    possible = kind is not Effect.DEC or value > 0
    return Demand(feature.name, written, _in_words(feature, kind, value), possible)


def _in_words(feature: Feature, kind: Effect | None, value: int) -> str:
    name = feature.name
    match kind:
        case None if feature.kind is Kind.BOOL:
            return f"{name} stays {'true' if value else 'false'}"
        case None:
            return f"{name} stays {value}"
        case Effect.SET:
            return f"{name} {'stays' if value else 'becomes'} true"
        case Effect.CLEAR:
            return f"{name} {'becomes' if value else 'stays'} false"
        case Effect.DEC:
            return f"{name} falls below {value}"
        case Effect.INC:
            return f"{name} rises above {value}"
        case Effect.NOT_INC:
            return f"{name} is {value} or less" if value else f"{name} stays 0"
        case Effect.NOT_DEC:
            return f"{name} is {value} or more"
        case Effect.ANY:
            return f"{name} may be anything"


def shown_value(feature: Feature, value: int) -> int | bool:
    """The value of a feature as its kind has it."""
    return bool(value) if feature.kind is Kind.BOOL else value


def changes(model: SketchModel, before: Values, after: Values) -> list[str]:
    """How feature values differ: `m: 7 -> 6`, `H: false -> true`."""
    found = []
    for feature, old, new in zip(model.features, before, after, strict=True):
        if old != new:
            a, b = (_word(shown_value(feature, value)) for value in (old, new))
            found.append(f"{feature.name}: {a} -> {b}")
    return found


def _word(value: int | bool) -> str:
    return str(value).lower()


def rule_lines(rules: tuple[RuleAt, ...]) -> list[str]:
    """For each rule whether it applies, and by what conditions; what it asks for if it does."""
    lines = []
    for rule in rules:
        if rule.applies:
            held = ", ".join(map(_condition, rule.conditions)) or "it has no conditions"
            lines.append(f"{rule.name} applies: {held}")
            asked = [
                demand.text for demand in rule.demands if demand.effect != f"{demand.feature}?"
            ]
            lines.append(f"    a subgoal: {', '.join(asked) or 'any state'}")
        else:
            failing = ", ".join(f"{_condition(one)} fails" for one in rule.failing)
            lines.append(f"{rule.name} does not apply: {failing}")
    return lines


def goal_line(conditions: tuple[ConditionAt, ...]) -> str:
    """Whether the goal holds."""
    if all(condition.holds for condition in conditions):
        return f"goal holds: {', '.join(map(_condition, conditions))}"
    failing = ", ".join(f"{_condition(one)} fails" for one in conditions if not one.holds)
    return f"goal does not hold: {failing}"


def _condition(condition: ConditionAt) -> str:
    """`u = 0`, and where that does not tell the value, the value as well."""
    if (
        isinstance(condition.value, bool)
        or condition.text == f"{condition.feature} = {condition.value}"
    ):
        return condition.text
    return f"{condition.text} ({condition.feature} is {condition.value})"


def rule_data(rule: RuleAt) -> dict[str, Any]:
    """A rule as plain data."""
    return {
        "name": rule.name,
        "applies": rule.applies,
        "conditions": [vars(condition) for condition in rule.conditions],
        "demands": [vars(demand) for demand in rule.demands],
    }
