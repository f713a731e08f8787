"""`run` and `validate` on a PDDL task, from the sketch to a plan that the replay accepts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from domains.pddl.ground.task import ground
from domains.pddl.syntax.read import read_domain, read_task
from sketchlang.cli import cli
from sketchlang.source import Source

DOMAIN = """
(define (domain lamps) (:requirements :strips)
  (:predicates (lamp ?x) (next ?x ?y) (at ?x) (on-fire ?x) (lit ?x))
  (:action step :parameters (?x ?y)
    :precondition (and (at ?x) (next ?x ?y)) :effect (and (at ?y) (not (at ?x))))
  (:action light :parameters (?x)
    :precondition (and (at ?x) (lamp ?x) (not (lit ?x))) :effect (lit ?x)))
"""
TASK = """
(define (problem street) (:domain lamps) (:objects a b c d)
  (:init (lamp a) (lamp c) (lamp d) (next a b) (next b c) (next c d) (next d a) (at a))
  (:goal (forall (?x) (or (not (lamp ?x)) (lit ?x)))))
"""
SKETCH = """
sketch lamps
use "domain.pddl"
feature dark : nat = count x in lamp: not lit(x)
feature way : nat = distance(at, next, lamp - lit)
goal { dark = 0 }
rule light { dark > 0 } -> { dark--, way? }
rule walk { dark > 0, way > 0 } -> { way-- }
"""


@pytest.fixture
def street(tmp_path: Path) -> Path:
    """A folder with domain, task and sketch."""
    for name, text in (("domain", DOMAIN), ("task", TASK)):
        (tmp_path / f"{name}.pddl").write_text(text)
    (tmp_path / "lamps.sketch").write_text(SKETCH)
    return tmp_path


def call(*arguments: object) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of a command."""
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.output
    return result.exit_code, result.stdout, result.stderr


def test_from_sketch_to_plan(street: Path) -> None:
    assert call("check", street / "lamps.sketch")[0] == 0
    plan = street / "plan.txt"
    run = ("run", street / "lamps.sketch", street / "task.pddl", "--out", plan, "--json")
    status, output, _ = call(*run)
    report = json.loads(output)
    assert status == 0
    assert report["solved"]
    steps = [line for line in plan.read_text().splitlines() if not line.startswith(";")]
    assert len(steps) == report["actions"] == 6
    status, output, _ = call("validate", plan)
    assert status == 0
    assert "6 actions" in output
    plan.write_text("\n".join(steps[:-1]) + "\n")
    status, output, _ = call("validate", plan, "--scene", street / "task.pddl", "--json")
    assert status == 1
    assert "goal is not reached" in json.loads(output)["findings"][0]["message"]
    plan.write_text("(light b)\n")
    status, output, _ = call("validate", plan, "--scene", street / "task.pddl")
    assert status == 1
    assert "action 1 (light b): (at b) is false" in output


def test_what_is_wrong_has_a_place(street: Path) -> None:
    broken = street / "task.pddl"
    broken.write_text(TASK.replace("(at a)", "(att a)"))
    status, _, error = call("run", street / "lamps.sketch", broken)
    assert status == 2
    assert "task.pddl:3:82: there is no predicate `att`" in error
    assert "Did you mean `at`?" in error
    status, _, error = call("run", street / "lamps.sketch", street / "nowhere.pddl")
    assert status == 2
    assert "no such file" in error
    (street / "domain.pddl").rename(street / "other.pddl")
    status, _, error = call("run", street / "lamps.sketch", broken)
    assert status == 2
    assert "--domain-pddl" in error
    broken.write_text(TASK)
    run = ("run", street / "lamps.sketch", broken, "--domain-pddl", street / "other.pddl")
    assert call(*run)[0] == 0


def test_a_goal_that_cannot_be_reached(street: Path) -> None:
    task = street / "task.pddl"
    task.write_text(
        TASK.replace("(:goal", "(:goal (and (on-fire a)").replace("(lit ?x)))))", "(lit ?x))))))")
    )
    status, output, _ = call("run", street / "lamps.sketch", task)
    assert status == 1
    assert "can never be reached: (on-fire a) is false, and no action makes it true" in output


def parts_out_of_reach(goal: str) -> tuple[str, ...]:
    """What a goal asks for in vain: `p` is nowhere, `q` becomes true of `b` only, `r` is of `a`."""
    domain = read_domain(
        Source("d", "(define (domain d) (:predicates (p) (q ?x) (r ?x))"
               "(:action go :parameters (?x) :precondition (and (r ?x) (not (q ?x)))"
               " :effect (q ?x)))")
    )  # fmt: skip
    text = "(define (problem t) (:domain d) (:objects a b) (:init (r a) (q b)) (:goal {}))"
    return ground(read_task(Source("t", text.format(goal)), domain)).unreachable


def test_the_part_of_a_goal_that_is_out_of_reach_is_named() -> None:
    assert parts_out_of_reach("(and (q a) (q b))") == ()
    assert parts_out_of_reach("(and (q a) (p))") == ("(p) is false, and no action makes it true",)
    assert parts_out_of_reach("(and (q a) (not (r a)))") == (
        "(r a) is true, and no action makes it false",
    )
    assert parts_out_of_reach("(or (and (p) (r b)) (and (q a) (r b)))") == (
        "(r b) is false, and no action makes it true",
    )
    assert parts_out_of_reach("(= a b)") == ("`a` is not `b`",)
    assert parts_out_of_reach("(or (p) (q a))") == ()


def test_the_parts_of_a_goal_that_are_open_are_named(street: Path) -> None:
    (street / "lamps.sketch").write_text(
        'sketch lamps\nuse "domain.pddl"\nfeature n : nat = open_goals\n'
        "rule r { n = 0 } -> { n? }\n"
    )
    status, output, _ = call("run", street / "lamps.sketch", street / "task.pddl")
    assert status == 1
    assert "the goal is not reached: (lit c) is false" in output
