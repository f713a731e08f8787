"""Certificates: every valid one is accepted, every altered one is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from sketchlang.analysis.certificate import as_text, certificate_of
from sketchlang.analysis.fingerprint import digest
from sketchlang.analysis.termination import Terminating, decide_termination
from sketchlang.analysis.verify import RefusedError, read_certificate, verify
from sketchlang.model import Effect, SketchModel
from tests.analysis.explicit_proof import Explicit
from tests.analysis.known import KNOWN
from tests.analysis.mutations import mutations
from tests.analysis.random_sketches import random_sketch

PICK_AND_PLACE = next(k for k in KNOWN if k.name == "pick_and_place").variant(True, False)


def proved(model: SketchModel) -> dict[str, Any] | None:
    verdict = decide_termination(model)
    return certificate_of(model, verdict) if isinstance(verdict, Terminating) else None


def signed(certificate: dict[str, Any]) -> dict[str, Any]:
    """With a new digest, as a forger would make it."""
    content = {key: value for key, value in certificate.items() if key != "digest"}
    return content | {"digest": digest(content)}


def refused(certificate: Any, model: SketchModel) -> bool:
    try:
        verify(certificate, model)
    except RefusedError:
        return True
    return False


def check_mutations(model: SketchModel) -> tuple[int, int]:
    """How many mutations there are, and how many are proofs as well."""
    certificate = proved(model)
    assert certificate is not None
    explicit = Explicit(model)
    assert explicit.proves(certificate["proof"])
    total = accepted = 0
    for altered in mutations(certificate["proof"], model):
        if altered == certificate["proof"]:
            continue
        total += 1
        forged = certificate | {"proof": altered}
        assert refused(forged, model)
        valid = not refused(signed(forged), model)
        right = explicit.proves(altered)
        if model.invariants:
            # A leaf `null` must follow from its path alone, without looking further.
            assert right or not valid
        else:
            assert right == valid
        accepted += valid
    return total, accepted


@pytest.mark.parametrize(
    "model",
    [k.variant(g, b) for k in KNOWN for g in (False, True) for b in (False, True)],
    ids=lambda model: model.name,
)
def test_alterations_of_known_sketches(model: SketchModel) -> None:
    if proved(model) is not None:
        check_mutations(model)


def random_alterations(seeds: range) -> None:
    total = accepted = 0
    for seed in seeds:
        model = random_sketch(seed, most_features=4)
        if proved(model) is not None:
            found = check_mutations(model)
            total, accepted = total + found[0], accepted + found[1]
    assert total > 5 * len(seeds)
    # The rest prove the same in another way: they move valuations that no rule leaves.
    assert accepted < total / 4


def test_alterations_of_random_sketches() -> None:
    random_alterations(range(400))


@pytest.mark.slow
def test_alterations_of_many_random_sketches() -> None:
    random_alterations(range(20_000, 21_000))


def test_alterations_of_the_text() -> None:
    certificate = proved(PICK_AND_PLACE)
    assert certificate is not None
    assert json.loads(as_text(certificate)) == certificate
    for key in certificate:
        assert refused({k: v for k, v in certificate.items() if k != key}, PICK_AND_PLACE)
        for value in (None, 7, "", [], {}, True):
            assert refused(certificate | {key: value}, PICK_AND_PLACE)
    assert refused(certificate | {"more": 1}, PICK_AND_PLACE)
    assert refused(certificate | {"version": 2}, PICK_AND_PLACE)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("version", True),
        ("version", 1.0),
        ("version", "1"),
        ("version", 0),
        ("method", float("nan")),
        ("method", None),
        ("method", "potentials"),  # no word of version 1
        ("method", "magic"),
        ("sketch", ["pick_and_place"]),
        ("sketch", None),
        ("format", ["sketchlang-termination-certificate"]),
    ],
)
def test_fields_have_their_types(key: str, value: Any) -> None:
    certificate = proved(PICK_AND_PLACE)
    assert certificate is not None
    assert refused(signed(certificate | {key: value}), PICK_AND_PLACE)


def test_a_key_that_is_twice_is_refused() -> None:
    text = as_text(proved(PICK_AND_PLACE))
    verify(read_certificate(text.encode()), PICK_AND_PLACE)
    for key in ("version", "rules", "lowers"):
        first = text.index(f'"{key}"')
        end = first + text[first:].index("\n")
        line = text[first:end].rstrip(",")
        twice = f"{text[:first]}{line}, {text[first:]}"
        with pytest.raises(RefusedError, match="is twice in one object"):
            read_certificate(twice.encode())


@pytest.mark.parametrize("number", ["1.0", "1e0", "NaN", "Infinity", "-Infinity", "1" * 5000])
def test_numbers_that_are_no_integers_are_not_read(number: str) -> None:
    with pytest.raises(RefusedError):
        read_certificate(f'{{"version": {number}}}'.encode())


@pytest.mark.parametrize("nonsense", [None, 3, "proof", [], {}, [{}], {"proof": []}])
def test_nonsense_is_refused(nonsense: Any) -> None:
    assert refused(nonsense, PICK_AND_PLACE)


@pytest.mark.parametrize(
    "proof",
    [
        7,
        [7],
        [None],
        [{}],
        [{"lowers": "v"}],
        [{"lowers": ["v"], "rules": ["r2"]}],
        [{"lowers": "v", "rules": "r2"}],
        [{"lowers": "v", "rules": [2]}],
        [{"lowers": "v", "rules": ["r2", "r2"]}],
        [{"lowers": "H", "rules": ["r2"]}],
        [{"raises": "v", "rules": ["r2"]}],
        [{"split": 0, "blocks": 7, "rules": []}],
        [{"split": 0, "blocks": [], "rules": []}],
        [{"split": True, "blocks": [{}, {}], "rules": []}],
        [{"split": ["H", 0], "blocks": [{"rules": [], "proof": []}], "rules": []}],
        [{"split": ["H", ["H", 0, 0], 0], "blocks": [{"rules": [], "proof": []}], "rules": []}],
        [{"split": 0, "blocks": [{"rules": [], "proof": []}], "rules": []}],
        [{"split": 0, "blocks": [{"rules": ["r1", "r2", "r3", "r4"], "proof": []}], "rules": []}],
    ],
)
def test_malformed_steps_are_refused(proof: Any) -> None:
    certificate = proved(PICK_AND_PLACE)
    assert certificate is not None
    assert refused(signed(certificate | {"proof": proof}), PICK_AND_PLACE)


def test_a_certificate_is_for_one_sketch_only() -> None:
    certificate = proved(PICK_AND_PLACE)
    first = PICK_AND_PLACE.rules[0]
    effects = dict(first.effects) | {4: Effect.ANY}
    others = [
        replace(PICK_AND_PLACE, goal=None),
        replace(PICK_AND_PLACE, goal={0: False}),
        replace(PICK_AND_PLACE, rules=PICK_AND_PLACE.rules[:-1]),
        replace(
            PICK_AND_PLACE,
            rules=(replace(first, effects=effects), *PICK_AND_PLACE.rules[1:]),
        ),
        replace(
            PICK_AND_PLACE,
            features=(
                *PICK_AND_PLACE.features[:-1],
                replace(PICK_AND_PLACE.features[-1], bounded=True),
            ),
        ),
    ]
    for other in others:
        with pytest.raises(RefusedError, match="fingerprint"):
            verify(certificate, other)
    verify(certificate, replace(PICK_AND_PLACE, name="renamed"))


def test_reasons_are_given() -> None:
    certificate = proved(PICK_AND_PLACE)
    assert certificate is not None
    wrong = json.loads(json.dumps(certificate["proof"]))
    wrong[0]["lowers"] = "m"
    with pytest.raises(RefusedError, match="digest"):
        verify(certificate | {"proof": wrong}, PICK_AND_PLACE)
    with pytest.raises(RefusedError, match=r"step 1: r1 lowers m here, not r2"):
        verify(signed(certificate | {"proof": wrong}), PICK_AND_PLACE)
    with pytest.raises(RefusedError, match=r"at its end r1, r3, r4 may still fire"):
        verify(
            signed(certificate | {"proof": wrong[1:0] + certificate["proof"][:1]}), PICK_AND_PLACE
        )
    turned = json.loads(json.dumps(certificate["proof"]))
    turned[1]["split"] = ["H", 0, ["I", 1, 0]]
    with pytest.raises(RefusedError, match=r"step 2: r3 leads back from block 1 to block 0"):
        verify(signed(certificate | {"proof": turned}), PICK_AND_PLACE)
