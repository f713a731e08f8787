"""`sketchlang run` end to end: contracts, exit codes, and the same plan for the same seed."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from runtime.report import step_in_words
from runtime.search.siw_r import Retreat
from runtime.solve import open_task
from sketchlang.cli.run import command as run
from sketchlang.cli.validate import command as validate
from sketchlang.loader import load_sketch
from tests.conftest import sketchlang
from tests.runtime.robot.robots import TOML, write_robot
from tests.tabletop.scene.texts import SCENE, TABLES, WORD, write_scene
from tests.tabletop.tasks import AT, stick

ROOT = Path(__file__).parents[2]
CONTRACT = {
    "sketch", "scene", "planner", "robot", "seed", "solved", "planning_time_s",
    "execution_time_s", "expanded", "generated", "subplans", "actions", "motion_plans",
    "retreats", "rules_fired", "profile", "version", "execution_lower_bound_s",
}  # fmt: skip
UNSOLVED = (CONTRACT - {"execution_lower_bound_s"}) | {"reason", "stuck", "why"}
STEPS = ["in_arm_workspace", "inverse_kinematics", "motion_plan"]

LARGE = (
    '[[table]]\nname = "large"\nat = [-8.0, 0.0]\nsize = [6.0, 6.0]\ntop = 0.765\nrest = 0.767\n'
)
UNREACHABLE = "\n".join(
    ["robot_start = [-0.5, 0.0, 0.0]", TABLES[TABLES.index("[[table]]") :], LARGE,
     stick("a", 0.8, 0.6), AT.format("a", -8.0, 0.0)]
)  # fmt: skip


def plan(*arguments: str) -> Result:
    return CliRunner().invoke(run, ["pick_and_place", *arguments])


def report(*arguments: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(plan(*arguments, "--json").stdout)
    return found


# -- solved ------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [0, 1])
def test_a_scene_is_solved_by_its_name_and_the_plan_is_valid(tmp_path, seed) -> None:
    path = tmp_path / "plan.json"
    done = plan("sorting/3t-02", "--seed", str(seed), "--out", str(path))
    assert done.exit_code == 0
    assert "solved" in done.stdout
    verdict = CliRunner().invoke(validate, [str(path)])
    assert verdict.exit_code == 0, verdict.output
    assert "is valid" in verdict.stdout


@pytest.mark.parametrize("planner", ["siw-r", "lazy-siiw-r"])
def test_json_has_the_keys_of_the_contract(planner) -> None:
    found = report("sorting/3t-02", "--seed", "1", "--planner", planner)
    assert set(found) == CONTRACT
    assert found["sketch"] == "pick_and_place"
    assert found["scene"] == "sorting/3t-02"
    assert found["planner"] == planner
    assert found["seed"] == 1
    assert found["solved"] is True
    assert found["subplans"] == sum(found["rules_fired"].values())
    assert found["actions"] >= found["subplans"]
    assert list(found["profile"]) == STEPS
    for step in found["profile"].values():
        assert set(step) == {"calls", "successes", "time_s"}
        assert 0 <= step["successes"] <= step["calls"]


def test_the_counts_of_the_report_are_those_of_the_plan(tmp_path) -> None:
    path = tmp_path / "plan.json"
    found = report("sorting/3t-02", "--out", str(path))
    written = json.loads(path.read_text())
    assert found["subplans"] == len(written["subgoals"])
    assert found["actions"] == len(written["actions"])
    seconds = sum(p["times"][-1] for a in written["actions"] for p in a["pieces"])
    assert found["execution_time_s"] == pytest.approx(seconds, abs=0.01)


def test_a_scene_that_is_solved_already_has_an_empty_valid_plan(tmp_path) -> None:
    scene = write_scene(tmp_path, SCENE.replace('on = "right"', 'on = "left"').replace(
        "at = [0.9, -1.0]", 'at = "start"'))  # fmt: skip
    path = tmp_path / "plan.json"
    found = report(str(scene), "--out", str(path))
    assert found["solved"] is True
    assert (found["subplans"], found["actions"]) == (0, 0)
    assert CliRunner().invoke(validate, [str(path)]).exit_code == 0


def test_stdout_is_json_alone_and_stderr_is_empty_in_a_process_of_its_own() -> None:
    """No warnings of libraries, no reports of leaks when the process ends."""
    done = sketchlang("run", "pick_and_place", "sorting/3t-02", "--json")
    assert done.returncode == 0
    assert done.stderr == ""
    assert set(json.loads(done.stdout)) == CONTRACT


def test_progress_is_on_stderr_and_nothing_else() -> None:
    done = sketchlang("run", "pick_and_place", "sorting/3t-02")
    assert done.returncode == 0
    lines = done.stderr.splitlines()
    assert "pick_and_place on sorting/3t-02" in lines[0]
    assert all(" s  " in line for line in lines[1:])


def test_validate_is_silent_on_stderr_in_a_process_of_its_own(plan_file) -> None:
    done = sketchlang("validate", str(plan_file))
    assert (done.returncode, done.stderr) == (0, "")
    assert "goal reached" in done.stdout


def test_the_same_seed_gives_the_same_file_in_two_processes(tmp_path, plan_file) -> None:
    again = tmp_path / "again.json"
    arguments = ["run", "pick_and_place", "sorting/3t-02", "--seed", "0", "--out", str(again)]
    assert sketchlang(*arguments).returncode == 0
    assert again.read_bytes() == plan_file.read_bytes()


def test_the_same_seed_gives_the_same_file_after_other_runs(tmp_path, plan_file) -> None:
    """What was planned before in a process leaves no trace in a plan."""
    again = tmp_path / "again.json"
    plan("sorting/3t-02", "--seed", "5")
    plan("sorting/3t-02", "--seed", "0", "--out", str(again))
    assert again.read_bytes() == plan_file.read_bytes()


def test_another_seed_gives_another_plan(tmp_path, plan_file) -> None:
    other = tmp_path / "other.json"
    plan("sorting/3t-02", "--seed", "1", "--out", str(other))
    assert json.loads(other.read_text())["actions"] != json.loads(plan_file.read_text())["actions"]


# -- not solved --------------------------------------------------------------------------------


def test_an_unreachable_goal_ends_in_time_and_says_why(tmp_path) -> None:
    scene = write_scene(tmp_path, UNREACHABLE)
    out = tmp_path / "plan.json"
    started = time.monotonic()
    done = plan(str(scene), "--timeout", "1", "--json", "--out", str(out))
    assert time.monotonic() - started < 60  # and not for ever
    assert done.exit_code == 1
    found = json.loads(done.stdout)
    assert set(found) >= UNSOLVED
    assert found["solved"] is False
    assert found["planning_time_s"] < 30  # a limit that holds, however busy the machine is
    assert found["reason"]
    assert set(found["stuck"]) == {"H", "I", "m", "u", "v"}
    assert found["stuck"]["m"] == 1
    assert not out.exists()


def test_an_unsolved_run_shows_what_each_step_rejected(tmp_path) -> None:
    done = plan(str(write_scene(tmp_path, UNREACHABLE)), "--timeout", "1")
    assert done.exit_code == 1
    assert "not solved after" in done.stdout
    assert "the features are H = 0" in done.stdout
    for step in STEPS:
        line = next(line for line in done.stdout.splitlines() if step in line)
        assert "rejected" in line


def test_a_time_limit_is_kept_and_what_was_reached_is_said() -> None:
    found = report("sorting/4t-28", "--timeout", "0.05")
    assert found["solved"] is False
    assert "time limit of 0.05 s" in found["reason"]
    assert found["planning_time_s"] < 30  # a limit that holds, however busy the machine is
    assert found["stuck"]["m"] > 0


# -- bad input ---------------------------------------------------------------------------------


def bad(*arguments: str) -> str:
    """What is said on stderr about bad input: exit 2, nothing on stdout, no traceback."""
    done = CliRunner().invoke(run, list(arguments))
    assert done.exit_code == 2, done.output
    assert done.exception is None or isinstance(done.exception, SystemExit)
    assert not done.stdout
    return done.stderr


def test_unknown_names_come_with_what_was_probably_meant() -> None:
    assert "sorting/4t-07" in bad("pick_and_place", "sorting/4t_07")
    assert "pick_and_place" in bad("pick_and_plaice", "sorting/3t-02")
    assert "built in" in bad("pick_and_place", "sorting/3t-02", "--robot", "marvin")


def test_missing_files_are_named(tmp_path) -> None:
    missing = str(tmp_path / "missing")
    assert f"{missing}.toml" in bad("pick_and_place", f"{missing}.toml")
    assert missing in bad("pick_and_place", "sorting/3t-02", "--robot", f"{missing}.toml")
    assert missing in bad("pick_and_place", "sorting/3t-02", "--out", f"{missing}/plan.json")


def test_a_missing_folder_is_refused_before_planning(tmp_path) -> None:
    said = bad("pick_and_place", "sorting/3t-02", "--out", str(tmp_path / "missing" / "plan.json"))
    assert "folder" in said
    assert " s  " not in said


@pytest.mark.parametrize(
    "arguments",
    [
        ("--seed", "-1"),
        ("--seed", "x"),
        ("--timeout", "0"),
        ("--timeout", "-1"),
        ("--k-max", "0"),
        ("--planner", "astar"),
        ("--robot", "a" * 300),
    ],
)
def test_options_out_of_range_are_refused(arguments) -> None:
    assert bad("pick_and_place", "sorting/3t-02", *arguments)


def test_a_name_that_is_too_long_for_a_file_is_an_unknown_scene() -> None:
    assert "there is no scene" in bad("pick_and_place", "a" * 300)


def test_scenes_of_another_domain_are_refused() -> None:
    said = bad("pick_and_place", "delivery/one")
    assert "delivery/scenes/one.toml:2: unknown key 'map'" in said
    assert "the key 'robot_start' is missing" in said


def test_an_object_in_a_table_is_refused_with_place_and_hint(tmp_path) -> None:
    scene = write_scene(tmp_path, SCENE.replace("at = [0.7, 0.5]", "at = [0.7, 0.5]\nbottom = 0.5"))
    said = bad("pick_and_place", str(scene))
    line = 1 + scene.read_text().splitlines().index("bottom = 0.5")
    assert f"{scene}:{line}: [[object]] blue1: bottom: " in said
    assert "objects on 'left' rest at 0.767 m, not 0.5 m" in said
    assert "hint: " in said


def test_a_robot_for_a_domain_without_robots_is_refused() -> None:
    found = CliRunner().invoke(run, ["delivery_policy", "delivery/one", "--robot", "tiago"])
    assert found.exit_code == 2
    assert "no robots" in found.output
    assert CliRunner().invoke(run, ["delivery_policy", "delivery/one"]).exit_code == 0


def test_an_older_plan_is_left_alone_where_none_is_found(tmp_path) -> None:
    scene, older = write_scene(tmp_path, UNREACHABLE), tmp_path / "plan.json"
    older.write_text("older")
    found = plan(str(scene), "--timeout", "0.5", "--out", str(older))
    assert found.exit_code == 1
    assert "left as it was" in found.output
    assert older.read_text() == "older"


def test_a_robot_that_starts_in_a_table_is_refused(tmp_path) -> None:
    scene = write_scene(tmp_path, SCENE.replace("[-0.5, 0.0, 0.0]", "[0.8, 0.6, 0.0]"))
    said = bad("pick_and_place", str(scene))
    assert "robot_start" in said
    assert "cannot stand at (0.8, 0.6)" in said


def test_a_broken_robot_file_is_named(tmp_path) -> None:
    robot = write_robot(tmp_path, TOML.replace("swing", "sving"))
    assert str(robot) in bad("pick_and_place", "sorting/3t-02", "--robot", str(robot))


def test_a_sketch_with_mistakes_is_refused_with_all_of_them(tmp_path) -> None:
    sketch = tmp_path / "bad.sketch"
    sketch.write_text(
        "sketch bad\nuse tabletop\nfeature n : nat = count o in things: misplaced(o)\n"
        "goal { m = 0 }\nrule r { n > 0 } -> { n--, p }\n"
    )
    said = bad(str(sketch), "sorting/3t-02")
    assert all(word in said for word in ("things", "m", "p"))


def test_a_sketch_without_definitions_cannot_be_run(tmp_path) -> None:
    sketch = tmp_path / "abstract.sketch"
    sketch.write_text(
        "sketch abstract\nuse tabletop\nfeature n : nat\ngoal { n = 0 }\n"
        "rule r { n > 0 } -> { n-- }\n"
    )
    assert bad(str(sketch), "sorting/3t-02")


def test_a_word_that_cannot_be_spelt_is_refused(tmp_path) -> None:
    scene = write_scene(tmp_path, WORD.replace('"AB"', '"ABC"'))
    assert "letters C" in bad("pick_and_place", str(scene))


# -- all seeds ---------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["sorting/3t-02", "sorting/4t-07"])
def test_ten_seeds_are_solved_and_every_plan_is_valid(tmp_path: Path, scene: str) -> None:
    for seed in range(10):
        path = tmp_path / f"{seed}.json"
        found = report(scene, "--seed", str(seed), "--out", str(path))
        assert found["solved"], (seed, found["reason"])
        assert found["planning_time_s"] < 30
        verdict = CliRunner().invoke(validate, [str(path)])
        assert verdict.exit_code == 0, (seed, verdict.output)


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["sorting/3t-02", "sorting/4t-07"])
def test_both_planners_are_valid(tmp_path: Path, scene: str) -> None:
    for planner in ("siw-r", "lazy-siiw-r"):
        path = tmp_path / f"{planner}.json"
        assert report(scene, "--planner", planner, "--out", str(path))["solved"]
        assert CliRunner().invoke(validate, [str(path)]).exit_code == 0


@pytest.mark.slow
def test_memory_stays_under_a_gigabyte(tmp_path: Path) -> None:
    script = (
        "import atexit, sys; from sketchlang.cli import main\n"
        "from sketchlang.analysis.limits import peak_memory_mb\n"
        "atexit.register(lambda: print(peak_memory_mb(), file=sys.stderr))\n"
        "main()\n"
    )
    command = [sys.executable, "-c", script, "run", "pick_and_place", "sorting/4t-07", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0
    assert float(done.stderr.split()[-1]) < 1024


@pytest.mark.parametrize(
    ("retreat", "words"),
    [(Retreat(8, 7), "back 1 subgoal,"), (Retreat(8, 0), "back to the start,")],
)
def test_it_is_told_how_far_a_run_goes_back(retreat, words) -> None:
    task = open_task(load_sketch("delivery_policy").checked, "delivery/four")
    said = step_in_words(task, retreat)
    assert said.startswith("stuck after 8 subgoals: ")
    assert words in said
