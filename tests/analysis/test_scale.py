"""Sketches with twenty features are decided at once, and limits are kept."""

from __future__ import annotations

import time

import pytest

from benchmarks.families import FAMILIES
from sketchlang.analysis.certificate import certificate_of
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import (
    NonTerminating,
    Terminating,
    Undecided,
    decide_termination,
)
from sketchlang.analysis.verify import verify
from sketchlang.loader import load_text
from sketchlang.model import SketchModel
from sketchlang.source import Source
from tests.analysis.replay import replay


def family(name: str, features: int) -> SketchModel:
    loaded = load_text(Source(f"{name}.sketch", FAMILIES[name](features)))
    assert loaded.ok
    return loaded.checked.model


@pytest.mark.parametrize(
    ("name", "by_sieve"), [("chain", False), ("relay", True), ("copies", True)]
)
def test_twenty_features(name: str, by_sieve: bool) -> None:
    model = family(name, 20)
    assert len(model.features) == 20
    started = time.perf_counter()
    verdict = decide_termination(model)
    # Takes some milliseconds; the target for the whole process is 2 s.
    assert time.perf_counter() - started < 1
    assert isinstance(verdict, Terminating)
    assert verdict.by_sieve == by_sieve
    verify(certificate_of(model, verdict), model)


def test_twenty_features_that_go_on_for_ever() -> None:
    model = family("endless", 20)
    started = time.perf_counter()
    verdict = decide_termination(model)
    assert time.perf_counter() - started < 1
    assert isinstance(verdict, NonTerminating)
    replay(model, verdict)


def test_a_proof_that_needs_the_whole_graph() -> None:
    model = family("gray", 12)
    verdict = decide_termination(model)
    assert isinstance(verdict, Terminating)
    verify(certificate_of(model, verdict), model)


def test_the_time_limit_is_kept() -> None:
    model = family("gray", 20)
    started = time.perf_counter()
    verdict = decide_termination(model, Budget(seconds=0.02))
    assert isinstance(verdict, Undecided)
    assert verdict.kind == "time"
    assert time.perf_counter() - started < 30


def test_the_memory_limit_is_kept() -> None:
    budget = Budget(megabytes=1e6)
    budget.megabytes = budget.base_mb + 10
    verdict = decide_termination(family("gray", 20), budget)
    assert isinstance(verdict, Undecided)
    assert verdict.kind == "memory"


def test_limits_do_not_matter_to_what_rule_elimination_proves() -> None:
    verdict = decide_termination(family("chain", 20), Budget(seconds=0))
    assert isinstance(verdict, Terminating)
