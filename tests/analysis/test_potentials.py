"""Potentials: weighted sums that only fall, from the linear programme to the certificate."""

from __future__ import annotations

import pytest

from benchmarks.families import FAMILIES
from sketchlang.analysis.argument import argument
from sketchlang.analysis.bits import bounded_mask, rule_bits
from sketchlang.analysis.certificate import certificate_of
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.potential import most_change, potential
from sketchlang.analysis.proof import Potential, Term
from sketchlang.analysis.termination import Terminating, decide_termination
from sketchlang.analysis.verify import verify
from sketchlang.loader import load_text
from sketchlang.model import SketchModel
from sketchlang.source import Source
from tests.analysis.explicit_proof import Explicit
from tests.analysis.mutations import mutations
from tests.analysis.notation import model
from tests.analysis.random_sketches import random_sketch
from tests.analysis.reference import terminates
from tests.analysis.test_certificates import refused, signed


def weighted_sum(features: int, rules: int, seed: int = 0) -> SketchModel:
    text = FAMILIES["weighted_sum"](features, rules, seed)
    return load_text(Source("it.sketch", text)).checked.model


def found(sketch: SketchModel) -> Potential | None:
    alive = [rule for rule in rule_bits(sketch) if not rule.dead]
    return potential(alive, bounded_mask(sketch), Budget())


def proof_of(sketch: SketchModel) -> Terminating | None:
    """By one potential, if that is enough."""
    step = found(sketch)
    left = [r.index for r in rule_bits(sketch) if not r.dead and r.index not in step.rules]
    return Terminating((step,), "potentials") if not left else None


def test_one_sum_for_all_rules() -> None:
    sketch = model("it", "H", "m", ["!H m>0 -> H m--", "H -> !H"])
    step = found(sketch)
    assert step is not None
    assert step.rules == (0, 1)
    assert step.terms == (Term(0, True, 1), Term(1, False, 2))
    assert argument(sketch, [step])[0] == (
        "1. H + 2 m falls with every rule, and it cannot fall for ever."
    )


def test_a_bounded_nat_may_have_a_negative_weight() -> None:
    rules = ["!H -> H m++", "H -> !H"]
    assert found(model("it", "H", "m", rules)) is None
    step = found(model("it", "H", "m", rules, bounded=True))
    assert step is not None
    assert Term(1, False, -2) in step.terms


def test_the_truth_of_a_nat_may_count_by_itself() -> None:
    sketch = model("it", "p", "n", ["n=0 p -> n++ p?", "n>0 p -> !n-- !p"])
    step = found(sketch)
    assert step is not None
    assert step.rules == (0, 1)
    assert step.terms == (Term(0, True, 1), Term(1, True, -1))
    assert argument(sketch, [step])[0].startswith("1. p - (n > 0) falls with every rule")
    assert all(most_change(rule, step.terms) == -1 for rule in rule_bits(sketch))


@pytest.mark.parametrize(("features", "rules"), [(16, 400), (20, 200), (20, 600)])
def test_random_weighted_sums_are_proved_by_one_potential(features: int, rules: int) -> None:
    sketch = weighted_sum(features, rules)
    verdict = decide_termination(sketch)
    assert isinstance(verdict, Terminating)
    assert verdict.method == "potentials"
    (step,) = verdict.steps
    assert isinstance(step, Potential)
    verify(certificate_of(sketch, verdict), sketch)


def random_proofs(seeds: range) -> None:
    """What a potential proves alone is true, and its certificate stands every test."""
    proved = altered = 0
    for seed in seeds:
        sketch = random_sketch(seed, most_features=4)
        if found(sketch) is None or (verdict := proof_of(sketch)) is None:
            continue
        proved += 1
        assert terminates(sketch), seed
        certificate = certificate_of(sketch, verdict)
        assert certificate["version"] == 2
        verify(certificate, sketch)
        explicit = Explicit(sketch)
        assert explicit.proves(certificate["proof"])
        for forged in mutations(certificate["proof"], sketch):
            altered += 1
            accepted = not refused(signed(certificate | {"proof": forged}), sketch)
            assert accepted == explicit.proves(forged), (seed, forged)
    assert proved > len(seeds) / 20
    assert altered > 3 * len(seeds)


def test_random_sketches_with_a_potential() -> None:
    random_proofs(range(120))


@pytest.mark.slow
def test_many_random_sketches_with_a_potential() -> None:
    random_proofs(range(30_000, 33_000))


def test_version_1_has_no_potentials() -> None:
    sketch = model("it", "H", "m", ["!H m>0 -> H m--", "H -> !H"])
    verdict = proof_of(sketch)
    assert verdict is not None
    certificate = certificate_of(sketch, verdict)
    assert not refused(signed(certificate), sketch)
    assert refused(signed(certificate | {"version": 1, "method": "sieve"}), sketch)
