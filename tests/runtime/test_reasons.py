"""Why there is no plan: near misses, missing rules, narrow searches, circles; in a small world."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from hypothesis import given, settings, strategies

from runtime.reasons.effects import cured
from runtime.search.guide import Guide
from runtime.search.limits import Limits
from runtime.search.retrospect import Deviation, Miss, look_back
from runtime.show.moments import moments
from runtime.solve import open_task
from runtime.trace.load import load_trace
from sketchlang.cli.replay import command as replay
from sketchlang.cli.run import command as run
from sketchlang.cli.validate import command as validate
from sketchlang.loader import load_sketch
from sketchlang.model import Effect

DELIVERY = """sketch test
include "delivery_features.sketch"
{rules}
"""
POLICY = {
    "approach": "{ !H, p > 0 } -> { p--, t? }",
    "pick": "{ !H, p = 0 } -> { H }",
    "carry": "{ H, t > 0 } -> { t-- }",
    "deliver": "{ H, t = 0, n > 0 } -> { !H, p?, n-- }",
}
DOMAINS = Path(__file__).parents[2] / "domains"
FEATURES = DOMAINS / "delivery/delivery_features.sketch"
TASK = """(define (problem p) (:domain gripper)
(:objects rooma roomb ball1 ball2 left right)
(:init (room rooma) (room roomb) (ball ball1) (ball ball2) (gripper left) (gripper right)
  (at-robby rooma) (free left) (free right) (at ball1 rooma) (at ball2 rooma))
(:goal (and (at ball1 roomb) (at ball2 roomb))))
"""


def write(folder: Path, **changed: str | None) -> str:
    """The published policy of delivery with some rules changed, or left out."""
    rules = {name: text for name, text in (POLICY | changed).items() if text is not None}
    path = folder / "test.sketch"
    text = DELIVERY.format(rules="\n".join(f"rule {n} {t}" for n, t in rules.items()))
    path.write_text(text.replace("delivery_features.sketch", str(FEATURES)))
    return str(path)


def report(sketch: str, *more: str) -> dict[str, Any]:
    done = CliRunner().invoke(run, [sketch, "delivery/four", "--json", *more])
    assert done.exit_code == 1, done.output
    found: dict[str, Any] = json.loads(done.stdout)
    assert found["reason"]
    return found


FROZEN = {
    "approach": ("{ !H, p > 0 } -> { p-- }", "t"),
    "deliver": ("{ H, t = 0, n > 0 } -> { !H, n-- }", "p"),
    "pick": ("{ !H, p = 0 } -> { H?, t? }", None),
}


@pytest.mark.parametrize("rule", ["approach", "deliver"])
def test_an_effect_that_was_forgotten_is_named(tmp_path, rule) -> None:
    text, feature = FROZEN[rule]
    found = report(write(tmp_path, **{rule: text}))
    first = found["why"][0]
    assert (first["cause"], first["rule"]) == ("effect", rule)
    assert [wrong["feature"] for wrong in first["wrong"]] == [feature]
    assert f"{rule} keeps {feature}" in found["reason"]
    assert first["actions"]  # and how to get there


def test_what_is_advised_makes_the_rule_fire(tmp_path) -> None:
    found = report(write(tmp_path, approach="{ !H, p > 0 } -> { p-- }"))
    (wrong,) = found["why"][0]["wrong"]
    mended = f"{{ !H, p > 0 }} -> {{ p--, {wrong['write'][-1]} }}"
    done = CliRunner().invoke(run, [write(tmp_path, approach=mended), "delivery/four"])
    assert done.exit_code == 0, done.output


def test_an_effect_with_the_wrong_sign_is_named(tmp_path) -> None:
    found = report(write(tmp_path, deliver="{ H, t = 0, n > 0 } -> { !H, p?, n++ }"))
    assert "asks for `n++`" in found["reason"]
    assert "`n--`" in found["reason"]


def test_a_rule_that_is_missing_is_said_at_once(tmp_path) -> None:
    found = report(write(tmp_path, carry=None))
    assert "no rule for" in found["reason"]
    assert found["why"][0]["cause"] == "no rule"
    assert found["generated"] < 2000


def test_a_condition_that_was_turned_round_is_named(tmp_path) -> None:
    found = report(write(tmp_path, pick="{ H, p = 0 } -> { H }"))
    assert "pick asks for H" in found["reason"]
    assert "H" in found["why"][0]["missing"]["pick"]


def test_a_rule_that_lowers_what_is_zero_is_no_rule(tmp_path) -> None:
    """Its conditions hold; but nothing that it asks for can ever happen."""
    found = report(write(tmp_path, pick="{ !H } -> { H, p-- }"))
    assert found["why"][0]["cause"] == "no rule"
    assert "p > 0" in found["why"][0]["missing"]["pick"]
    assert found["generated"] < 2000


def test_a_search_that_is_too_narrow_names_the_atoms_that_help(tmp_path) -> None:
    sketch = Path(write(tmp_path, approach=None, carry=None, pick="{ !H } -> { H, p?, t? }"))
    features = FEATURES.read_text().replace("agent_at, package_at, holding", "holding")
    (tmp_path / "features.sketch").write_text(features)
    sketch.write_text(sketch.read_text().replace(str(FEATURES), "features.sketch"))
    found = report(str(sketch))
    assert found["why"][0]["cause"] == "width"
    assert "atoms holding, agent_at" in found["reason"]


def test_a_circle_names_the_loop_of_the_proof() -> None:
    found = report("delivery_s3")
    assert set(found["why"][0]["terminate"]) == {"drop", "pick"}
    assert "the state of subgoal 1 again" in found["reason"]
    assert found["generated"] < 1000


# -- sketches that are not proved to terminate -------------------------------------------------


def test_a_sketch_that_may_not_terminate_warns_before_it_runs() -> None:
    done = CliRunner().invoke(run, ["delivery_s3", "delivery/four"])
    assert "warning: the sketch is not proved to terminate: " in done.stderr
    assert "warning" not in done.stdout
    assert report("delivery_s3")["warnings"][0]["rules"]


def test_a_proved_sketch_does_not_warn() -> None:
    done = CliRunner().invoke(run, ["delivery_policy", "delivery/four", "--json"])
    assert done.exit_code == 0
    assert "warnings" not in json.loads(done.stdout)


# -- near misses against all there is ----------------------------------------------------------

RULE = strategies.fixed_dictionaries(
    {}, optional={name: strategies.sampled_from(kinds) for name, kinds in {
        "H": ["H", "!H", "H?"], "p": ["p--", "p++", "p?", "!p++"], "t": ["t--", "t++", "t?"],
        "n": ["n--", "n?"],
    }.items()}
)  # fmt: skip


@settings(max_examples=25)
@given(RULE)
def test_no_state_that_can_be_reached_misses_by_fewer_effects(tmp_path_factory, effects) -> None:
    """The nearest miss is one: compared with all states of the task, one by one."""
    folder = tmp_path_factory.mktemp("miss")
    rules = dict.fromkeys(POLICY) | {"only": f"{{ !H }} -> {{ {', '.join(effects.values())} }}"}
    if not effects:
        return
    loaded = load_sketch(write(folder, **rules))
    if not loaded.ok:
        return
    task = open_task(loaded.checked, "delivery/one")
    guide = Guide(task.sketch)
    start = task.problem.initial
    before = guide.values(start)
    found = look_back(guide, [task.problem.subproblem(start, 0, None)], start, before)
    rule = task.sketch.model.rules[0]
    states = _all_states(task.problem, start)
    wrong = {state: _violated(rule, before, guide.values(state)) for state in states}
    assert bool(found.subgoals) == (not all(wrong.values()) or any(map(task_goal(guide), states)))
    for miss in [] if found.subgoals else found.misses:
        assert miss.wrong
        assert miss.weight <= min(
            _weight(rule, before, guide.values(s)) for s in states if wrong[s]
        )


def task_goal(guide: Guide) -> Any:
    return lambda state: guide.is_goal(guide.values(state), state)


def _all_states(problem: Any, start: Any) -> list[Any]:
    known, queue = {start}, [start]
    for state in queue:
        for _, after in problem.subproblem(state, 0, None).actions(state):
            if after not in known:
                known.add(after)
                queue.append(after)
    return queue


def _violated(rule: Any, before: Any, after: Any) -> list[int]:
    return [
        f
        for f, (old, new) in enumerate(zip(before, after, strict=True))
        if not (rule.effects[f].allows(old, new) if f in rule.effects else old == new)
    ]


def _weight(rule: Any, before: Any, after: Any) -> int:
    total = 0
    for f in _violated(rule, before, after):
        effect, old, new = rule.effects.get(f), before[f], after[f]
        stayed = effect in (Effect.SET, Effect.CLEAR, Effect.INC) and old == new
        idle = stayed or (effect is Effect.DEC and new >= old)
        total += 2 if idle else 1
    return total


# -- what an unsolved run leaves ---------------------------------------------------------------


def test_an_unsolved_run_keeps_what_it_reached_beside_the_plan(tmp_path) -> None:
    out = tmp_path / "plan.json"
    found = report(write(tmp_path, approach="{ !H, p > 0 } -> { p-- }"), "--out", str(out))
    assert not out.exists()
    kept = json.loads((tmp_path / "plan.unsolved.json").read_text())
    assert kept["failure"]["reason"] == found["reason"]
    assert len(kept["subgoals"]) == found["subplans"]


def test_no_file_of_another_kind_is_written_over(tmp_path) -> None:
    sketch, out = write(tmp_path, carry=None), tmp_path / "plan.json"
    other = tmp_path / "plan.unsolved.json"
    for text in ("mine", json.dumps({"format": "sketchlang-plan"})):
        other.write_text(text)
        report(sketch, "--out", str(out))
        assert other.read_text() == text
    other.unlink()
    for _ in range(2):  # but one of the same kind is
        done = CliRunner().invoke(run, [sketch, "delivery/four", "--out", str(out)])
        assert done.exit_code == 1
        assert "what was reached is written to" in done.stdout


def test_a_solved_plan_stays_where_a_later_run_fails(tmp_path) -> None:
    out = tmp_path / "plan.json"
    arguments = ["delivery/four", "--out", str(out)]
    assert CliRunner().invoke(run, ["delivery_policy", *arguments]).exit_code == 0
    solved = out.read_bytes()
    assert CliRunner().invoke(run, [write(tmp_path, carry=None), *arguments]).exit_code == 1
    assert out.read_bytes() == solved


def test_a_partial_plan_is_judged_and_replayed_as_one(tmp_path) -> None:
    sketch = tmp_path / "keep.sketch"
    text = (FEATURES.parents[1] / "pick_and_place.sketch").read_text()
    sketch.write_text(text.replace("{ H, I } -> { !H, I? }", "{ H, I } -> { !H }"))
    runner, out = CliRunner(), tmp_path / "plan.json"
    done = runner.invoke(run, [str(sketch), "sorting/3t-02", "--out", str(out)])
    assert done.exit_code == 1
    assert "put_at_goal keeps I: write `!I` or `I?`" in done.stdout
    partial = tmp_path / "plan.unsolved.json"
    verdict = runner.invoke(validate, [str(partial)])
    assert verdict.exit_code == 1
    assert "is a partial plan, of 1 subgoal and 2 actions: " in verdict.stdout
    data = json.loads(runner.invoke(validate, [str(partial), "--json"]).stdout)
    assert (data["valid"], "partial" in data) == (False, True)
    trace = tmp_path / "trace.json"
    shown = ["--sketch", str(sketch), "--trace", str(trace), "--html", str(tmp_path / "x.html")]
    assert runner.invoke(replay, [str(partial), *shown]).exit_code == 0
    written = json.loads(trace.read_text())
    (verdict_event,) = [e for e in written["events"] if e["kind"] == "verdict"]
    assert verdict_event["time"] == written["duration"]
    assert verdict_event["text"] == data["partial"]
    assert [name for name, _ in moments(load_trace(trace, find_world))][-1] == "failure"


def find_world(name: str) -> Any:
    raise AssertionError("a trace needs no other file")


def test_a_partial_plan_of_a_pddl_task_says_so(tmp_path) -> None:
    domain, task = DOMAINS / "gripper/domain.pddl", tmp_path / "task.pddl"
    task.write_text(TASK)
    sketch = tmp_path / "lost.sketch"
    text = (DOMAINS / "gripper/gripper.sketch").read_text()
    sketch.write_text(text[: text.rindex("rule ")])
    out = tmp_path / "plan.txt"
    given = [str(sketch), str(task), "--domain-pddl", str(domain), "--out", str(out)]
    done = CliRunner().invoke(run, given)
    assert done.exit_code == 1, done.output
    assert not out.exists()
    partial = tmp_path / "plan.unsolved.txt"
    assert "; unsolved: " in partial.read_text()
    verdict = CliRunner().invoke(validate, [str(partial), "--domain-pddl", str(domain)])
    assert verdict.exit_code == 1
    assert "is a partial plan" in verdict.stdout


def test_limits_do_not_depend_on_time() -> None:
    limits = Limits()
    assert 0 < limits.blind < limits.generated
    assert all(isinstance(n, int) for n in itertools.chain([limits.blind, limits.generated]))


SORT = """sketch sort
use tabletop
feature H : bool = some o in objects: held(o)
feature m : nat = count o in objects: misplaced(o)
feature easy : nat = count o in objects where misplaced(o): obstructions(o) = 0
feature v : nat = sum o in objects where misplaced(o): obstructions(o)
invariant not H and m > 0 and easy = 0 -> v > 0
atoms robot_at, object_at
goal { !H, m = 0 }
rule take { !H, easy > 0 } -> { H, m--, easy--, TAKE }
rule free { !H, m > 0, easy = 0 } -> { H, v--, FREE }
rule put { H } -> { !H, easy? }
"""


@pytest.mark.parametrize(("take", "free", "cure"), [("v--", "easy?", "v?"), ("v?", "m?", "easy?")])
def test_a_change_that_was_tried_and_leads_to_the_goal_comes_first(
    tmp_path, monkeypatch, take, free, cure
) -> None:
    """An effect that does not happen, and one that is forgotten, where things are barred, too."""
    monkeypatch.setattr("runtime.solve.CURES", 60.0)
    monkeypatch.setattr("runtime.search.retrospect.PATIENCE", 60.0)
    path = tmp_path / "sort.sketch"
    path.write_text(SORT.replace("TAKE", take).replace("FREE", free))
    found = json.loads(CliRunner().invoke(run, [str(path), "sorting/1t-20", "--json"]).stdout)
    assert found["why"][0]["tested"], found["reason"]
    assert f"with `{cure}` the run reaches the goal" in found["reason"]
    path.write_text(
        SORT.replace("TAKE", cure if take == "v--" else take).replace(
            "FREE", free if take == "v--" else f"{free}, {cure}"
        )
    )
    assert CliRunner().invoke(run, [str(path), "sorting/1t-20"]).exit_code == 0


def test_a_rule_that_would_ask_for_nothing_is_no_cure() -> None:
    model = load_sketch("delivery_policy").checked.model
    rule = next(i for i, one in enumerate(model.rules) if one.name == "pick")
    feature = next(iter(model.rules[rule].effects))
    wrong = (Deviation(feature, 0, 0, Effect.SET),)
    assert cured(model, Miss(rule, (0,) * len(model.features), wrong, ("go",), True)) is None
