"""Walks, looks and steps: the subgoals of `run`, one at a time, forth and back."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from runtime.inspect.look import look
from runtime.inspect.stepping import Stepper
from runtime.inspect.walk import Walk
from runtime.solve import Task, open_task
from sketchlang.cli import cli
from sketchlang.loader import load_sketch
from tests.pddl.small_tasks import TASKS

ROOT = Path(__file__).parents[3]


def opened(sketch: str, scene: str) -> Task:
    return open_task(load_sketch(sketch).checked, scene)


def call(*arguments: str, text: str | None = None) -> Result:
    return CliRunner().invoke(cli, arguments, input=text)


@pytest.fixture
def task_file(tmp_path: Path) -> str:
    (tmp_path / "domain.pddl").write_text((ROOT / "domains/gripper/domain.pddl").read_text())
    (tmp_path / "task.pddl").write_text(TASKS["gripper"])
    return str(tmp_path / "task.pddl")


@pytest.mark.parametrize("sketch", ["delivery_s5", "delivery_s3", "delivery_s0"])
def test_a_walk_is_the_run_of_the_planner(sketch: str) -> None:
    task = opened(sketch, "delivery/walls")
    walk = Walk(task)
    outcome = opened(sketch, "delivery/walls").solve().outcome
    number = 0
    while walk.reach(number + 1) > number:
        number += 1
        assert walk.known == number  # no further than it was asked
        assert walk.subgoal(number).rule == outcome.subgoals[number - 1].rule
        assert walk.values(number) == task.sketch.evaluate(walk.state(number))
    assert number == len(outcome.subgoals)
    assert walk.ended
    assert walk.outcome.solved == outcome.solved
    assert walk.outcome.reason == outcome.reason
    # What was found is there again, in whatever order it is asked for.
    for back in (number, 0, number // 2):
        seen = look(walk, back)
        assert seen.reached == back
        assert tuple(one.value for one in seen.features) == walk.values(back)
        assert seen.end == (None if back < number else seen.end)


def test_where_a_run_ends_before() -> None:
    done = call("inspect", "delivery_s3", "delivery/one", "--after", "9")
    assert done.exit_code == 0
    assert "the run ends after 3 subgoals: the state of subgoal 1 again" in done.stdout
    data = json.loads(
        call("inspect", "delivery_s3", "delivery/one", "--after", "9", "--json").stdout
    )
    assert (data["asked"], data["after"], data["fired"]) == (9, 3, ["pick", "drop", "pick"])


def test_inspect_says_what_makes_a_value() -> None:
    data = json.loads(call("inspect", "delivery_s5", "delivery/four", "--json").stdout)
    features = {one["name"]: one for one in data["features"]}
    nearest = features["p"]["because"]["elements"][0]
    assert nearest["value"] == features["p"]["value"] == 4
    assert [one["element"] for one in features["n"]["because"]["elements"]] == list("abcd")
    assert data["applicable"] == ["pick", "deliver"]
    assert data["goal"] == {
        "holds": False,
        "conditions": [{"text": "n = 0", "feature": "n", "value": 4, "holds": False}],
    }


def test_inspect_of_a_pddl_task(task_file: str) -> None:
    done = call("inspect", "gripper", task_file, "--after", "1")
    assert done.exit_code == 0, done.output
    assert "after 1 subgoal" in done.stdout.splitlines()[0]
    assert "fired so far: pick" in done.stdout
    assert "drop applies: m > 0 (m is" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["delivery_s5", "delivery/none"], "there is no scene"),
        (["delivery_s5", "delivery/one", "--planner", "best"], "there is no planner 'best'"),
        (["delivery_s5", "delivery/one", "--robot", "tiago"], "has no robots"),
    ],
)
@pytest.mark.parametrize("command", ["inspect", "step"])
def test_bad_input(command: str, arguments: list[str], said: str) -> None:
    done = call(command, *arguments, text="\n")
    assert done.exit_code == 2
    assert said in done.output
    assert "Traceback" not in done.output


def test_stepping_forth_and_back() -> None:
    task = opened("delivery_s5", "delivery/one")
    stepper = Stepper(Walk(task))
    start = list(stepper.here())
    forth = stepper.answer("").lines
    assert forth[0].startswith("1  pick: move")
    assert forth[1].strip() == "{ !H } -> { H, p?, t? }"
    assert forth[2].strip() == "H: false -> true, p: 4 -> 0"
    assert stepper.answer("b").lines == tuple(start)
    assert stepper.answer("b").lines == ("this is the start",)
    assert stepper.answer("n").lines == forth
    assert "n = 0" in stepper.answer("g 2").lines[-2]
    assert stepper.answer("").lines == ("the goal is reached after 2 subgoals",)
    assert stepper.at == 2
    assert stepper.answer("g 0").lines == tuple(start)
    assert "the goal is reached" in stepper.answer("g 50").lines[0]
    assert stepper.at == 2


@pytest.mark.parametrize("text", ["g", "g x", "g -1", "g ²", "z", "f 3", "next"])
def test_what_is_no_command(text: str) -> None:
    task = opened("delivery_s5", "delivery/one")
    stepper = Stepper(Walk(task))
    (line,) = stepper.answer(text).lines
    assert "no command here" in line or line.startswith("say where to")
    assert stepper.at == 0


def test_stepping_by_a_pipe(task_file: str) -> None:
    done = call("step", "gripper", task_file, text="\nf\nr\ns\nq\n\n")
    assert done.exit_code == 0, done.output
    assert "1  pick: " in done.stdout
    assert "parts of the goal that do not hold" in done.stdout
    assert done.stdout.rstrip().endswith("> q")  # nothing after it
    without = call("step", "gripper", task_file, text="")
    assert without.exit_code == 2
    assert "standard input is no terminal and holds no commands" in without.stderr


@pytest.mark.slow
def test_a_walk_has_the_seed_of_the_run() -> None:
    checked = load_sketch("pick_and_place").checked
    places = []
    for seed in (0, 3):
        outcome = open_task(checked, "sorting/3t-02", seed).solve().outcome
        walk = Walk(open_task(checked, "sorting/3t-02", seed))
        assert walk.reach(2) == 2
        assert walk.state(2) == outcome.subgoals[1].states[-1]
        places.append(walk.state(2))
    assert places[0] != places[1]


@pytest.mark.slow
def test_a_tabletop_task_is_walked() -> None:
    text = "g 2\nf\ns\ng 99\n"
    done = call("step", "pick_and_place", "sorting/3t-02", text=text)
    assert done.exit_code == 0, done.output
    assert "2  put_at_goal: drive, place stick_" in done.stdout
    assert "one column is" in done.stdout
    assert "the goal is reached after 4 subgoals" in done.stdout
    assert (
        "it holds for" in call("inspect", "pick_and_place", "sorting/3t-02", "--after", "1").stdout
    )
