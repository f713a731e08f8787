"""The prover against the textbook on random sketches, and its evidence against the rules."""

from __future__ import annotations

import pytest

from sketchlang.analysis.certificate import certificate_of
from sketchlang.analysis.termination import Terminating, decide_termination, endless_rules
from sketchlang.analysis.verify import verify
from tests.analysis.random_sketches import dense_sketch, random_sketch
from tests.analysis.reference import surviving_components
from tests.analysis.replay import replay


def agree_on(seed: int) -> bool:
    """Whether the sketch of a seed terminates; all agree on it."""
    model = random_sketch(seed)
    survivors = surviving_components(model)
    verdict = decide_termination(model)
    assert isinstance(verdict, Terminating) == (not survivors), seed
    if isinstance(verdict, Terminating):
        verify(certificate_of(model, verdict), model)
    else:
        replay(model, verdict)
    endless = {rule for component in survivors for _, rule, _ in component}
    assert endless_rules(model) == endless, seed
    return not survivors


def agree(seeds: range) -> None:
    found = {True: 0, False: 0}
    for seed in seeds:
        found[agree_on(seed)] += 1
    # Both answers must be common, or the test says nothing.
    assert min(found.values()) > len(seeds) / 5


def test_verdicts_agree_with_textbook_sieve() -> None:
    agree(range(700))


def refined_agrees(seeds: range) -> None:
    """Refinement on demand against the same Sieve with all features tracked from the start."""
    kinds = set()
    for seed in seeds:
        features = 6 + seed % 5
        model = dense_sketch(seed, features, features * (1 + seed % 3))
        verdict = decide_termination(model)
        endless = endless_rules(model)
        assert isinstance(verdict, Terminating) == (not endless), seed
        if isinstance(verdict, Terminating):
            verify(certificate_of(model, verdict), model)
            kinds.add(verdict.by_sieve)
        else:
            replay(model, verdict)
            kinds.add(None)
    assert kinds == {True, False, None}


def test_tracking_few_features_is_enough() -> None:
    refined_agrees(range(150))


@pytest.mark.slow
def test_tracking_few_features_is_enough_on_many() -> None:
    refined_agrees(range(1000, 3000))


def test_cells_that_two_invariants_exclude_together() -> None:
    # Once written with a leaf that did not follow from its own path.
    agree_on(11071)


@pytest.mark.slow
def test_verdicts_agree_with_textbook_sieve_on_many() -> None:
    agree(range(10_000, 15_000))
