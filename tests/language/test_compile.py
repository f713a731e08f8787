"""Evaluators: against the naive interpreter, and at the seam to the domain."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sketchlang.compile import CompiledSketch, EvaluationError, compile_sketch, obstacles
from sketchlang.compile.invariants import truth
from sketchlang.compile.sketch import CAREFUL_STATES
from sketchlang.domain import Domain, Nat
from sketchlang.loader import load_text
from sketchlang.model import And, Formula, Literal, Not, Or, holds
from sketchlang.source import Source
from tests.language import toy
from tests.language.naive import Interpreter


def compiled(text: str, domain: Domain) -> CompiledSketch:
    loaded = load_text(Source("t", text), {domain.name: domain})
    assert loaded.ok, [found.message for found in loaded.diagnostics]
    assert not obstacles(loaded.checked)
    return compile_sketch(loaded.checked)


@settings(max_examples=300, deadline=None)
@given(toy.sketches(), toy.states)
def test_like_the_naive_interpreter(text: str, state: toy.State) -> None:
    loaded = load_text(Source("t", text), {"toy": toy.domain})
    assert loaded.ok, [(found.message, text) for found in loaded.diagnostics]
    sketch = compile_sketch(loaded.checked)
    expected = Interpreter(loaded.tree, toy.domain, state).values()
    # The first states are evaluated with every function called twice, later ones are not.
    for _ in range(CAREFUL_STATES + 1):
        values = sketch.evaluate(state)
        assert values == expected, text
        assert all(type(value) is int for value in values)


def test_common_parts_are_computed_once() -> None:
    text = """
use toy
define heavy(p : Box) = weight(p) + scale(weight(p)) > 2
feature a : nat = count x in boxes: heavy(x)
feature b : nat = sum y in boxes where heavy(y): weight(y) + scale(weight(y))
feature c : bool = all x in boxes: some y in boxes: weight(y) > 0 and raining
"""
    sketch = compiled(text, toy.domain)
    state = toy.State(4, 0, 1)
    for _ in range(CAREFUL_STATES):
        sketch.evaluate(state)
    state.calls = 0
    sketch.evaluate(state)
    # boxes and raining once, weight once a box, scale once a box.
    assert state.calls == 1 + 1 + 4 + 4


def test_long_chains_do_not_recurse() -> None:
    lines = ["use toy", "feature f0 : nat = count x in boxes: open_(x)"]
    lines += [f"feature f{i} : nat = f{i - 1} + 1" for i in range(1, 2000)]
    sketch = compiled("\n".join(lines), toy.domain)
    assert sketch.evaluate(toy.State(0, 0, 0)) == tuple(range(2000))


def test_definitions_that_double() -> None:
    lines = ["use toy", "define d0(p : Box) = weight(p)"]
    lines += [f"define d{i}(p : Box) = d{i - 1}(p) + d{i - 1}(p)" for i in range(1, 25)]
    lines += ["feature n : nat = sum x in boxes: d24(x)"]
    state = toy.State(2, 0, 5)
    single = compiled("use toy\nfeature n : nat = sum x in boxes: weight(x)", toy.domain)
    assert compiled("\n".join(lines), toy.domain).evaluate(state) == (
        single.evaluate(state)[0] << 24,
    )


# What a domain can do wrong.


class Thing:
    def __repr__(self) -> str:
        return "Thing()"


def broken_domain(result: Any) -> Domain:
    """A domain whose functions return what `result` says."""
    domain = Domain("broken")
    domain.sort(Thing)

    @domain.function
    def things(state: Any) -> frozenset[Thing]:
        found: frozenset[Thing] = result(state) if state == "set" else frozenset({THING})
        return found

    @domain.function
    def number(state: Any, thing: Thing) -> Nat:
        return result(state) if state == "nat" else 1

    @domain.function
    def truth(state: Any) -> bool:
        return result(state) if state == "bool" else True

    @domain.function
    def one(state: Any) -> Thing:
        return result(state) if state == "sort" else THING

    return domain


THING = Thing()
SKETCH = """
use broken
feature n : nat = sum x in things: number(x)
feature p : bool = truth and one in things
"""
_answers = iter(range(10**6))


def _raise(_state: Any) -> Any:
    raise ValueError("no such cell")


@pytest.mark.parametrize(
    ("state", "result", "function", "feature", "reason"),
    [
        ("nat", lambda s: -1, "number", "n", "returned -1, expected a number from 0 on"),
        ("nat", lambda s: 1.5, "number", "n", "returned 1.5 of type float"),
        ("nat", lambda s: math.nan, "number", "n", "returned nan of type float"),
        ("nat", lambda s: True, "number", "n", "returned True of type bool"),
        ("nat", lambda s: None, "number", "n", "returned None of type NoneType"),
        ("nat", lambda s: next(_answers), "number", "n", "for the same state"),
        ("nat", _raise, "number", "n", "raised ValueError: no such cell"),
        ("bool", lambda s: 1, "truth", "p", "returned 1 of type int"),
        ("bool", _raise, "truth", "p", "raised ValueError"),
        ("set", lambda s: None, "things", "n", "expected a set of Thing"),
        ("set", lambda s: "Thing", "things", "n", "expected a set of Thing"),
        ("set", lambda s: (t for t in [THING]), "things", "n", "can be read only once"),
        ("set", lambda s: [THING, 3], "things", "n", "a set with 3 in it"),
        ("set", lambda s: [THING, THING], "things", "n", "has an element twice"),
        ("set", lambda s: {Thing()}, "things", "n", "for the same state"),
        ("sort", lambda s: "thing", "one", "p", "expected an instance of sort Thing"),
    ],
)
def test_broken_promises(state: str, result: Any, function: str, feature: str, reason: str) -> None:
    sketch = compiled(SKETCH, broken_domain(result))
    with pytest.raises(EvaluationError) as caught:
        sketch.evaluate(state)
    error = caught.value
    assert (error.function, error.feature, error.state) == (function, feature, state)
    assert reason in error.reason
    assert function in error.expression
    for part in (function, feature, state):
        assert part in str(error)


def test_set_that_changes_while_it_is_read() -> None:
    domain = Domain("shifty")
    domain.sort(Thing)
    shared = {Thing(), Thing()}

    @domain.function
    def things(state: Any) -> set[Thing]:
        return shared

    @domain.function
    def number(state: Any, thing: Thing) -> Nat:
        shared.add(Thing())
        return 1

    sketch = compiled("use shifty\nfeature n : nat = sum x in things: number(x)", domain)
    with pytest.raises(EvaluationError, match=r"feature n.*changed size"):
        sketch.evaluate("s")


def test_a_later_state_is_checked_too() -> None:
    domain = Domain("late")

    @domain.function
    def number(state: Any) -> Nat:
        return 1 if state < 5000 else next(_answers)

    sketch = compiled("use late\nfeature n : nat = number", domain)

    def evaluate_all() -> None:
        for state in range(10000):
            sketch.evaluate(state)

    with pytest.raises(EvaluationError, match="for the same state"):
        evaluate_all()


def test_a_repr_that_fails() -> None:
    class Sullen(str):
        def __repr__(self) -> str:
            raise RuntimeError

    with pytest.raises(EvaluationError, match=r"Sullen whose repr\(\) raises RuntimeError"):
        compiled(SKETCH, broken_domain(lambda s: 0)).evaluate(Sullen("set"))


def test_invariants_are_checked() -> None:
    text = """
use toy
feature n : nat = count x in boxes: true
feature p : bool = n > 2
invariant p -> n = 0
invariant n > 0 -> not p or p
"""
    sketch = compiled(text, toy.domain)
    assert sketch.evaluate(toy.State(2, 0, 0)) == (2, 0)
    with pytest.raises(EvaluationError) as caught:
        sketch.evaluate(toy.State(3, 0, 0))
    assert caught.value.expression == "p -> n = 0"
    assert "n = 3, p = 1" in str(caught.value)


def test_obstacles() -> None:
    loaded = load_text(Source("t", "use toy\nfeature n : nat"), {"toy": toy.domain})
    (found,) = obstacles(loaded.checked)
    assert found.code == "feature-without-definition"
    with pytest.raises(ValueError, match="no definition"):
        compile_sketch(loaded.checked)
    loaded = load_text(Source("t", "feature n : nat = 1"))
    (found,) = obstacles(loaded.checked)
    assert found.code == "no-domain"


def test_atoms() -> None:
    domain = Domain("atomic")

    @domain.atom
    def place(state: Any) -> Iterable[Any]:
        return [("place", state)]

    sketch = compiled("use atomic\natoms place", domain)
    assert [list(family(3)) for family in sketch.atoms] == [[("place", 3)]]


@pytest.mark.parametrize(
    ("result", "reason"),
    [(3, "TypeError"), ([["place"]], "unhashable"), (map(int, ["x"]), "ValueError")],
)
def test_atoms_that_cannot_be_listed(result: Any, reason: str) -> None:
    domain = Domain("atomic")

    @domain.atom
    def place(state: Any) -> Any:
        return result

    (family,) = compiled("use atomic\natoms place", domain).atoms
    with pytest.raises(EvaluationError, match=reason) as caught:
        family(3)
    assert caught.value.function == "place"
    assert caught.value.state == 3


formulas: st.SearchStrategy[Formula] = st.recursive(
    st.builds(Literal, st.integers(0, 3), st.booleans()),
    lambda inner: (
        st.builds(Not, inner)
        | st.builds(And, st.lists(inner, max_size=3).map(tuple))
        | st.builds(Or, st.lists(inner, max_size=3).map(tuple))
    ),
)


@given(formulas, st.tuples(*[st.integers(0, 2)] * 4))
def test_compiled_formulas(formula: Formula, values: tuple[int, ...]) -> None:
    assert truth(formula)(values) == holds(formula, values)
