"""Comparisons against all pairs of small feature vectors."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from sketchlang.analysis.changes import changed, requirements, tightenings
from sketchlang.analysis.comparison import Comparison, Witness, compare
from sketchlang.cli import cli
from sketchlang.model import Effect, Feature, Kind, Rule, SketchModel, holds
from tests.analysis.known import PAPER
from tests.analysis.random_sketches import dense_sketch, random_sketch

Pair = tuple[tuple[int, ...], tuple[int, ...]]


def vectors(sketch: SketchModel) -> list[tuple[int, ...]]:
    return list(product(*((0, 1) if f.kind is Kind.BOOL else (0, 1, 2) for f in sketch.features)))


def is_subgoal(sketch: SketchModel, pair: Pair) -> bool:
    before, after = pair
    return not sketch.is_goal(before) and (
        sketch.is_goal(after) or any(rule.satisfied_by(before, after) for rule in sketch.rules)
    )


def possible(sketch: SketchModel, pair: Pair) -> bool:
    return all(holds(one.formula, state) for one in sketch.invariants for state in pair)


def by_listing(first: SketchModel, second: SketchModel) -> str:
    """The verdict by all pairs of numbers up to 2, for sketches over the same features."""
    pairs = [
        pair
        for pair in product(vectors(first), repeat=2)
        if possible(first, pair) and possible(second, pair)
    ]
    a = {pair for pair in pairs if is_subgoal(first, pair)}
    b = {pair for pair in pairs if is_subgoal(second, pair)}
    if a == b:
        return "equivalent"
    return "first-refines-second" if a < b else "second-refines-first" if b < a else "different"


def relative(rng: random.Random, sketch: SketchModel) -> SketchModel:
    """A sketch over the same features: another one, or one that is like it."""
    if rng.random() < 0.2:
        return sketch
    changes = [
        change
        for r, rule in enumerate(sketch.rules)
        for change in (*tightenings(rule, r, sketch), *requirements(rule, r, sketch))
    ]
    other = changed(sketch, [rng.choice(changes)]) if changes else sketch
    rules = list(other.rules)
    rng.shuffle(rules)
    if rng.random() < 0.3:
        rules += sketch.rules[:1]
    if rng.random() < 0.2:
        rules = rules[1:]
    goal = other.goal if rng.random() < 0.8 else None
    return replace(other, rules=tuple(rules), goal=goal)


def check_witness(witness: Witness, own: SketchModel, other: SketchModel) -> None:
    before, after = (
        tuple(values[f.name] for f in own.features) for values in (witness.before, witness.after)
    )
    assert is_subgoal(own, (before, after))
    assert not is_subgoal(other, (before, after))
    assert possible(own, (before, after))
    assert possible(other, (before, after))
    rules = [rule for rule in own.rules if rule.name == witness.rule]
    assert any(r.satisfied_by(before, after) for r in rules) if rules else own.is_goal(after)


def check_pair(first: SketchModel, second: SketchModel) -> Comparison:
    found = compare(first, second)
    for witness, own, other in (
        (found.only_first, first, second),
        (found.only_second, second, first),
    ):
        if witness is not None:
            check_witness(witness, own, other)
    return found


def agree(seeds: range) -> None:
    verdicts = set()
    for seed in seeds:
        rng = random.Random(seed)
        first = random_sketch(seed, most_features=3)
        second = relative(rng, first)
        found = check_pair(first, second)
        assert found.verdict == by_listing(first, second), seed
        verdicts.add(found.verdict)
    assert len(verdicts) == 4


def test_random_pairs() -> None:
    agree(range(250))


@pytest.mark.slow
def test_many_random_pairs() -> None:
    agree(range(1000, 6000))


def test_twenty_features() -> None:
    for seed in range(4):
        first = dense_sketch(seed, 20, 60)
        second = changed(first, [next(iter(requirements(first.rules[30], 30, first)))])
        assert compare(first, first).verdict == "equivalent"
        assert check_pair(second, first).verdict in ("first-refines-second", "equivalent")


def run(*arguments: object) -> Result:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


def test_the_command(tmp_path: Path) -> None:
    first, second = tmp_path / "a.sketch", tmp_path / "b.sketch"
    first.write_text(PAPER)
    second.write_text(PAPER.replace("!v++", "v?"))
    result = run("compare", first, first)
    assert result.exit_code == 0
    assert "are equivalent" in result.output
    result = run("compare", first, second)
    assert result.exit_code == 1
    assert f"{first} refines {second}" in result.output
    assert "pick_clear applies, but has `!v++`." in result.output
    found = json.loads(run("compare", second, first, "--json").output)
    assert found["verdict"] == "second-refines-first"
    assert found["only_first"]["rule"] == "pick_clear"
    assert found["only_second"] is None


def test_a_feature_that_one_sketch_lacks_may_do_anything(tmp_path: Path) -> None:
    first, second = tmp_path / "a.sketch", tmp_path / "b.sketch"
    first.write_text("sketch a\nfeature n : nat\nrule r { } -> { n-- }\n")
    second.write_text("sketch b\nfeature n : nat\nfeature p : bool\nrule r { } -> { n--, p? }\n")
    assert run("compare", first, second).exit_code == 0
    second.write_text("sketch b\nfeature n : bool\nrule r { n } -> { !n }\n")
    result = run("compare", first, second)
    assert result.exit_code == 2
    assert "n is a nat here, a bool there" in result.stderr


def test_more_features_than_python_nests_calls() -> None:
    features = tuple(Feature(f"b{i}", Kind.BOOL) for i in range(1200))
    anything = Rule("r", {}, dict.fromkeys(range(1200), Effect.ANY))
    free = SketchModel("free", features, (anything,))
    still = SketchModel("still", features, (Rule("r", {}, {}),))
    found = compare(free, still)
    assert found.verdict == "second-refines-first"
    assert found.only_first is not None
    assert found.only_first.before != found.only_first.after
