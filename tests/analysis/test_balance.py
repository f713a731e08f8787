"""Cycles from firing counts: those that are found are cycles, and many are."""

from __future__ import annotations

from benchmarks.families import FAMILIES
from sketchlang.analysis.balance import balanced_cycle
from sketchlang.analysis.bits import rule_bits
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.numbers import concrete_run
from sketchlang.analysis.termination import NonTerminating, decide_termination
from sketchlang.loader import load_text
from sketchlang.model import SketchModel
from sketchlang.source import Source
from tests.analysis.random_sketches import random_sketch
from tests.analysis.reference import terminates
from tests.analysis.replay import replay


def found(sketch: SketchModel) -> NonTerminating | None:
    rules = rule_bits(sketch)
    alive = [rule for rule in rules if not rule.dead]
    cycle = balanced_cycle(sketch, rules, alive, Budget())
    return NonTerminating(cycle, concrete_run(sketch, cycle), ()) if cycle else None


def test_what_is_found_can_go_on_for_ever() -> None:
    cycles = endless = 0
    for seed in range(300):
        sketch = random_sketch(seed)
        verdict = found(sketch)
        if verdict is not None:
            replay(sketch, verdict)
            cycles += 1
        endless += not terminates(sketch)
    assert cycles > 0.9 * endless


def ring(features: int, more: str = "") -> SketchModel:
    loaded = load_text(Source("it.sketch", FAMILIES["token"](features) + more))
    assert loaded.ok
    return loaded.checked.model


def test_a_token_goes_round_once() -> None:
    sketch = ring(60)
    verdict = decide_termination(sketch, Budget(20))
    assert isinstance(verdict, NonTerminating)
    replay(sketch, verdict)
    assert len(verdict.walk) == 60


def test_it_stays_away_from_the_goal_and_from_what_invariants_exclude() -> None:
    assert found(ring(30, "goal { b0 }\n")) is None
    assert found(ring(30, "invariant not b7\n")) is None
    sketch = ring(30, "goal { b0, b1 }\ninvariant not b7 or not b21\n")
    verdict = found(sketch)
    assert verdict is not None
    replay(sketch, verdict)


def test_numbers_are_raised_as_often_as_it_takes() -> None:
    text = FAMILIES["token"](30).replace("feature b0", "feature n : nat\nfeature b0")
    falls = text.replace("{ b3,", "{ n > 0, b3,").replace("!b3,b4", "n--, !b3,b4")
    assert found(load_text(Source("it.sketch", falls)).checked.model) is None
    # The rule that raises it takes a Boolean away that only one outside of the ring gives back.
    both = falls + (
        "feature p : bool\nrule up { p, n = 0 } -> { n++, !p }\nrule on { !p, b9 } -> { p }\n"
    )
    loaded = load_text(Source("it.sketch", both))
    assert loaded.ok
    sketch = loaded.checked.model
    verdict = decide_termination(sketch, Budget(20))
    assert isinstance(verdict, NonTerminating)
    replay(sketch, verdict)
    names = {sketch.rules[move.rule].name for move in verdict.walk}
    assert {"up", "on", "pass3"} <= names
