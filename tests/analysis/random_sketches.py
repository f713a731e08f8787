"""Random sketches for tests: few features, all effects, goals, invariants and bounds."""

from __future__ import annotations

import random

from sketchlang.model import (
    And,
    Effect,
    Feature,
    Formula,
    Invariant,
    Kind,
    Literal,
    Not,
    Or,
    Rule,
    SketchModel,
)

BOOL_EFFECTS = (Effect.SET, Effect.CLEAR, Effect.ANY)
NAT_EFFECTS = (Effect.DEC, Effect.DEC, Effect.INC, Effect.NOT_INC, Effect.NOT_DEC, Effect.ANY)


def random_sketch(seed: int, most_features: int = 5) -> SketchModel:
    """The sketch of a seed. About half of them terminate."""
    rng = random.Random(seed)
    features = []
    for f in range(rng.randint(1, most_features)):
        kind = rng.choice((Kind.BOOL, Kind.NAT, Kind.NAT))
        bounded = kind is Kind.NAT and rng.random() < 0.25
        features.append(Feature(f"{'bn'[kind is Kind.NAT]}{f}", kind, bounded))
    count = len(features)
    rules = tuple(
        _rule(rng, f"r{r}", tuple(features)) for r in range(rng.randint(1, min(5, count + 2)))
    )
    goal = None
    if rng.random() < 0.5:
        chosen = rng.sample(range(count), rng.randint(1, min(2, count)))
        goal = {f: rng.random() < 0.4 for f in chosen}
    invariants = tuple(
        Invariant(_formula(rng, count, 2), "made up") for _ in range(rng.choice((0, 0, 0, 1, 2)))
    )
    return SketchModel(f"random{seed}", tuple(features), rules, goal, invariants)


def dense_sketch(seed: int, features: int, rules: int) -> SketchModel:
    """A sketch in which each rule has to change something: most are hard to tell at sight."""
    rng = random.Random(seed)
    kinds = [rng.choice((Kind.BOOL, Kind.NAT)) for _ in range(features)]
    conditions_each, effects_each, raising = rng.choice((0.2, 0.4)), rng.choice((0.1, 0.3)), 0.2
    made = []
    for r in range(rules):
        conditions = {
            f: rng.random() < 0.5 for f in range(features) if rng.random() < conditions_each
        }
        effects: dict[int, Effect] = {}
        for f, kind in enumerate(kinds):
            if rng.random() < effects_each:
                if kind is Kind.BOOL:
                    effects[f] = rng.choice((Effect.SET, Effect.CLEAR))
                elif rng.random() < raising:
                    effects[f] = rng.choice(
                        (Effect.INC, Effect.ANY, Effect.NOT_INC, Effect.NOT_DEC)
                    )
                else:
                    effects[f] = Effect.DEC
        change = rng.randrange(features)
        if kinds[change] is Kind.BOOL:
            conditions[change] = rng.random() < 0.5
            effects[change] = Effect.CLEAR if conditions[change] else Effect.SET
        else:
            effects[change] = Effect.DEC
        for f, effect in effects.items():
            if effect is Effect.DEC:
                conditions[f] = True
        made.append(Rule(f"r{r}", conditions, effects))
    declared = tuple(Feature(f"f{f}", kind) for f, kind in enumerate(kinds))
    goal = {0: False, 1: True} if rng.random() < 0.4 else None
    return SketchModel(f"dense{seed}", declared, tuple(made), goal)


def _rule(rng: random.Random, name: str, features: tuple[Feature, ...]) -> Rule:
    conditions = {f: rng.random() < 0.6 for f in range(len(features)) if rng.random() < 0.45}
    effects = {
        f: rng.choice(BOOL_EFFECTS if feature.kind is Kind.BOOL else NAT_EFFECTS)
        for f, feature in enumerate(features)
        if rng.random() < 0.5
    }
    return Rule(name, conditions, effects)


def _formula(rng: random.Random, count: int, depth: int) -> Formula:
    kind = rng.choice(("literal", "not", "and", "or", "or")) if depth else "literal"
    if kind == "literal":
        return Literal(rng.randrange(count), rng.random() < 0.5)
    if kind == "not":
        return Not(_formula(rng, count, depth - 1))
    parts = tuple(_formula(rng, count, depth - 1) for _ in range(2))
    return And(parts) if kind == "and" else Or(parts)
