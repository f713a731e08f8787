"""IW(k) on bits against IW(k) on sets of tuples: both expand as many states."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace
from typing import Any

import pytest

from domains.pddl.breadth import Breadth
from domains.pddl.ground.task import GroundTask, ground
from domains.pddl.novelty import Tuples, atoms_of
from domains.pddl.problem import PddlProblem
from domains.pddl.search import PddlSubproblem
from domains.pddl.state import State, atom_texts
from runtime.search.limits import Limits
from runtime.search.query import Query
from tests.pddl.test_semantics import task_of


def literals(state: State) -> frozenset[str]:
    """The atoms that are true, and the negations of those that something asks to be false."""
    task = state.task
    asked = 0
    for condition in [*(operator.condition for operator in task.operators), *task.goal]:
        asked |= condition.false
    missing = State(asked & ~state.bits, task)
    return frozenset(atom_texts(state)) | {f"not {text}" for text in atom_texts(missing)}


def expanded(problem: PddlProblem, k: int) -> int:
    """How many states IW(k) expands that looks for nothing."""

    def tuples(state: State) -> set[Any]:
        found = sorted(literals(state))
        return {c for size in range(1, k + 1) for c in combinations(found, size)}

    seen, queue, known = tuples(problem.initial), [problem.initial], {problem.initial}
    for state in queue:
        for _, after in problem.successors(state):
            new = tuples(after)
            if not new <= seen:
                seen |= new
                if after not in known:
                    known.add(after)
                    queue.append(after)
    return len(queue)


def everything(state: State) -> Any:
    """All atoms, by their bits."""
    return (bit for bit in range(state.task.layout.size) if state.bits >> bit & 1)


def looking_for(wanted: int | None) -> Any:
    """A guide for which one state is a subgoal, or none."""
    return SimpleNamespace(
        sketch=SimpleNamespace(atoms=(everything,), evaluate=None),
        values=lambda state: (),
        fired=lambda before, after, state: "r" if state.bits == wanted else None,
    )


def query(task: GroundTask, wanted: int | None, k: int) -> Query:
    return Query(looking_for(wanted), None, State(task.initial, task), (), k, Limits())  # type: ignore[arg-type]


@pytest.mark.parametrize("k", [1, 2, 3])
def test_as_many_states_are_expanded(k: int) -> None:
    for seed in range(40 if k < 3 else 8):
        problem = PddlProblem(ground(task_of(seed)))
        asked = query(problem.task, None, k)
        assert PddlSubproblem(problem.task, problem.generator, 0).search(asked) is None
        assert asked.effort.expanded == expanded(problem, k), seed


def test_a_state_one_step_away_is_found_whether_it_has_anything_new_or_not() -> None:
    for seed in range(40):
        problem = PddlProblem(ground(task_of(seed)))
        subproblem = PddlSubproblem(problem.task, problem.generator, 0)
        for operator, after in problem.successors(problem.initial):
            if after == problem.initial:
                continue  # it leads nowhere
            found = subproblem.search(query(problem.task, after.bits, 1))
            assert found is not None
            steps, rule = found
            assert rule == "r"
            assert steps[-1][2] == after
            assert len(steps) == 1, operator


@pytest.mark.parametrize("k", [1, 2])
def test_the_kernel_keeps_the_states_that_the_plain_way_keeps(k: int) -> None:
    """In the same order, each with the same operator and as many tried."""
    for seed in range(40):
        problem = PddlProblem(ground(task_of(seed)))
        task, generator = problem.task, problem.generator
        atoms = atoms_of((everything,), task)
        breadth = Breadth(generator, atoms, k, task.initial)
        found: list[int] = []
        while breadth.head < breadth.tail:
            found += breadth.grow(1 + seed % 7)
        table, queue, tried = Tuples(k), [task.initial], 0
        table.add(atoms.literals(task.initial), atoms.literals(task.initial))
        for place, bits in enumerate(queue):
            for number in generator.numbers(bits):
                tried += 1
                after = generator.operators[number].apply(bits)
                now = atoms.literals(after)
                if table.add(now, now - atoms.literals(bits)):
                    assert breadth.origin[len(queue)].tolist() == [place, number, tried]
                    queue.append(after)
        assert found == queue[1:]
        assert breadth.tried == tried
        for number in range(1, len(queue)):
            bits = task.initial
            for operator, after in breadth.path(number):
                bits = generator.operators[operator].apply(bits)
                assert bits == after
            assert bits == queue[number]
