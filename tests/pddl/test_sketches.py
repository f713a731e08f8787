"""The sketches of PDDL domains: clean, proved, and good for a plan that the replay accepts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from domains.pddl.search import Look
from runtime.search.guide import Guide
from runtime.search.limits import Limits
from runtime.search.query import Query
from runtime.solve import solve
from sketchlang.analysis.termination import Terminating, decide_termination
from sketchlang.cli.check import findings
from sketchlang.compile import compile_sketch
from sketchlang.loader import load_sketch
from tests.pddl.small_tasks import TASKS

WIDTH_ONE = {
    "childsnack",
    "logistics",
    "gripper",
    "miconic",
    "spanner",
    "tpp",
    "grid",
    "visitall",
    "schedule",
}
"""Those whose subproblems IW(1) solves in every task that was tried."""


@pytest.mark.parametrize("name", sorted(TASKS))
def test_sketch(name: str, tmp_path: Path) -> None:
    loaded = load_sketch(name)
    assert findings(loaded) == []
    assert isinstance(decide_termination(loaded.checked.model), Terminating)
    path = tmp_path / "task.pddl"
    path.write_text(TASKS[name])
    domain = loaded.checked.domain
    assert domain is not None
    assert domain.load is not None
    problem = domain.load(str(path), None)  # type: ignore[arg-type]
    sketch = compile_sketch(loaded.checked)
    k_max = 1 if name in WIDTH_ONE else 2
    outcome = solve(sketch, problem, Limits(k_max=k_max), np.random.default_rng(0))
    assert outcome.solved, outcome.reason
    document = problem.reporting.document(sketch.model, outcome, "siw-r", 0)
    assert document.validate().findings == ()
    # The sketch's own goal says no more and no less than the task's.
    assert sketch.model.is_goal(sketch.evaluate(outcome.state))
    states = [problem.initial, *(state for s in outcome.subgoals for state in s.states)]
    for state in states:
        assert sketch.model.is_goal(sketch.evaluate(state)) == problem.task.is_goal(state.bits)
    guide = Guide(sketch)
    for state in states:
        # Only features that matter are computed, and the rules are the same.
        before = guide.values(state)
        query = Query(guide, None, state, before, 1, Limits())  # type: ignore[arg-type]
        look = Look(query, problem.task)
        for _, after in problem.successors(state)[:50]:
            assert look.rule(after.bits) == guide.fired(before, guide.values(after), after)
    plain = compile_sketch(loaded.checked, plain=True)
    for state in states[:10]:
        assert plain.evaluate(state) == sketch.evaluate(state)
