"""Rule elimination: what each of its rules takes away, and what none of them does."""

from __future__ import annotations

import pytest

from sketchlang.analysis.bits import bounded_mask, rule_bits
from sketchlang.analysis.elimination import eliminate
from sketchlang.analysis.proof import Drop, Split
from sketchlang.model import SketchModel
from tests.analysis.notation import model


def left(sketch: SketchModel) -> set[str]:
    rules = [rule for rule in rule_bits(sketch) if not rule.dead]
    found = eliminate(rules, bounded_mask(sketch))
    return {sketch.rules[rule].name for rule in found.left}


def test_r1_lowered_and_never_raised() -> None:
    sketch = model("it", "", "n m", ["n>0 -> n-- m?", "m>0 -> m--"])
    found = eliminate(rule_bits(sketch), 0)
    assert found.left == frozenset()
    assert [step for step in found.steps if isinstance(step, Drop)] == list(found.steps)
    assert [step.rules for step in found.steps if isinstance(step, Drop)] == [(0,), (1,)]


@pytest.mark.parametrize("opponent", ["n++", "n?", "!n--"])
def test_r1_stops_at_whatever_may_raise(opponent: str) -> None:
    sketch = model("it", "p", "n", ["n>0 -> n--", f"p -> p {opponent}"])
    assert left(sketch) == {"r1", "r2"}


def test_r1_is_not_stopped_by_what_may_only_lower() -> None:
    sketch = model("it", "p", "n", ["n>0 -> n--", "p -> p !n++"])
    assert left(sketch) == {"r2"}


def test_r1_upwards_needs_a_bound() -> None:
    assert left(model("it", "", "n", ["-> n++"])) == {"r1"}
    assert left(model("it", "", "n", ["-> n++"], bounded=True)) == set()
    assert left(model("it", "", "n", ["-> n++", "-> !n++"], bounded=True)) == {"r1", "r2"}


def test_r2_a_boolean_turned_for_good() -> None:
    sketch = model("it", "p q", "", ["!p -> p q?", "!q -> q"])
    found = eliminate(rule_bits(sketch), 0)
    assert found.left == frozenset()
    assert all(isinstance(step, Split) for step in found.steps)


def test_r2_needs_a_real_change() -> None:
    assert left(model("it", "p", "", ["p -> p"])) == {"r1"}
    assert left(model("it", "p", "", ["-> p"])) == {"r1"}


def test_r3_opponents_that_need_another_mode() -> None:
    # r2 raises n, but it needs !p, which is over for good when r1 fires.
    rules = ["p n>0 -> n--", "!p -> n++", "!p -> p"]
    assert left(model("it", "p", "n", rules)) == {"r2"}
    # If the mode can change back and forth, nothing can be said.
    assert left(model("it", "p", "n", [*rules, "p -> !p"])) == {"r1", "r2", "r3", "r4"}


def test_dead_rules_do_not_count() -> None:
    sketch = model("it", "", "n m", ["n=0 -> n-- m++", "m>0 -> m--"])
    assert left(sketch) == set()
