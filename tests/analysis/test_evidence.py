# ruff: noqa: E501 - texts as users see them
"""What users read: the argument of a proof, the table of a cycle, the ways to break it."""

from __future__ import annotations

from textwrap import dedent

import pytest

from sketchlang.analysis.argument import argument
from sketchlang.analysis.refutation import Remedy, refutation
from sketchlang.analysis.report import as_json, as_text, wrapped
from sketchlang.analysis.termination import (
    NonTerminating,
    Terminating,
    Undecided,
    decide_termination,
)
from sketchlang.loader import load_text
from sketchlang.model import Rule, SketchModel
from sketchlang.source import Source, Span
from tests.analysis.known import KNOWN, PAPER
from tests.analysis.notation import model
from tests.analysis.random_sketches import random_sketch


def place(rule: Rule, span: Span | None) -> str:
    return f"{rule.name} here"


def pick_and_place(effect_on_v: str = "!v++") -> SketchModel:
    loaded = load_text(Source("it.sketch", PAPER.replace("!v++", effect_on_v)))
    assert loaded.ok
    return loaded.checked.model


def test_the_argument_for_pick_and_place_is_the_papers() -> None:
    sketch = pick_and_place()
    assert as_text(sketch, decide_termination(sketch), place) == dedent("""\
        pick_and_place terminates (proved by Sieve).

        1. clear_way fires only finitely often: it lowers v, and nothing else that can still fire
           (pick_clear, put_aside and put_at_goal) raises it.
        2. Now to pick_clear, put_aside and put_at_goal, by the truth of H and I. None of them leads from a
           group below back to an earlier one, so in the long run a run stays in one group:
           {!H} or {H, I}: pick_clear and put_at_goal can go on there, put_aside cannot.
             1. pick_clear fires only finitely often: it lowers m, and nothing else that can still fire
                (put_at_goal) raises it.
             2. put_at_goal fires at most once: it makes !H where H was true, and nothing that can still
                fire makes H true again.
           Elsewhere none of them can fire twice.
           So pick_clear, put_aside and put_at_goal fire only finitely often.
        No rule is left, so no run goes on for ever.""")


def test_the_refutation_names_the_cycle_and_the_effect_to_change() -> None:
    sketch = pick_and_place("v?")
    assert as_text(sketch, decide_termination(sketch), place) == dedent("""\
        pick_and_place does not terminate: pick_clear, put_at_goal and clear_way can go on for ever.

          step  valuation                      rule         what changes
          1     {!H, !I, m > 0, u = 0, v > 0}  pick_clear   H, I, m--: 2 -> 1, u?: 0 -> 1, v?: 1 -> 2
          2     {H, I, m > 0, u > 0, v > 0}    put_at_goal  !H, I?: false
          3     {!H, !I, m > 0, u > 0, v > 0}  clear_way    H, I?: true, m?: 1 -> 2, u?: 1 -> 0, v--: 2 -> 1
          4     {H, I, m > 0, u = 0, v > 0}    put_at_goal  !H, I?: false

        Then it starts again with the same numbers:

          H  I  m  u  v  rule
          0  0  2  0  1  pick_clear
          1  1  1  1  2  put_at_goal
          0  0  1  1  2  clear_way
          1  1  2  0  1  put_at_goal
          0  0  2  0  1  as at the start

        There are other such cycles, with put_aside.

        To break this cycle, do one of these:
        - v falls in clear_way and must not rise elsewhere. Then the sketch terminates.
            pick_clear here: pick_clear with `!v++`, not `v?`""")


def remedies(sketch: SketchModel) -> tuple[Remedy, ...]:
    verdict = decide_termination(sketch)
    assert isinstance(verdict, NonTerminating)
    return refutation(sketch, verdict).remedies


def test_every_cycle_of_a_known_sketch_has_a_remedy_that_helps() -> None:
    # Their rules can fire for ever even if they change nothing.
    hopeless = {"no_change", "no_effect", "anything", "up_and_down"}
    for known in KNOWN:
        if known.endless and known.name not in hopeless:
            sketch = known.variant(False, False)
            verdict = decide_termination(sketch)
            assert isinstance(verdict, NonTerminating)
            found = refutation(sketch, verdict)
            assert all(remedy.suffices for remedy in found.remedies)
            assert found.remedies or found.repair, known.name


def test_a_nat_that_only_grows_may_be_declared_bounded() -> None:
    (remedy,) = remedies(model("it", "", "n", ["-> n++"]))
    assert (remedy.bound, remedy.suffices) == (0, True)
    text = as_text(s := model("it", "", "n", ["-> n++"]), decide_termination(s), place)
    assert "with n grown by the same amount each time" in text
    assert "declare it bounded" in text


def test_a_cycle_that_changes_nothing_says_so() -> None:
    sketch = model("it", "p", "", ["p -> p"])
    assert remedies(sketch) == ()
    assert "has to change anything" in as_text(sketch, decide_termination(sketch), place)


@pytest.mark.parametrize("seed", range(150))
def test_reports_can_be_written_for_any_sketch(seed: int) -> None:
    sketch = random_sketch(seed)
    verdict = decide_termination(sketch)
    text = as_text(sketch, verdict, place)
    assert text.startswith(sketch.name)
    found = as_json(sketch, verdict, place)
    assert {"verdict", "sketch", "method", "features", "rules"} <= set(found)
    if isinstance(verdict, Terminating):
        assert found["certificate"]["proof"] is not None
        assert all(rule.name in "\n".join(argument(sketch, verdict.steps)) for rule in sketch.rules)
    else:
        assert found["counterexample"]["cycle"]


def test_undecided_says_which_limit() -> None:
    sketch = model("it", "", "n", ["-> n++"])
    verdict = Undecided("time", "time limit of 3 s")
    assert "the time limit of 3 s was reached" in as_text(sketch, verdict, place)
    assert as_json(sketch, verdict, place)["limit"] == {"kind": "time", "text": "time limit of 3 s"}


def test_long_lines_are_broken_at_blanks() -> None:
    line = "   " + "word " * 60
    parts = wrapped(line)
    assert all(len(part) <= 100 for part in parts)
    assert " ".join(" ".join(parts).split()) == " ".join(line.split())
    assert wrapped("a  b" * 80) == ["a  b" * 80]
