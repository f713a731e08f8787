"""The planners on classical domains; every plan is replayed without the search's code."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runtime.search.classical import ClassicalProblem
from runtime.search.guide import GOAL
from runtime.search.limits import Limits
from runtime.search.planners import DEFAULT, PLANNERS, SEARCHES
from runtime.search.siw_r import Outcome
from runtime.solve import open_task
from sketchlang.compile import CompiledSketch, compile_sketch
from sketchlang.domain import LoadOptions
from sketchlang.errors import InputError
from sketchlang.library import built_in_scenes, find_scene
from sketchlang.loader import load_sketch

SCENES = [name for name in built_in_scenes() if name.startswith("delivery/")]
PLANNERS_ONE_BY_ONE = pytest.mark.parametrize("planner", sorted(SEARCHES))


def load(sketch: str, scene: str) -> tuple[CompiledSketch, Any]:
    checked = load_sketch(sketch).checked
    path, name = find_scene(scene)
    assert checked.domain is not None
    assert checked.domain.load is not None
    return compile_sketch(checked), checked.domain.load(str(path), LoadOptions(name))


def solve(planner: str, sketch: CompiledSketch, problem: Any, limits: Limits) -> Outcome:
    rng = np.random.default_rng(0)
    return PLANNERS[planner](sketch, ClassicalProblem(problem), limits, rng)


@PLANNERS_ONE_BY_ONE
@pytest.mark.parametrize("scene", SCENES)
def test_plans_replay_to_the_goal(planner, scene) -> None:
    sketch, problem = load("delivery_policy", scene)
    outcome = solve(planner, sketch, problem, Limits(timeout=60))
    assert outcome.solved
    state = problem.initial
    for subgoal in outcome.subgoals:
        before = sketch.evaluate(state)
        assert subgoal.before == before
        for action, expected in zip(subgoal.actions, subgoal.states, strict=True):
            state = dict(problem.successors(state))[action]
            assert state == expected
        after = sketch.evaluate(state)
        assert subgoal.after == after
        if subgoal.rule == GOAL:
            assert sketch.model.is_goal(after)
        else:
            rule = next(r for r in sketch.model.rules if r.name == subgoal.rule)
            assert rule.satisfied_by(before, after)
    assert sketch.model.is_goal(sketch.evaluate(state))


@PLANNERS_ONE_BY_ONE
def test_the_same_seed_gives_the_same_actions(planner) -> None:
    sketch, problem = load("delivery_policy", SCENES[0])
    one, two = (solve(planner, sketch, problem, Limits()) for _ in range(2))
    assert [s.actions for s in one.subgoals] == [s.actions for s in two.subgoals]


@PLANNERS_ONE_BY_ONE
def test_time_that_is_over_ends_the_search_with_a_reason(planner) -> None:
    sketch, problem = load("delivery_policy", SCENES[0])
    outcome = solve(planner, sketch, problem, Limits(timeout=0.0))
    assert not outcome.solved
    assert "time limit" in (outcome.reason or "")
    assert outcome.stuck == sketch.evaluate(problem.initial)


@pytest.mark.parametrize("planner", sorted(SEARCHES))
def test_a_state_that_no_rule_provides_for_ends_the_search_with_a_reason(
    planner, tmp_path: Path
) -> None:
    """A sketch whose only rule never applies, and whose goal no search of width 1 finds."""
    text = Path(find_sketch("delivery_policy")).read_text(encoding="utf-8")
    head, _, _ = text.partition("rule ")
    stuck = tmp_path / "stuck.sketch"
    stuck.write_text(head, encoding="utf-8")
    sketch, problem = load(str(stuck), SCENES[0])
    outcome = solve(planner, sketch, problem, Limits(k_max=1))
    assert not outcome.solved
    assert outcome.reason
    assert outcome.subgoals == []


def find_sketch(name: str) -> str:
    return load_sketch(name).source.name


def test_the_default_planner_is_one_of_them() -> None:
    assert DEFAULT in PLANNERS


@pytest.mark.parametrize("answer", [[5], None, [("only one",)], RuntimeError("boom")])
def test_successors_that_break_their_promise_are_named(answer) -> None:
    class Broken:
        initial = 0

        def successors(self, state):
            if isinstance(answer, Exception):
                raise answer
            return answer

    subproblem = ClassicalProblem(Broken()).subproblem(0, 0, np.random.default_rng(0))
    with pytest.raises(InputError, match="successors"):
        subproblem.actions(0)


def test_a_loader_that_returns_nothing_is_named() -> None:
    checked = load_sketch("delivery_policy").checked
    assert checked.domain is not None
    domain = replace(checked.domain, load=lambda path, options: None)
    with pytest.raises(InputError, match="NoneType"):
        open_task(replace(checked, domain=domain), SCENES[0])
