"""Assumptions under which a sketch terminates, and rules that are fair."""

from __future__ import annotations

import json
from itertools import chain, combinations
from pathlib import Path

from click.testing import CliRunner, Result

from sketchlang.analysis.changes import Assume, Bound, changed
from sketchlang.analysis.conditional import sufficient_assumptions
from sketchlang.analysis.fairness import terminates_fairly
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.termination import NonTerminating, decide_termination
from sketchlang.cli import cli
from sketchlang.model import Effect, Kind, SketchModel
from tests.analysis.notation import model
from tests.analysis.random_sketches import random_sketch
from tests.analysis.reference import Edge, Valuation, component_edges, policy_graph, terminates


def fair(sketch: SketchModel, *rules: int) -> bool:
    return terminates_fairly(sketch, rules or range(len(sketch.rules)), Budget())


def unopposed(sketch: SketchModel, rules: set[int]) -> bool:
    for f, declared in enumerate(sketch.features):
        found = {sketch.rules[r].effects.get(f) for r in rules}
        if declared.kind is not Kind.NAT:
            continue
        if Effect.DEC in found and not found & {Effect.INC, Effect.ANY, Effect.NOT_DEC}:
            return True
        if (
            declared.bounded
            and Effect.INC in found
            and not found & {Effect.DEC, Effect.ANY, Effect.NOT_INC}
        ):
            return True
    return False


def has_fair_run(sketch: SketchModel, fair_rules: set[int]) -> bool:
    """By all sets of (valuation, rule) that a run may use again and again."""
    edges = policy_graph(sketch)
    uses = sorted({(before, r) for before, r, _ in edges})
    outcomes: dict[tuple[Valuation, int], set[Valuation]] = {}
    for before, r, after in edges:
        outcomes.setdefault((before, r), set()).add(after)
    for chosen in chain.from_iterable(combinations(uses, n) for n in range(1, len(uses) + 1)):
        some: set[Edge] = {(b, r, a) for b, r in chosen for a in outcomes[b, r]}
        for component in component_edges(some):
            inside = {v for v, _, _ in component}
            used = {(v, r) for v, r, _ in component}
            if (
                used == set(chosen)
                and not unopposed(sketch, {r for _, r in used})
                and all(outcomes[v, r] <= inside for v, r in used if r in fair_rules)
            ):
                return True
    return False


def test_fairness_against_all_sets_of_edges() -> None:
    answers = []
    for seed in range(700):
        sketch = random_sketch(seed, most_features=2)
        rules = {r for r in range(len(sketch.rules)) if (seed >> r) & 1}
        if len({(b, r) for b, r, _ in policy_graph(sketch)}) > 8:
            continue
        found = terminates_fairly(sketch, rules, Budget())
        assert found != has_fair_run(sketch, rules), seed
        answers.append((found, terminates(sketch)))
    # Terminating; only if fair; not even then.
    assert {(True, True), (True, False), (False, False)} == set(answers)


def test_without_fair_rules_it_is_sieve() -> None:
    for seed in range(100):
        sketch = random_sketch(seed)
        assert terminates_fairly(sketch, (), Budget()) == terminates(sketch)


def test_tossing_a_coin_ends_if_it_is_fair() -> None:
    coin = model("coin", "p", "", ["!p -> p?"])
    assert not terminates(coin)
    assert fair(coin)
    other = model("other", "p q", "", ["!p -> p?", "p -> !p"])
    assert not fair(other)
    assert fair(model("ends", "p", "n", ["!p -> p? n?", "p n>0 -> !p n--"], goal="n=0"))


def test_assumptions_suffice_and_are_about_features_only() -> None:
    count = 0
    for seed in range(25):
        sketch = random_sketch(seed, most_features=3)
        if not isinstance(decide_termination(sketch), NonTerminating):
            continue
        for proposal in sufficient_assumptions(sketch, Budget(2)):
            count += 1
            assert all(isinstance(change, Assume | Bound) for change in proposal.changes)
            assert terminates(changed(sketch, proposal.changes))
    assert count > 3


def run(*arguments: object) -> Result:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


def test_the_command(tmp_path: Path) -> None:
    path = tmp_path / "it.sketch"
    path.write_text("sketch coin\nfeature p : bool\ngoal { p }\nrule toss { !p } -> { p? }\n")
    assert run("terminate", path).exit_code == 1
    result = run("terminate", path, "--fair", "toss")
    assert result.exit_code == 0
    assert result.output.startswith("coin terminates if toss is fair")
    found = json.loads(run("terminate", path, "--fair", "all", "--json").output)
    assert (found["verdict"], found["method"], found["fair"]) == (
        "terminating",
        "fairness",
        ["toss"],
    )
    assert run("terminate", path, "--fair", "tosss").exit_code == 2
    path.write_text("sketch up\nfeature n : nat\nrule up { } -> { n++ }\n")
    result = run("terminate", path, "--assume", "--fair", "all")
    assert result.exit_code == 1
    assert "- declare n bounded, if it is" in result.output
    found = json.loads(run("terminate", path, "--assume", "--json").output)
    assert found["assumptions"][0] == ["declare n bounded, if it is"]
