"""Policies beside the library that they are written for. It is under another licence and has an
environment of its own: `SKETCHLANG_DLPLAN` names its python, and without it this is skipped."""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest

from benchmarks.policies import compare
from domains.pddl.interchange import dlplan
from domains.pddl.interchange.export import to_dlplan
from domains.pddl.interchange.translate import Translator
from domains.pddl.interface import PddlInterface
from sketchlang.loader import load_sketch, load_text
from sketchlang.source import Source
from tests.pddl.small_tasks import TASKS
from tests.pddl.test_features import interface_and_problem
from tests.pddl.test_interchange import draw, spelled

PYTHON = os.environ.get("SKETCHLANG_DLPLAN")

pytestmark = pytest.mark.skipif(PYTHON is None, reason="SKETCHLANG_DLPLAN names no python")


def random_policy(rng: random.Random) -> str:
    """A policy of the older dialect with rules that name some of its features."""
    features = {kind: [spelled(draw(kind, rng, 2)) for _ in range(3)] for kind in "bn"}
    said = {
        "c": {"b": ["pos", "neg"], "n": ["gt", "eq"]},
        "e": {"b": ["pos", "neg", "bot"], "n": ["inc", "dec", "bot"]},
    }
    rules = []
    for _ in range(4):
        sides = {}
        for side, words in said.items():
            chosen = [(kind, number) for kind in "bn" for number in range(3)]
            sides[side] = " ".join(
                f"(:{side}_{kind}_{rng.choice(words[kind])} {number})"
                for kind, number in rng.sample(chosen, rng.randint(1, 3))
            )
        if any(f"(:c_n_eq {n})" in sides["c"] and f"_dec {n})" in sides["e"] for n in range(3)):
            continue  # it can never happen, which is an error here
        rules.append(f"(:rule (:conditions {sides['c']}) (:effects {sides['e']}))")
    listed = {kind: " ".join(f'"{text}"' for text in found) for kind, found in features.items()}
    return (
        f"(:policy (:boolean_features {listed['b']}) (:numerical_features {listed['n']}) "
        f"{' '.join(dict.fromkeys(rules))})"
    )


@pytest.mark.parametrize("seed", range(20))
def test_rules_hold_of_the_same_pairs(seed: int) -> None:
    assert PYTHON is not None
    rng = random.Random(seed)
    interface, problem = interface_and_problem(seed)
    text = random_policy(rng)
    sketch = Translator(interface, "d.pddl", "policy").sketch(dlplan.read(text, "policy"), "s")
    loaded = load_text(Source("s", sketch), {}, interface)
    assert loaded.ok, loaded.diagnostics
    found = compare(PYTHON, text, loaded.checked, problem, rng, 200)
    assert found.pairs == 200
    assert found.complete, (found, text, sketch)


@pytest.mark.parametrize("name", ["gripper", "miconic", "visitall", "spanner", "grid", "floortile"])
def test_exported_sketches_have_the_same_rules_there(name: str, tmp_path: Path) -> None:
    assert PYTHON is not None
    checked = load_sketch(name).checked
    interface = checked.domain
    assert isinstance(interface, PddlInterface)
    task = tmp_path / "task.pddl"
    task.write_text(TASKS[name])
    problem = interface.load(str(task), None)  # type: ignore[arg-type, misc]
    text = to_dlplan(checked, interface).text
    found = compare(PYTHON, text, checked, problem, random.Random(0), 300)
    assert found.same_rules == found.pairs == 300
    assert found.satisfied
