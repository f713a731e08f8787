"""Repairs: proved, the smallest, in the order of what they forbid, and as edits of a text."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from benchmarks.families import FAMILIES
from sketchlang.analysis.changes import (
    Assume,
    Bound,
    Change,
    LeaveOut,
    Require,
    Tighten,
    assumptions,
    changed,
    place,
    removed,
    requirements,
    tightenings,
    without,
)
from sketchlang.analysis.coverage import usable_rules
from sketchlang.analysis.limits import Budget
from sketchlang.analysis.repair import WHOLE_RULE, find_repairs
from sketchlang.analysis.rewriting import applied, edits
from sketchlang.analysis.termination import NonTerminating, decide_termination
from sketchlang.cli import cli
from sketchlang.loader import load_text
from sketchlang.model import Kind, SketchModel, holds
from sketchlang.source import Source
from tests.analysis.known import PAPER
from tests.analysis.random_sketches import random_sketch
from tests.analysis.reference import policy_graph, terminates


def with_changes(sketch: SketchModel, changes: tuple[Change, ...]) -> SketchModel:
    return without(changed(sketch, changes), removed(changes))


def all_changes(sketch: SketchModel) -> list[Change]:
    """Every change that there is, without regard to any cycle."""
    count = len(sketch.features)
    result: list[Change] = []
    for index, rule in enumerate(sketch.rules):
        result += tightenings(rule, index, sketch)
        result += requirements(rule, index, sketch)
        result.append(LeaveOut(index))
    result += [
        Bound(f) for f, x in enumerate(sketch.features) if x.kind is Kind.NAT and not x.bounded
    ]
    result += {one for v in range(1 << count) for one in assumptions(v, count)}
    return result


def sensible(sketch: SketchModel, changes: tuple[Change, ...]) -> bool:
    """No two changes at one place, and no rule that becomes useless but those left out."""
    places = {place(change) for change in changes}
    gone = removed(changes)
    if len(places) < len(changes) or any(
        getattr(c, "rule", None) in gone - {c.rule}
        if isinstance(c, LeaveOut)
        else getattr(c, "rule", None) in gone
        for c in changes
    ):
        return False
    if all(isinstance(change, LeaveOut | Bound) for change in changes):
        return True
    return usable_rules(sketch) - gone <= usable_rules(changed(sketch, changes))


def size(changes: tuple[Change, ...]) -> int:
    return sum(WHOLE_RULE if isinstance(change, LeaveOut) else 1 for change in changes)


def smallest_size(sketch: SketchModel, at_most: int) -> int:
    """By trying all sets of changes, up to a size."""
    everything = all_changes(sketch)
    for wanted in range(1, at_most):
        for count in range(1, wanted + 1):
            for changes in combinations(everything, count):
                if (
                    size(changes) == wanted
                    and sensible(sketch, changes)
                    and terminates(with_changes(sketch, changes))
                ):
                    return wanted
    return at_most


def check_seeds(seeds: range, features: int, brute_force: bool) -> None:
    count = repaired = 0
    for seed in seeds:
        sketch = random_sketch(seed, most_features=features)
        if not isinstance(decide_termination(sketch), NonTerminating):
            continue
        count += 1
        found = find_repairs(sketch, Budget(5), 2)
        assert found.proposals, seed
        sizes = [(size(one.changes), one.forbids) for one in found.proposals if one.smallest]
        assert sizes == sorted(sizes)
        for one in found.proposals:
            assert terminates(with_changes(sketch, one.changes)), (seed, one)
        best = found.proposals[0]
        repaired += best.smallest
        # Sets of three changes of a whole sketch are too many to try them all here.
        if brute_force and best.smallest and size(best.changes) <= 2:
            assert smallest_size(sketch, size(best.changes)) == size(best.changes), seed
    assert count > len(seeds) / 5
    assert repaired > 0.9 * count


def test_the_repair_shown_is_the_smallest() -> None:
    check_seeds(range(60), 2, brute_force=True)


@pytest.mark.slow
def test_the_repair_shown_is_the_smallest_of_many() -> None:
    check_seeds(range(60, 500), 3, brute_force=True)


@pytest.mark.slow
def test_repairs_of_larger_sketches() -> None:
    check_seeds(range(60), 5, brute_force=False)


def test_changes_only_take_away() -> None:
    for seed in range(25):
        sketch = random_sketch(seed, most_features=3)
        names = [rule.name for rule in sketch.rules]
        before = {(a, names[r], b) for a, r, b in policy_graph(sketch)}
        for change in all_changes(sketch):
            after = with_changes(sketch, (change,))
            kept = [rule.name for rule in after.rules]
            assert {(a, kept[r], b) for a, r, b in policy_graph(after)} <= before


def test_invariants_that_a_valuation_breaks() -> None:
    for assumption in assumptions(0b011, 3):
        sketch = changed(random_three(), [assumption])
        assert not holds(sketch.invariants[-1].formula, (1, 1, 0))


def random_three() -> SketchModel:
    return next(s for s in map(random_sketch, range(99)) if len(s.features) == 3)


TEXT = """\
sketch it
feature H : bool   # held
feature n : nat
feature m : nat
goal { !H, n = 0 }
rule a { H, n > 0 } -> { !H, n--, m? }   # the first
rule b { } -> { m? }
rule c {} -> { H,
    n? }  # over two lines
"""


@pytest.mark.parametrize(
    ("changes", "old", "new"),
    [
        ([Tighten(0, 2, None)], "{ !H, n--, m? }", "{ !H, n-- }"),
        ([Tighten(1, 2, None)], "-> { m? }", "-> { }"),
        ([Require(1, 0, True)], "b { }", "b { H }"),
        ([Require(2, 0, False), Require(2, 1, True)], "c {}", "c { !H, n > 0 }"),
        ([Require(0, 2, False)], "{ H, n > 0 }", "{ H, n > 0, m = 0 }"),
        ([Bound(1)], "feature n", "bounded feature n"),
        ([LeaveOut(1)], "rule b { } -> { m? }\n", ""),
        (
            [Assume(((1, False), (2, True)))],
            "rule a",
            "invariant n > 0 -> m > 0\n\nrule a",
        ),
        ([Assume(((0, False),))], "rule a", "invariant not H\n\nrule a"),
    ],
)
def test_edits_touch_only_what_changes(changes: list[Change], old: str, new: str) -> None:
    loaded = load_text(Source("it.sketch", TEXT))
    model = loaded.checked.model
    ((_, text),) = applied(edits(loaded.tree, model, changes)).values()
    assert text == TEXT.replace(old, new, 1)


def test_edited_texts_mean_the_changed_sketch() -> None:
    loaded = load_text(Source("it.sketch", TEXT))
    model = loaded.checked.model
    for change in all_changes(model):
        ((_, text),) = applied(edits(loaded.tree, model, [change])).values()
        again = load_text(Source("it.sketch", text)).checked.model
        expected = with_changes(model, (change,))
        assert policy_graph(again) == policy_graph(expected), change
        assert [f.bounded for f in again.features] == [f.bounded for f in expected.features]


def run(*arguments: object) -> Result:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


def test_the_command(tmp_path: Path) -> None:
    path = tmp_path / "it.sketch"
    broken = PAPER.replace("!v++", "v?")
    path.write_text(broken)
    result = run("repair", path)
    assert result.exit_code == 0
    assert "1. pick_clear with `!v++`, not `v?`" in result.output
    assert f"+{PAPER.splitlines()[7]}" in result.output.splitlines()
    assert path.read_text() == broken
    found = json.loads(run("repair", path, "--json", "--count", 1).output)
    assert found["proposals"][0]["changes"] == ["pick_clear with `!v++`, not `v?`"]
    assert run("repair", path, "--apply", 1).exit_code == 0
    assert path.read_text() == PAPER
    result = run("repair", path)
    assert (result.exit_code, result.output) == (0, "pick_and_place terminates as it is.\n")


def test_users_mistakes(tmp_path: Path) -> None:
    path = tmp_path / "it.sketch"
    assert run("repair", path).exit_code == 2
    path.write_text("sketch s\nfeature n : nat\nrule r { } -> { n++ }\n")
    result = run("repair", path, "--apply", 19)
    assert result.exit_code == 2
    assert "there is no proposal 19" in result.stderr
    assert run("repair", path, "--apply", 0).exit_code == 2
    assert path.read_text().startswith("sketch s")


def test_what_is_not_decided_is_not_called_endless(tmp_path: Path) -> None:
    path = tmp_path / "it.sketch"
    path.write_text(FAMILIES["ring"](60))
    result = run("repair", path, "--time-limit", 0.000001)
    assert result.exit_code == 1
    assert "undecided, the time limit of 1e-06 s was reached" in result.output
    found = json.loads(run("repair", path, "--time-limit", 0.000001, "--json").output)
    assert (found["terminates"], found["proposals"]) == (None, [])
