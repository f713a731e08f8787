"""A rule whose subgoal was not found: what the nearest state does that its effects forbid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from runtime.search.retrospect import Deviation, Miss
from sketchlang.analysis.words import effect, listed
from sketchlang.model import Effect, Kind, Rule, SketchModel

Finding = dict[str, Any]


def finding_of(
    model: SketchModel, miss: Miss, before: Sequence[int], done: str, helps: bool = False
) -> Finding:
    """The finding about a near miss; `done` are its actions in words, empty where they are not
    known. `helps`: it was tried that the effects of `cured` lead to the goal."""
    rule = model.rules[miss.rule]
    idle = miss.is_idle and not helps
    text = _idle(model, rule, miss) if idle else _sentence(model, miss, before, done)
    if helps:
        anything = listed([f"`{effect(model, d.feature, Effect.ANY)}`" for d in miss.wrong])
        text += f"; with {anything} the run reaches the goal"
    return {
        "rule": rule.name,
        "cause": "not reached" if idle else "effect",
        "text": text,
        "actions": done,
        "tested": helps,
        "wrong": [
            {
                "feature": model.features[d.feature].name,
                "before": d.before,
                "after": d.after,
                "effect": None if d.effect is None else effect(model, d.feature, d.effect),
                "write": _instead(model, d),
            }
            for d in miss.wrong
        ],
    }


def cured(model: SketchModel, miss: Miss) -> SketchModel | None:
    """The sketch in which a near miss is a subgoal, since what its rule forbids there may be; None
    where the rule would have nothing left that it asks for, or no actions are known."""
    rule = model.rules[miss.rule]
    wrong = {deviation.feature: Effect.ANY for deviation in miss.wrong}
    asked = [f for f, kind in rule.effects.items() if kind is not Effect.ANY and f not in wrong]
    if not miss.executable or not asked:
        return None
    rules = list(model.rules)
    rules[miss.rule] = replace(rule, effects={**rule.effects, **wrong})
    return replace(model, rules=tuple(rules))


def _sentence(model: SketchModel, miss: Miss, before: Sequence[int], done: str) -> str:
    rule = model.rules[miss.rule]
    gives = _gives(model, rule, before, miss.after)
    changes = listed([_change(model, d) for d in miss.wrong])
    forbids = listed([_demand(model, d) for d in miss.wrong])
    write = listed([" or ".join(f"`{w}`" for w in _instead(model, d)) for d in miss.wrong])
    subject = f"`{done}`" if done else "the nearest state"
    given = f" gives {gives}, but it" if gives else ""
    return f"{subject}{given} {changes}, and {rule.name} {forbids}: write {write}"


def _gives(model: SketchModel, rule: Rule, before: Sequence[int], after: Sequence[int]) -> str:
    """What a state does that the rule asks for."""
    found = []
    for feature, kind in sorted(rule.effects.items()):
        name = model.features[feature].name
        if before[feature] == after[feature] or not kind.allows(before[feature], after[feature]):
            continue
        if kind in (Effect.SET, Effect.CLEAR):
            found.append(effect(model, feature, kind))
        elif kind in (Effect.DEC, Effect.INC):
            found.append(f"{'lower' if kind is Effect.DEC else 'higher'} {name}")
    return listed(found)


def _change(model: SketchModel, deviation: Deviation) -> str:
    name = model.features[deviation.feature].name
    if model.features[deviation.feature].kind is Kind.BOOL:
        if deviation.before == deviation.after:
            return f"leaves {name} {'true' if deviation.after else 'false'}"
        return f"makes {name} {'true' if deviation.after else 'false'}"
    if deviation.before == deviation.after:
        return f"leaves {name} at {deviation.after}"
    return f"changes {name} from {deviation.before} to {deviation.after}"


def _demand(model: SketchModel, deviation: Deviation) -> str:
    name = model.features[deviation.feature].name
    match deviation.effect:
        case None:
            return f"keeps {name}"
        case Effect.NOT_INC:
            return f"does not let {name} rise"
        case Effect.NOT_DEC:
            return f"does not let {name} fall"
        case other:
            return f"asks for `{effect(model, deviation.feature, other)}`"


def _instead(model: SketchModel, deviation: Deviation) -> list[str]:
    """Effects that allow the change: one that says what happens, and the one for anything."""
    feature, before, after = deviation.feature, deviation.before, deviation.after
    found = []
    if model.features[feature].kind is Kind.BOOL:
        found.append(effect(model, feature, Effect.SET if after else Effect.CLEAR))
    elif before != after:
        found.append(effect(model, feature, Effect.DEC if after < before else Effect.INC))
    return [*found, effect(model, feature, Effect.ANY)]


def _idle(model: SketchModel, rule: Rule, miss: Miss) -> str:
    """What no state does that the rule asks for."""
    wanted = [d for d in miss.wrong if d.is_idle]
    said = []
    for deviation in wanted:
        name = model.features[deviation.feature].name
        match deviation.effect:
            case Effect.DEC:
                said.append(f"{name} falls")
            case Effect.INC:
                said.append(f"{name} rises")
            case Effect.SET:
                said.append(f"{name} becomes true")
            case _:
                said.append(f"{name} becomes false")
    others = ", with the rest as the rule says," if len(rule.effects) > 1 else ""
    return f"{rule.name}: no state was found in which {listed(said)}{others}".rstrip(",")
