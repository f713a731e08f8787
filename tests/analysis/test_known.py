"""Verdicts on published sketches, with and without goal and bounds."""

from __future__ import annotations

import pytest

from sketchlang.analysis.certificate import certificate_of
from sketchlang.analysis.termination import (
    NonTerminating,
    Terminating,
    decide_termination,
    endless_rules,
)
from sketchlang.analysis.verify import verify
from tests.analysis.known import KNOWN, Known
from tests.analysis.reference import surviving_components
from tests.analysis.replay import replay

VARIANTS = [(goal, bounded) for goal in (False, True) for bounded in (False, True)]


@pytest.mark.parametrize(("goal", "bounded"), VARIANTS)
@pytest.mark.parametrize("known", KNOWN, ids=lambda known: known.name)
def test_verdict_and_evidence(known: Known, goal: bool, bounded: bool) -> None:
    model = known.variant(goal, bounded)
    expected = known.endless_rules(bounded)
    verdict = decide_termination(model)
    if not expected:
        assert isinstance(verdict, Terminating)
        verify(certificate_of(model, verdict), model)
    else:
        assert isinstance(verdict, NonTerminating)
        replay(model, verdict)
        assert {model.rules[move.rule].name for move in verdict.walk} <= expected
    endless = endless_rules(model)
    assert endless is not None
    assert {model.rules[rule].name for rule in endless} == expected


@pytest.mark.parametrize("known", KNOWN, ids=lambda known: known.name)
def test_the_reference_agrees_with_what_is_published(known: Known) -> None:
    model = known.variant(goal=False, bounded=False)
    edges = [edge for component in surviving_components(model) for edge in component]
    assert {model.rules[rule].name for _, rule, _ in edges} == known.endless_rules(False)


def test_rule_elimination_alone_does_not_prove_pick_and_place() -> None:
    by_name = {known.name: known for known in KNOWN}
    verdict = decide_termination(by_name["pick_and_place"].variant(True, False))
    assert isinstance(verdict, Terminating)
    assert verdict.by_sieve
    verdict = decide_termination(by_name["delivery_policy"].variant(True, False))
    assert isinstance(verdict, Terminating)
    assert not verdict.by_sieve
