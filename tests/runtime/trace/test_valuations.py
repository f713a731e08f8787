"""What the page says of a feature is true at the moment at which it says it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sketchlang
from domains.tabletop.scene.worlds import find_world
from runtime.trace.make import trace_of_plan
from runtime.trace.model import Trace
from runtime.trace.sketch import trace_sketch
from runtime.trace.valuations import valuations, values_at
from sketchlang.errors import InputError
from sketchlang.library import built_in_scenes

QUICK = "sorting/3t-02"


def tabletop_scenes() -> list[str]:
    """The built-in scenes in which things are picked and placed."""
    found = []
    for name in built_in_scenes():
        try:
            find_world(name)
        except InputError:
            continue
        found.append(name)
    return found


SCENES = tabletop_scenes()


def traced(scene: str) -> Trace:
    result = sketchlang.plan("pick_and_place", scene, seed=0)
    assert result.solved, result.reason
    world = result.task.task.problem.world
    sketch = trace_sketch(result.sketch)
    return trace_of_plan(result.task.plan.plan, world.scene.world, world.robot, sketch)


@pytest.fixture(scope="module")
def trace() -> Trace:
    return traced(QUICK)


def test_all_families_are_there() -> None:
    families = {scene.partition("/")[0] for scene in SCENES}
    assert families >= {
        "sorting",
        "words",
        "non_monotonic",
        "kitchen",
        "desk",
        "stack",
        "warehouse",
    }


def disagreements(trace: Trace) -> list[float]:
    """The tenths of seconds at which H is not whether something is held."""
    found = valuations(trace)
    objects = range(len(trace.world.movables))
    return [
        float(time)
        for time in np.arange(0, trace.duration, 0.1)
        if values_at(found, time)["H"] != any(trace.held_at(i, time) for i in objects)
    ]


@pytest.mark.parametrize(
    "scene", [QUICK, *(pytest.param(s, marks=pytest.mark.slow) for s in SCENES if s != QUICK)]
)
def test_h_is_whether_something_is_held(scene) -> None:
    assert disagreements(traced(scene)) == []


def test_without_values_of_actions_the_ends_of_subgoals_serve(trace) -> None:
    """As in plans that were written before actions had values."""
    bare = replace(trace, actions=tuple(replace(a, values=None) for a in trace.actions))
    assert all(action.values is not None for action in trace.actions)
    assert disagreements(bare) == []


def test_changes_are_pending_before_they_come(trace) -> None:
    for valuation in valuations(trace):
        assert valuation.begun <= valuation.time
    grips = {grip.time for grip in trace.grips}
    changes = {v.time for v in valuations(trace) if v.begun < v.time}
    assert grips <= changes


def test_the_last_values_are_those_of_the_last_subgoal(trace) -> None:
    assert values_at(valuations(trace), trace.duration) == trace.subgoals[-1].after


def test_a_trace_without_subgoals_has_no_values(trace) -> None:
    assert values_at(valuations(replace(trace, subgoals=(), actions=())), 1.0) == {}
