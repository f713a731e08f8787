"""Whether a plan is a run of its sketch: features, rules and goal, computed anew.

The domain says what its actions make of the world: feature values, and where bodies are, at the
start and after each subgoal. Where they are has to be where the motions put them, so that the
features are those of what the robot does and not of what the plan calls it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runtime.judge.replay import Replay
from runtime.plan.model import Plan
from runtime.world.poses import Floats
from sketchlang.model import SketchModel

GOAL = "goal"
"""Stands for the name of a rule where a subplan ends in a goal state that no rule leads to."""

AWAY = 0.002
"""Metres (and with it, 5 times as many radians) by which a body may be elsewhere."""


@dataclass(frozen=True, eq=False)
class Moment:
    """Feature values by name, and the world poses (4, 4) of bodies by name, None for one that
    is held, or stands on one that is."""

    values: Mapping[str, int]
    poses: Mapping[str, Floats | None]


def moment_faults(moments: Sequence[Moment], seen: Sequence[Moment]) -> Iterator[str]:
    """Where the domain's poses are not those of the motions (whose values count for nothing)."""
    for number, (told, found) in enumerate(zip(moments, seen, strict=False)):
        for name, pose in found.poses.items():
            other = told.poses.get(name)
            if (pose is None) != (other is None):
                yield f"after subgoal {number}, {name} is held by its actions or motions, not both"
            elif pose is not None and other is not None:
                off = float(np.linalg.norm(pose[:3, 3] - other[:3, 3]))
                turned = float(np.abs(pose[:3, :3] - other[:3, :3]).max())
                if off > AWAY or turned > 5 * AWAY:
                    yield (
                        f"after subgoal {number}, {name} is {1000 * off:.1f} mm from where its "
                        "action puts it"
                    )


def run_faults(plan: Plan, model: SketchModel, moments: Sequence[Moment]) -> Iterator[str]:
    """What of a plan is no run of a sketch; `moments` are the start and those after each
    subgoal."""
    if plan.sketch != model.name:
        yield f"the plan was made with the sketch {plan.sketch}, not {model.name}"
        return
    names = [feature.name for feature in model.features]
    rules = {rule.name: rule for rule in model.rules}
    vectors = [tuple(moment.values[name] for name in names) for moment in moments]
    for number, subgoal in enumerate(plan.subgoals, 1):
        before, after = vectors[number - 1], vectors[number]
        for said, is_so in ((subgoal.before, before), (subgoal.after, after)):
            for name, value in zip(names, is_so, strict=True):
                if said.get(name) != value:
                    yield f"subgoal {number}: {name} is {value}, the plan says {said.get(name)}"
            for name in said.keys() - set(names):
                yield f"subgoal {number}: the sketch has no feature {name}"
        rule = rules.get(subgoal.rule)
        if subgoal.rule == GOAL and rule is None:
            if not model.is_goal(after):
                yield f"subgoal {number} does not end in a goal state"
        elif rule is None:
            yield f"subgoal {number}: the sketch has no rule {subgoal.rule}"
        elif not rule.satisfied_by(before, after):
            yield f"subgoal {number} does not satisfy the rule {subgoal.rule}"
    if vectors and not model.is_goal(vectors[-1]):
        yield "the plan does not end in a goal state of the sketch"


class Snapshots:
    """Collects where bodies are after each subgoal while a plan is replayed."""

    def __init__(self, plan: Plan) -> None:
        self.ends = {action.subgoal: i for i, action in enumerate(plan.actions)}
        self.moments: list[Moment] = []
        self.subgoals = len(plan.subgoals)

    def __call__(self, number: int, replay: Replay) -> None:
        """Called after each action."""
        if not self.moments:
            start = {thing.name: _matrix(thing.pose) for thing in replay.world.movables}
            self.moments.append(Moment({}, start))
        names = [thing.name for thing in replay.world.movables]
        while len(self.moments) <= self.subgoals:
            end = self.ends.get(len(self.moments) - 1)
            if end is not None and end > number:
                break
            poses = {name: replay.poses.get(i) for i, name in enumerate(names)}
            self.moments.append(Moment({}, poses))


def _matrix(pose: Floats) -> Floats:
    return np.vstack([pose, [0.0, 0.0, 0.0, 1.0]])
