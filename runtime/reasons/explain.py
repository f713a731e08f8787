"""The reason for an unsolved outcome, in one sentence, and all findings about it.

Of what is known the surest comes first: a state that came again, no rule, an effect of the sketch
with whose change the rest was solved, what the domain has tested; then subgoals that were there,
near misses, and what the domain only estimates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from runtime.reasons.circle import circle
from runtime.reasons.effects import cured, finding_of
from runtime.reasons.rules import no_rule
from runtime.reasons.width import Families, pruned
from runtime.search.retrospect import Found, look_back
from runtime.search.siw_r import End, Outcome
from sketchlang.model import SketchModel

Finding = dict[str, Any]
Describe = Callable[[Sequence[Any]], str]
Helps = Callable[[SketchModel], bool]
"""Whether a changed sketch solves the rest of the problem, without much ado."""

SAID = 3
"""Findings that a reason tells; all are in the report."""


def explain(
    outcome: Outcome,
    model: SketchModel,
    describe: Describe,
    domain: list[Finding],
    k: int,
    used: Sequence[str] = (),
    offered: Families | None = None,
    helps: Helps = lambda model: False,
) -> None:
    """Write the reason and the findings into an unsolved outcome. `domain` are the findings of
    the domain; `certain` in one of them says that no search would change it. `used` and
    `offered` are the families of atoms of the sketch and of the domain, `k` the largest width."""
    assert outcome.stuck is not None
    sure = [finding for finding in domain if finding.get("certain")]
    # What was tested by planning without some things is sure enough.
    doubted = [f for f in domain if not f.get("certain")]
    tested = [f for f in doubted if f.get("blocking") or f.get("tested")]
    unsure = [f for f in doubted if f not in tested]
    if outcome.end is End.CIRCLE:
        assert outcome.returned_to is not None
        rules = [subgoal.rule for subgoal in outcome.subgoals[outcome.returned_to :]]
        first = circle(model, rules, outcome.returned_to)
        outcome.why = [first, *domain]
        outcome.reason = first["text"]
        return
    if outcome.end is End.NO_RULE:
        first = no_rule(model, outcome.stuck)
        outcome.why = [first, *domain]
        outcome.reason = first["text"]
        return
    searched, nearer = _searched(outcome, model, describe, k, used, offered or {}, helps)
    cures = [f for f in searched + nearer if f.get("tested")]
    searched = [f for f in searched if not f.get("tested")]
    short = [f for f in nearer if not f.get("tested")]
    certain = [f for f in searched if f["cause"] in ("width", "refused")]
    effects = [f for f in searched if f["cause"] == "effect"]
    idle = [f for f in searched if f["cause"] == "not reached"]
    outcome.why = [*cures, *sure, *tested, *short, *certain, *effects, *unsure, *idle]
    if outcome.end is End.TIME or not outcome.why:
        return
    first = outcome.why[0]
    said = outcome.why[:SAID] if first.get("certain") else [first]
    said = [finding for finding in said if finding.get("certain") == first.get("certain")]
    text = "; ".join(finding["text"] for finding in said)
    of_the_sketch = any(first in of for of in (cures, short, certain, effects))
    outcome.reason = text if of_the_sketch else f"{outcome.reason}: {text}"


def _searched(
    outcome: Outcome,
    model: SketchModel,
    describe: Describe,
    k: int,
    used: Sequence[str],
    offered: Families,
    helps: Helps,
) -> tuple[list[Finding], list[Finding]]:
    """What the last search came near to, and what a few actions nearly do where a subgoal takes
    more: that tells more. Where a first search had no end, nothing can be said of what it would not
    have found."""
    assert outcome.stuck is not None
    if outcome.last is None:
        return [], []
    guide, tried = outcome.last
    if outcome.end is End.TIME and len(tried) < 2:
        return [], []
    seen = look_back(guide, tried, outcome.state, outcome.stuck)
    found: list[Finding] = []
    nearer: list[Finding] = []
    narrow: dict[str, int] = {}
    for subgoal in seen.subgoals:
        done = describe(subgoal.actions)
        if subgoal.refusal is None:
            narrow[subgoal.rule] = len(subgoal.actions)
            found.append(pruned(subgoal, outcome.state, done, k, used, offered))
        else:
            found.append(_refused(subgoal, done))
    refused = {subgoal.rule for subgoal in seen.subgoals if subgoal.refusal is not None}
    for miss in seen.misses:
        name = model.rules[miss.rule].name
        if name in refused or (outcome.rejections and not miss.executable):
            continue
        better = 0 < len(miss.actions) < narrow.get(name, 0)
        if name in narrow and not better:
            continue
        done = describe(miss.actions) if miss.actions else ""
        changed = cured(model, miss)
        cure = changed is not None and helps(changed)
        one = finding_of(model, miss, outcome.stuck, done, cure)
        if not better:
            found.append(one)
        elif one["cause"] == "effect":
            nearer.append(one)
    return found, nearer


def _refused(subgoal: Found, done: str) -> Finding:
    assert subgoal.refusal is not None
    refusal = subgoal.refusal
    step = STEPS.get(refusal.step, refusal.step.replace("_", " "))
    what = "the goal" if subgoal.rule == "goal" else f"a subgoal of {subgoal.rule}"
    text = f"{what} was seen (`{done}`), but {step}"
    return {
        "rule": subgoal.rule,
        "cause": "refused",
        "step": refusal.step,
        "object": refusal.about,
        "text": text,
        "actions": done,
    }


STEPS = {
    "in_arm_workspace": "it is beyond the arm's reach",
    "inverse_kinematics": "no posture of the arm reaches it freely",
    "motion_plan": "no motion gets there freely",
}
"""What it means that a step of X refused an action."""
