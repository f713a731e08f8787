"""`validate --sketch`: a plan is a run of its sketch, or what is wrong is told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from domains.tabletop.validation import validate
from runtime.judge.findings import Certificate
from sketchlang.cli.validate import command
from sketchlang.compile import CompiledSketch, compile_sketch
from sketchlang.errors import InputError
from sketchlang.loader import load_sketch
from tests.runtime.plans import Json, actions, parse


@pytest.fixture(scope="module")
def sketch() -> CompiledSketch:
    return compile_sketch(load_sketch("pick_and_place").checked)


@pytest.fixture
def judge(tmp_path: Path, sketch: CompiledSketch) -> Any:
    def verdict(data: Json) -> Certificate:
        return validate(parse(tmp_path, data), sketch=sketch)

    return verdict


def refused(certificate: Certificate, word: str) -> None:
    assert any(word in finding.message for finding in certificate.findings), certificate.findings


def test_a_produced_plan_is_a_run(judge, plan_data) -> None:
    assert judge(plan_data).valid


def test_features_that_are_not_so_are_told(judge, plan_data) -> None:
    first, second = plan_data["subgoals"][:2]
    first["before"]["m"] += 1
    refused(judge(plan_data), "m is")
    first["before"]["m"] -= 1
    first["after"]["m"] += 1
    refused(judge(plan_data), "at the start of subgoal 2")  # found without a sketch
    second["before"]["m"] += 1
    refused(judge(plan_data), "m is")
    first["after"]["m"] -= 1
    second["before"]["m"] -= 1
    first["before"]["z"] = 0
    refused(judge(plan_data), "no feature z")


def test_a_rule_that_is_not_satisfied_is_told(judge, plan_data) -> None:
    first, second = plan_data["subgoals"][:2]
    first["rule"], second["rule"] = second["rule"], first["rule"]
    refused(judge(plan_data), "does not satisfy the rule")
    first["rule"] = "none_such"
    refused(judge(plan_data), "has no rule none_such")


def test_actions_that_say_another_thing_than_the_motions_are_told(judge, plan_data) -> None:
    number = actions(plan_data, "place")[0]
    plan_data["actions"][number]["arguments"]["placement"][0] += 500  # 5 mm
    refused(judge(plan_data), "5.0 mm from where its action puts it")


def test_arguments_that_are_none_are_an_error_of_the_file(judge, plan_data) -> None:
    number = actions(plan_data, "pick")[0]
    plan_data["actions"][number]["arguments"]["object"] = "nobody"
    with pytest.raises(InputError, match="no arguments of pick"):
        judge(plan_data)
    plan_data["actions"][number]["name"] = "juggle"
    with pytest.raises(InputError, match="no action 'juggle'"):
        judge(plan_data)


def test_the_command_takes_a_sketch(tmp_path, plan_data) -> None:
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(plan_data), encoding="utf-8")
    done = CliRunner().invoke(command, [str(path), "--sketch", "pick_and_place"])
    assert done.exit_code == 0, done.output
    plan_data["subgoals"][-1]["after"]["H"] = 1
    path.write_text(json.dumps(plan_data), encoding="utf-8")
    assert CliRunner().invoke(command, [str(path)]).exit_code == 0  # motions alone are good
    done = CliRunner().invoke(command, [str(path), "--sketch", "pick_and_place"])
    assert done.exit_code == 1
    assert "H is 0, the plan says 1" in done.output
