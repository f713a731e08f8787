"""Follows a counterexample with concrete numbers, under the rules' own semantics."""

from __future__ import annotations

from itertools import pairwise

from sketchlang.analysis.termination import NonTerminating
from sketchlang.model import Effect, Kind, SketchModel, holds

KEEPS_UP = (None, Effect.INC, Effect.NOT_DEC)
"""Effects on a nat of which any number can follow, each from the value of the last."""


def replay(model: SketchModel, verdict: NonTerminating) -> None:
    """Asserts that the run can be repeated for ever, step by step."""
    values = verdict.run.values
    assert len(values) == len(verdict.walk) + 1 > 1
    for move, (before, after) in zip(verdict.walk, pairwise(values), strict=True):
        assert model.rules[move.rule].satisfied_by(before, after)
        assert all(value >= 0 for value in before)
    for state in values:
        assert not model.is_goal(state)
        assert all(holds(invariant.formula, state) for invariant in model.invariants)
    for f, feature in enumerate(model.features):
        first, last = values[0][f], values[-1][f]
        if f in verdict.run.growing:
            # From the higher number the same steps are possible, shifted: it is never 0,
            # and nothing on the cycle asks it to fall.
            assert first < last
            assert feature.kind is Kind.NAT
            assert not feature.bounded
            assert all(state[f] > 0 for state in values)
            effects = [model.rules[move.rule].effects.get(f) for move in verdict.walk]
            assert all(effect in KEEPS_UP for effect in effects)
        else:
            assert first == last
