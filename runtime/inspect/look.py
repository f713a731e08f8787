"""A state on a planner's way, seen through a sketch: features, rules, goal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from runtime.inspect.walk import Walk
from sketchlang.analysis.words import counted
from sketchlang.inspection.explain import Explainer
from sketchlang.inspection.rules import (
    ConditionAt,
    RuleAt,
    conditions_at,
    goal_line,
    rule_data,
    rule_lines,
    rules_at,
)
from sketchlang.inspection.witness import FeatureWitness
from sketchlang.inspection.words import as_data, feature_lines
from sketchlang.version import __version__


@dataclass(frozen=True)
class Look:
    """What a sketch sees after some subgoals.

    `reached` subgoals of the `asked` ones were found; `fired` are their rules. `end` tells why the
    walk ended there, None where it goes on. `is_goal` is what the search goes by: the domain's own
    test where it has one, else the sketch's `goal`.
    """

    asked: int
    reached: int
    fired: tuple[str, ...]
    end: str | None
    features: tuple[FeatureWitness, ...]
    rules: tuple[RuleAt, ...]
    goal: tuple[ConditionAt, ...] | None
    is_goal: bool


def look(walk: Walk, after: int) -> Look:
    """The state after so many subgoals, or where the walk ends before.

    Raises:
        EvaluationError: a function of the domain, or an invariant, breaks its promise.
    """
    reached = walk.reach(after)
    sketch, state = walk.task.sketch, walk.state(reached)
    model, values = sketch.model, sketch.evaluate(state)
    goal = None if model.goal is None else conditions_at(model, model.goal, values)
    is_goal = sketch.goal_test(state) if sketch.goal_test else model.is_goal(values)
    return Look(
        asked=after,
        reached=reached,
        fired=tuple(subgoal.rule for subgoal in walk.outcome.subgoals[:reached]),
        end=ending(walk, reached),
        features=Explainer(walk.task.checked).features(state),
        rules=rules_at(model, values),
        goal=goal,
        is_goal=is_goal,
    )


def ending(walk: Walk, number: int) -> str | None:
    """Why the walk ended after so many subgoals, in a sentence; None where it is not known to."""
    if not walk.ended or number < walk.known:
        return None
    if walk.outcome.solved:
        return "the goal is reached"
    return walk.outcome.reason


def where(number: int) -> str:
    """`at the start`, `after 3 subgoals`."""
    return f"after {counted(number, 'subgoal')}" if number else "at the start"


def look_lines(seen: Look) -> list[str]:
    """A look as lines of text."""
    lines = []
    if seen.fired:
        lines += [f"fired so far: {', '.join(seen.fired)}", ""]
    if seen.reached < seen.asked:
        lines += [f"the run ends {where(seen.reached)}: {seen.end}", ""]
    lines.append("features")
    for feature in seen.features:
        lines += [f"  {line}" for line in feature_lines(feature)]
    lines += ["", "rules"]
    lines += [f"  {line}" for line in rule_lines(seen.rules)] or ["  there are none"]
    lines += ["", *goal_lines(seen)]
    return lines


def goal_lines(seen: Look) -> list[str]:
    """Whether the goal holds, by the sketch and by the domain."""
    lines = [] if seen.goal is None else [goal_line(seen.goal)]
    by_sketch = seen.goal is not None and all(condition.holds for condition in seen.goal)
    if seen.goal is None or by_sketch != seen.is_goal:
        lines.append(f"the task's own goal {'holds' if seen.is_goal else 'does not hold'}")
    applicable = [rule.name for rule in seen.rules if rule.applies]
    if not seen.is_goal:
        what = f"a subgoal of {' or '.join(applicable)}, or a goal state" if applicable else ""
        lines.append(f"the search looks for {what or 'a goal state: no rule applies'}")
    return lines


def look_data(walk: Walk, seen: Look) -> dict[str, Any]:
    """A look as plain data."""
    task = walk.task
    return {
        "sketch": task.sketch.model.name,
        "scene": task.scene,
        "seed": task.seed,
        "asked": seen.asked,
        "after": seen.reached,
        "fired": list(seen.fired),
        "end": seen.end,
        "features": [
            {
                "name": feature.name,
                "kind": feature.kind,
                "value": bool(feature.value) if feature.kind == "bool" else feature.value,
                "definition": feature.definition,
                "because": as_data(feature.because),
            }
            for feature in seen.features
        ],
        "rules": [rule_data(rule) for rule in seen.rules],
        "applicable": [rule.name for rule in seen.rules if rule.applies],
        "goal": {
            "holds": seen.is_goal,
            "conditions": [vars(condition) for condition in seen.goal or ()],
        },
        "version": __version__,
    }
