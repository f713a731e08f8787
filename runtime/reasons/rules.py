"""No rule applies: the valuation, what `check` says of it, and what the rules ask for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sketchlang.analysis.coverage import find_coverage
from sketchlang.analysis.coverage_report import CHECK_WORK
from sketchlang.analysis.cubes import TooManyCubesError
from sketchlang.analysis.words import cube, listed, literal
from sketchlang.model import Effect, Rule, SketchModel

Finding = dict[str, Any]

NEAR = 2
"""Rules that are named, those that miss by fewest conditions."""


def no_rule(model: SketchModel, values: Sequence[int]) -> Finding:
    """The finding about a state, no goal, for which there is no rule."""
    valuation = sum((value > 0) << f for f, value in enumerate(values))
    whole = cube(model, (1 << len(values)) - 1, valuation)
    missing = {rule.name: _missing(model, rule, values) for rule in model.rules}
    nearest = sorted(missing, key=lambda name: len(missing[name]))[:NEAR]
    fewest = len(missing[nearest[0]]) if nearest else 0
    near = {name: missing[name] for name in nearest if len(missing[name]) == fewest}
    if len(near) > 1 and len(set(map(tuple, near.values()))) == 1:
        asks = [f"{listed(list(near))} both ask for {listed(next(iter(near.values())))}"]
    else:
        asks = [_asks(name, literals) for name, literals in near.items()]
    if model.goal is not None and model.is_goal(tuple(values)):
        text = f"the goal of the sketch holds at {whole}, but that of the task does not"
    else:
        text = f"no rule for {_gap(model, valuation) or whole}"
        if asks and 0 < fewest <= NEAR:
            text += f": {listed(asks)}"
    return {"cause": "no rule", "valuation": whole, "missing": missing, "text": text}


def _gap(model: SketchModel, valuation: int) -> str | None:
    """The valuations without a rule that `check` warns of and that the state is one of."""
    try:
        gaps = find_coverage(model, CHECK_WORK).gaps
    except TooManyCubesError:
        return None
    for gap in gaps:
        if valuation & gap.cube.known == gap.cube.bits:
            return cube(model, *gap.cube)
    return None


def _missing(model: SketchModel, rule: Rule, values: Sequence[int]) -> list[str]:
    """What a rule asks of a state and is not so; a nat that it lowers has to be > 0."""
    needed = {f: True for f, kind in rule.effects.items() if kind is Effect.DEC}
    needed |= rule.conditions
    return [literal(model, f, v) for f, v in sorted(needed.items()) if (values[f] > 0) != v]


def _asks(name: str, literals: Sequence[str]) -> str:
    return f"{name} asks for {listed(literals)}"
