"""What a sketch that does not terminate would need: assumptions about its features, or fairness."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from sketchlang.analysis.changes import as_words
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.repair import Proposal, assumed, find_repairs
from sketchlang.analysis.words import listed, rule_names
from sketchlang.model import SketchModel

MOST = 5
"""Sets of assumptions that are named."""

SECONDS = 5.0
"""Time to look for assumptions where there is no other limit."""


def sufficient_assumptions(model: SketchModel, budget: Budget) -> tuple[Proposal, ...]:
    """Bounds and invariants of one or two literals that suffice, fewest and weakest first."""
    limits = budget.within(SECONDS)
    return find_repairs(model, limits, MOST, lambda cycle: assumed(model, cycle)).proposals


def assumptions_text(model: SketchModel, found: Sequence[Proposal]) -> list[str]:
    """The assumptions for people."""
    if not found:
        return ["", "No bounds and short invariants were found under which it would terminate."]
    lines = ["", "It would terminate if one of these is true of its features:"]
    for proposal in found:
        words = [as_words(model, change) for change in proposal.changes]
        lines.append(f"- {listed(words)}")
    return lines


def assumptions_json(model: SketchModel, found: Sequence[Proposal]) -> list[list[str]]:
    """The assumptions for programs: each set as phrases."""
    return [[as_words(model, change) for change in proposal.changes] for proposal in found]


def fair_text(model: SketchModel, fair: Collection[int]) -> list[str]:
    """The verdict that fairness makes the difference."""
    names = listed(rule_names(model, sorted(fair)))
    verb = "is" if len(fair) == 1 else "are"
    return [
        f"{model.name} terminates if {names} {verb} fair (proved by Sieve on all valuations).",
        "",
        "Fair means: a run that uses such a rule again and again in a valuation sees all that the "
        "rule may lead to from there again and again. Without that it does not terminate.",
    ]


def fair_json(model: SketchModel, fair: Collection[int]) -> dict[str, Any]:
    """The same for programs. There is no certificate of it."""
    return {
        "verdict": "terminating",
        "sketch": model.name,
        "method": "fairness",
        "features": len(model.features),
        "rules": len(model.rules),
        "fair": rule_names(model, sorted(fair)),
        "argument": fair_text(model, fair),
        "certificate": None,
    }
