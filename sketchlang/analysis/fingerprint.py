"""A fingerprint of what termination depends on: features, rules, goal, invariants.

Names of features and rules count, since certificates use them. The sketch's own name, the
texts of invariants, places in the source and feature definitions do not.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

from sketchlang.model import And, Formula, Literal, Not, Or, SketchModel


def fingerprint(model: SketchModel) -> str:
    """`sha256:` and the hash of the model in a canonical form."""
    names = [feature.name for feature in model.features]
    goal = None if model.goal is None else {names[f]: v for f, v in model.goal.items()}
    return digest(
        {
            "features": [[f.name, f.kind.value, f.bounded] for f in model.features],
            "rules": [
                [
                    rule.name,
                    {names[f]: positive for f, positive in rule.conditions.items()},
                    {names[f]: effect.value for f, effect in rule.effects.items()},
                ]
                for rule in model.rules
            ],
            "goal": goal,
            "invariants": [_formula(invariant.formula, names) for invariant in model.invariants],
        }
    )


def digest(value: Any) -> str:
    """`sha256:` and the hash of a JSON value; the order of keys does not matter."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return "sha256:" + hashlib.sha256(text.encode()).hexdigest()


def _formula(formula: Formula, names: list[str]) -> list[Any]:
    match formula:
        case Literal(feature, positive):
            return [names[feature], positive]
        case Not(operand):
            return ["not", _formula(operand, names)]
        case And(operands):
            return ["and", *(_formula(operand, names) for operand in operands)]
        case Or(operands):
            return ["or", *(_formula(operand, names) for operand in operands)]
