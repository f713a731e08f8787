"""Grounding, successors and goals against PDDL's semantics on the texts themselves."""

from __future__ import annotations

import random
from itertools import product

import numpy as np
import pytest

from domains.pddl import replay
from domains.pddl.ground.task import ground
from domains.pddl.interface import make_interface
from domains.pddl.plan import step_of
from domains.pddl.problem import PddlProblem
from domains.pddl.state import State, atom_texts
from domains.pddl.syntax.model import PddlTask
from domains.pddl.syntax.read import read_domain, read_task
from runtime.search.limits import Limits
from runtime.solve import solve
from sketchlang.compile import compile_sketch
from sketchlang.loader import load_text
from sketchlang.source import Source
from tests.pddl.random_tasks import texts

STATES = 12
"""So many states of each task are compared."""


def task_of(seed: int) -> PddlTask:
    """A random task."""
    domain, task = texts(seed)
    return read_task(Source("task", task), read_domain(Source("domain", domain)))


def facts_of(state: State, task: PddlTask) -> replay.State:
    """A state as the replay has it: with what never changes."""
    changing = task.domain.changing()
    static = {fact for fact in task.init if fact[0] not in changing}
    moving = {tuple(text.strip("()").split()) for text in atom_texts(state)}
    return frozenset(static | moving)


def successors_by_text(task: PddlTask, state: replay.State) -> set[tuple[str, replay.State]]:
    """All applicable actions and where they lead, by trying all objects for all parameters."""
    found = set()
    for action in task.domain.actions:
        members = [tuple(task.members(parameter.types)) for parameter in action.parameters]
        for values in product(*members):
            binding = {p.name: v for p, v in zip(action.parameters, values, strict=True)}
            if replay.holds(task, state, action.precondition, binding):
                name = f"({' '.join((action.name, *values))})"
                found.add((name, replay.after(task, state, action, binding)))
    return found


def compare(seed: int) -> None:
    """A random walk through a task, both ways."""
    task = task_of(seed)
    problem = PddlProblem(ground(task))
    state, rng = problem.initial, random.Random(seed)
    for _ in range(STATES):
        facts = facts_of(state, task)
        followers = list(problem.successors(state))
        ours = {(operator.name, facts_of(after, task)) for operator, after in followers}
        assert ours == successors_by_text(task, facts)
        assert problem.task.is_goal(state.bits) == replay.holds(task, facts, task.goal, {})
        if not followers:
            break
        state = rng.choice(followers)[1]


@pytest.mark.parametrize("block", range(6))
def test_successors_and_goals(block: int) -> None:
    for seed in range(block * 15, block * 15 + 15):
        compare(seed)


@pytest.mark.slow
def test_successors_and_goals_of_a_thousand_tasks() -> None:
    for seed in range(1000, 2000):
        compare(seed)


def test_a_walk_is_a_valid_plan() -> None:
    """What the search would return is accepted by the replay, up to the goal."""
    for seed in range(20):
        task = task_of(seed)
        problem = PddlProblem(ground(task))
        state, rng, steps = problem.initial, random.Random(seed), []
        for _ in range(5):
            followers = list(problem.successors(state))
            if not followers:
                break
            operator, state = rng.choice(followers)
            steps.append(step_of(operator.name))
        verdict = replay.replay(task, steps)
        assert verdict.valid == problem.task.is_goal(state.bits)
        assert all(finding.action is None for finding in verdict.findings)


def test_of_all_steps_with_all_objects_those_that_apply_are_accepted() -> None:
    """Objects of other types, and wrong numbers of them, too; the grounding says which apply."""
    seen = set()
    for seed in range(25):
        task = task_of(seed)
        problem = PddlProblem(ground(task))
        applicable = {operator.name for operator, _ in problem.successors(problem.initial)}
        names = sorted(thing.name for thing in task.objects)
        for action in task.domain.actions:
            count = len(action.parameters)
            given = [*product(names, repeat=count), (*names, *names)[: count + 1]]
            for values in given:
                step = step_of(f"({' '.join((action.name, *values))})")
                refused = any(f.action == 0 for f in replay.replay(task, [step]).findings)
                name = f"({' '.join((action.name, *values))})"
                assert refused == (name not in applicable), name
                seen.add(refused)
    assert seen == {True, False}


def test_a_wrong_plan_is_refused() -> None:
    task = task_of(3)
    verdict = replay.replay(task, [step_of("(fly box0)")])
    assert [f.message for f in verdict.findings] == ["there is no action `fly`"]


SEARCHED = 400
"""So many states of a task are looked at by its text."""


def reachable_goal(task: PddlTask) -> bool | None:
    """Whether the text of a task has a way to its goal; None where the states are too many."""
    queue, seen = [task.init], {task.init}
    for state in queue:
        if replay.holds(task, state, task.goal, {}):
            return True
        for _, after in successors_by_text(task, state):
            if after not in seen:
                seen.add(after)
                queue.append(after)
        if len(queue) > SEARCHED:
            return None
    return False


def plan(seed: int) -> bool:
    """Plan for a random task without knowledge of its domain; whether there was a plan."""
    task = task_of(seed)
    interface = make_interface(task.domain)
    text = """
        sketch blind use "d.pddl" feature g : nat = open_goals goal { g = 0 }
        rule one { g > 0 } -> { g-- } rule all { g > 0 } -> { g? }
    """
    checked = load_text(Source("s", text), {}, interface).checked
    problem = PddlProblem(ground(task))
    limits = Limits(k_max=2)
    outcome = solve(compile_sketch(checked), problem, limits, np.random.default_rng(0))
    steps = [step_of(action.name) for subgoal in outcome.subgoals for action in subgoal.actions]
    assert replay.replay(task, steps).valid == outcome.solved
    if problem.task.unreachable:
        assert not outcome.solved
    reachable = reachable_goal(task) if not outcome.solved or seed % 10 == 0 else None
    if reachable is False:
        assert not outcome.solved
    if reachable:
        assert not problem.task.unreachable
    return outcome.solved


def test_plans_are_valid_and_what_is_called_unreachable_is() -> None:
    assert sum(map(plan, range(40))) > 5


@pytest.mark.slow
def test_plans_of_a_thousand_tasks() -> None:
    assert sum(map(plan, range(1000, 2000))) > 100
