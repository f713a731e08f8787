"""Sketches in one line a rule, for tests that need many: no parser of the language involved.

model("clear", "H", "n", ["!H n>0 -> H n--", "H n>0 -> !H"], goal="n=0")
"""

from __future__ import annotations

from collections.abc import Sequence

from sketchlang.model import Effect, Feature, Kind, Rule, SketchModel


def model(
    name: str,
    booleans: str,
    nats: str,
    rules: Sequence[str],
    *,
    goal: str | None = None,
    bounded: bool = False,
) -> SketchModel:
    """A sketch; names are separated by blanks, and `bounded` is for all of the nats."""
    features = tuple(
        [Feature(name, Kind.BOOL) for name in booleans.split()]
        + [Feature(name, Kind.NAT, bounded) for name in nats.split()]
    )
    index = {feature.name: i for i, feature in enumerate(features)}
    made = []
    for number, text in enumerate(rules, start=1):
        conditions, effects = text.split("->")
        made.append(
            Rule(
                f"r{number}",
                dict(_condition(word, index) for word in conditions.split()),
                dict(_effect(word, index) for word in effects.split()),
            )
        )
    wanted = None if goal is None else dict(_condition(word, index) for word in goal.split())
    return SketchModel(name, features, tuple(made), wanted)


def _condition(word: str, index: dict[str, int]) -> tuple[int, bool]:
    if word.endswith((">0", "=0")):
        return index[word[:-2]], word.endswith(">0")
    return index[word.lstrip("!")], not word.startswith("!")


def _effect(word: str, index: dict[str, int]) -> tuple[int, Effect]:
    name = word.strip("!?+-")
    negated, sign = word.startswith("!"), word.lstrip("!")[len(name) :]
    found = {
        (False, ""): Effect.SET,
        (True, ""): Effect.CLEAR,
        (False, "--"): Effect.DEC,
        (False, "++"): Effect.INC,
        (True, "++"): Effect.NOT_INC,
        (True, "--"): Effect.NOT_DEC,
        (False, "?"): Effect.ANY,
    }
    return index[name], found[negated, sign]
