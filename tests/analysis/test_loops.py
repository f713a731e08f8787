"""Long cycles as nested loops say the same as the cycles."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.families import FAMILIES
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.loops import Loops, Part, nested_loops
from sketchlang.analysis.refutation_report import as_json, as_lines
from sketchlang.analysis.termination import NonTerminating, decide_termination
from sketchlang.loader import load_text
from sketchlang.source import Source


def expanded(loops: Loops, parts: tuple[Part, ...]) -> list[int]:
    result: list[int] = []
    for part in parts:
        once = expanded(loops, loops.loops[part.number][1]) if part.loop else [part.number]
        result += once * part.times
    return result


def check(rules: list[int]) -> Loops:
    loops = nested_loops(rules, Budget())
    assert expanded(loops, loops.cycle) == rules
    for steps, parts in loops.loops:
        assert len(expanded(loops, parts)) == steps
    return loops


@settings(deadline=None, max_examples=200)
@given(st.lists(st.integers(0, 3), max_size=60))
def test_loops_say_the_same(rules: list[int]) -> None:
    check(rules)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.integers(0, 2), min_size=1, max_size=4), st.integers(2, 9), st.integers(2, 9))
def test_repeats_are_powers(rules: list[int], inner: int, outer: int) -> None:
    loops = check((rules * inner + [7]) * outer)
    assert len(loops.cycle) + sum(len(parts) for _, parts in loops.loops) <= 12


def test_a_long_cycle_is_told_in_a_few_lines() -> None:
    model = load_text(Source("it.sketch", FAMILIES["closed"](12))).checked.model
    verdict = decide_termination(model)
    assert isinstance(verdict, NonTerminating)
    lines = as_lines(model, verdict, lambda rule, span: rule.name)
    text = "\n".join(lines)
    assert len(lines) < 200
    assert "The cycle has 2,048 steps: " in text
    found = as_json(model, verdict, lambda rule, span: rule.name)["counterexample"]
    assert (found["steps"], len(found["cycle"])) == (2048, 40)
    assert len(found["loops"]["loops"]) < 40
