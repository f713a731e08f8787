"""Witnesses: the value of every expression follows from what its witness says."""

from __future__ import annotations

import itertools
from typing import Any

import pytest
from hypothesis import given, settings

from sketchlang.compile import EvaluationError
from sketchlang.domain import Domain, Nat
from sketchlang.inspection.explain import Explainer
from sketchlang.inspection.rules import conditions_at, rules_at
from sketchlang.inspection.witness import FeatureWitness, Witness
from sketchlang.inspection.words import as_data, feature_lines
from sketchlang.loader import Loaded, load_text
from sketchlang.source import Source
from tests.language import toy
from tests.language.naive import Interpreter


def loaded(text: str, domain: Domain) -> Loaded:
    found = load_text(Source("t", text), {domain.name: domain})
    assert found.ok, [(one.message, text) for one in found.diagnostics]
    return found


def follows(witness: Witness) -> Any:  # noqa: PLR0912 (a case for every kind)
    """The value that a witness's own parts and elements give, by the meaning of its kind."""
    values = [element.value for element in witness.elements]
    parts = [part.value for part in witness.parts]
    match witness.kind:
        case "some":
            return bool(values)
        case "all":
            return not values
        case "count":
            return len(values)
        case "sum":
            return sum(values)
        case "min" | "max" if witness.elements:
            best = min(values) if witness.kind == "min" else max(values)
            assert values[0] == best
            return best
        case "and":
            return all(parts)
        case "or":
            return any(parts)
        case "->":
            return witness.parts[-1].value if len(parts) == 2 or parts[0] else True
        case "not":
            return not parts[0]
        case "+":
            return sum(parts)
        case "=":
            return parts[0] == parts[1]
        case "<":
            return parts[0] < parts[1]
        case "<=":
            return parts[0] <= parts[1]
    return witness.value


def check(witness: Witness) -> None:
    for each in witness.walk():
        assert each.value == follows(each), (each.kind, each.text)
        assert all(element.value == element.because.value for element in each.elements)
        assert each.members >= each.considered >= len(each.elements)


@settings(max_examples=150, deadline=None)
@given(toy.sketches(), toy.states)
def test_values_follow_from_witnesses(text: str, state: toy.State) -> None:
    sketch = loaded(text, toy.domain)
    found = Explainer(sketch.checked).features(state)
    assert tuple(one.value for one in found) == Interpreter(sketch.tree, toy.domain, state).values()
    for feature in found:
        check(feature.because)
        assert as_data(feature.because)["value"] == feature.because.value
        assert feature_lines(feature)


SHARED = """
sketch s
use table
define odd_ones = count x in cells: odd(x)
feature a : nat = sum y in cells: odd_ones + weight(y)
feature b : nat = min y in cells: weight(y)
feature c : nat = max y in cells where odd(y): weight(y) + 1 default 5
feature d : bool = some y in cells: odd_ones = weight(y)
"""


def table() -> Domain:
    """A state is a tuple of numbers, and a cell the place of one."""
    domain = Domain("table")

    @domain.sort
    class Cell(int): ...

    def cells(state: Any) -> frozenset[Cell]:
        return frozenset(map(Cell, range(len(state))))

    def weight(state: Any, c: Cell) -> Nat:
        return int(state[c])

    def odd(state: Any, c: Cell) -> bool:
        return bool(state[c] % 2)

    for function, types in (
        (cells, {"return": frozenset[Cell]}),
        (weight, {"c": Cell, "return": Nat}),
        (odd, {"c": Cell, "return": bool}),
    ):
        function.__annotations__ |= types
        domain.function(function)
    return domain


def test_all_small_states_of_a_sketch_with_shared_variables() -> None:
    """A definition inside a quantifier has a variable of the same level as that one's."""
    domain = table()
    sketch = loaded(SHARED, domain)
    explainer = Explainer(sketch.checked)
    for state in itertools.product(range(4), repeat=3):
        found = explainer.features(state)
        values = Interpreter(sketch.tree, domain, state).values()
        assert tuple(one.value for one in found) == values
        for feature in found:
            check(feature.because)


BLOCKS = """
sketch s
use blocks
feature a : nat = count b in blocks: on+(b, { c in blocks where to_clear(c) or above(c) = 0 })
feature b : bool = { b in blocks where above(b) > 0 } = on(_, blocks)
feature c : bool = blocks <= on(blocks, _)
feature d : nat = distance({ b in blocks where above(b) = 0 }, on, blocks - on(_, blocks))
feature e : nat = if held_any then 1 else max b in blocks: above(b)
define held_any = some b in blocks: held(b)
"""


def blocks(text: str, scene: str) -> tuple[FeatureWitness, ...]:
    from runtime.solve import open_task

    sketch = load_text(Source("t", text))
    assert sketch.ok, [one.message for one in sketch.diagnostics]
    task = open_task(sketch.checked, scene)
    state = task.problem.initial
    found = Explainer(sketch.checked).features(state)
    assert tuple(one.value for one in found) == task.sketch.evaluate(state)
    return found


def test_sets_and_relations_have_witnesses() -> None:
    found = blocks(BLOCKS, "blocks/eight")
    for feature in found:
        for each in feature.because.walk():
            if each.kind not in ("in",):
                assert each.value == follows(each)
    # Something lies on every block but those on top: they are what is missing.
    below = next(feature for feature in found if feature.name == "c").because
    assert below.value is False
    assert below.parts[0].value == ("c", "e", "h")


def test_elements_have_the_names_of_the_domain() -> None:
    domain = Domain("named")

    @domain.sort
    class Ball(int): ...

    @domain.naming
    def name_of(state: Any, element: object) -> str | None:
        return f"ball {element}" if isinstance(element, Ball) else None

    def balls(state: Any) -> frozenset[Ball]:
        return frozenset(map(Ball, range(state)))

    def size(state: Any, b: Ball) -> Nat:
        return int(b)

    balls.__annotations__["return"] = frozenset[Ball]
    size.__annotations__ |= {"b": Ball, "return": Nat}
    domain.function(balls)
    domain.function(size)
    text = "sketch s\nuse named\nfeature n : nat = max b in balls: size(b)\n"
    (feature,) = Explainer(loaded(text, domain).checked).features(3)
    assert [element.name for element in feature.because.elements] == ["ball 2", "ball 0", "ball 1"]
    assert feature.because.elements[0].because.text == "size(ball 2)"
    # What extends a domain keeps its names.
    assert Domain.extend(domain).called(0, Ball(1)) == "ball 1"


def test_an_expression_that_is_shared_without_end_is_cut_off() -> None:
    lines = ["sketch s", "use toy", "define d0(p : Box) = weight(p)"]
    lines += [f"define d{i}(p : Box) = d{i - 1}(p) + d{i - 1}(p)" for i in range(1, 30)]
    lines += ["feature n : nat = sum x in boxes: d29(x)"]
    (feature,) = Explainer(loaded("\n".join(lines), toy.domain).checked).features(
        toy.State(3, 0, 5)
    )
    assert sum(1 for _ in feature.because.walk()) < 2000
    assert sum(map(len, feature_lines(feature))) < 5000


def test_a_broken_promise_is_told() -> None:
    domain = Domain("broken")

    def size(state: Any) -> Nat:
        return -1

    size.__annotations__["return"] = Nat
    domain.function(size)
    text = "sketch s\nuse broken\nfeature n : nat = size\n"
    with pytest.raises(EvaluationError, match="feature n: size returned -1"):
        Explainer(loaded(text, domain).checked).features(0)


RULES = """
sketch s
feature H : bool
feature n : nat
feature m : nat
goal { !H, n = 0 }
rule a { !H, n > 0 } -> { H, n--, !m++ }
rule b { H } -> { !H, n? }
rule c {} -> { n++, !m-- }
"""


def test_rules_say_what_holds_and_what_they_ask() -> None:
    model = loaded(RULES, toy.domain).checked.model
    a, b, c = rules_at(model, (1, 2, 0))
    assert (a.applies, b.applies, c.applies) == (False, True, True)
    assert [one.text for one in a.failing] == ["!H"]
    assert [one.text for one in b.demands] == ["H becomes false", "n may be anything", "m stays 0"]
    assert [one.text for one in c.demands] == ["H stays true", "n rises above 2", "m is 0 or more"]
    assert model.goal is not None
    assert [one.holds for one in conditions_at(model, model.goal, (1, 0, 0))] == [False, True]


@settings(max_examples=50, deadline=None)
@given(toy.states)
def test_demands_are_those_of_the_rule(state: toy.State) -> None:
    """A rule is satisfied exactly by values that meet its demands, read as numbers."""
    model = loaded(RULES, toy.domain).checked.model
    before = (state.seed % 2, state.boxes, state.marks)
    after = (state.draw(1) % 2, state.draw(2) % 5, state.draw(3) % 5)
    for rule, seen in zip(model.rules, rules_at(model, before), strict=True):
        met = all(
            _meets(demand.text, old, new)
            for demand, old, new in zip(seen.demands, before, after, strict=True)
        )
        assert rule.satisfied_by(before, after) == (seen.applies and met)


def _meets(text: str, before: int, after: int) -> bool:
    words = text.split(" ", 1)[1]
    number = next((int(word) for word in words.split() if word.isdigit()), None)
    if words.startswith(("becomes", "stays")) and number is None:
        return after == int(words.endswith("true"))
    for start, holds in (
        ("falls below", after < before),
        ("rises above", after > before),
        ("may be", True),
        ("stays", after == number),
    ):
        if words.startswith(start):
            return holds
    assert number is not None
    return after <= number if words.endswith("less") else after >= number
