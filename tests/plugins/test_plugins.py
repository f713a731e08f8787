"""Domains that are extended by one file outside the repository, used as their authors use them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from sketchlang.cli import cli
from tests.tabletop.scene.texts import TABLES
from tests.tabletop.tasks import ON_RIGHT, stick

HERE = Path(__file__).parent
PAGE = HERE.parent.parent / "docs" / "extending.md"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder with the files of the documentation."""
    for name in ("push.py", "push.sketch", "crate.toml", "boards.py", "clear.sketch"):
        shutil.copy(HERE / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def sketchlang(*arguments: str) -> Result:
    return CliRunner().invoke(cli, list(arguments))


def succeed(*arguments: str) -> str:
    done = sketchlang(*arguments)
    assert done.exit_code == 0, done.output
    return done.output


@pytest.mark.parametrize("name", ["push.py", "push.sketch", "crate.toml", "boards.py"])
def test_the_page_shows_the_files_that_are_tested(name) -> None:
    assert f"\n{(HERE / name).read_text()}```\n" in PAGE.read_text()


@pytest.mark.parametrize("planner", ["siw-r", "lazy-siiw-r"])
def test_a_push_runs_validates_and_replays(folder, planner) -> None:
    plugin = ("--domain", "push.py")
    succeed("check", "push.sketch", *plugin)
    succeed("terminate", "push.sketch", *plugin)
    out = ("--out", "plan.json", "--planner", planner)
    succeed("run", "push.sketch", "crate.toml", *plugin, *out)
    assert "is valid" in succeed("validate", "plan.json")
    succeed("replay", "plan.json", "--sketch", "push.sketch", *plugin, "--html", "replay.html")
    assert "push crate" in (folder / "replay.html").read_text()
    succeed("export", "plan.json", "--sketch", "push.sketch", *plugin, "--trajectory", "t.json")
    plan = json.loads((folder / "plan.json").read_text())
    names = [action["name"] for action in plan["actions"]]
    assert set(names) == {"move_base", "push"}


def test_a_rule_on_the_robots_distance_fires_on_a_drive_alone(folder) -> None:
    succeed("run", "push.sketch", "crate.toml", "--domain", "push.py", "--out", "plan.json")
    plan = json.loads((folder / "plan.json").read_text())
    assert plan["subgoals"][0]["rule"] == "come_near"
    first = [action["name"] for action in plan["actions"] if action["subgoal"] == 0]
    assert first == ["move_base"]
    assert plan["subgoals"][0]["before"]["N"] == 0
    assert plan["subgoals"][0]["after"]["N"] == 1


def test_a_push_goes_around_a_corner_in_two(folder) -> None:
    scene = folder / "crate.toml"
    scene.write_text(scene.read_text().replace("[0.85, 0.6]", "[0.85, 0.68]"))
    succeed("run", "push.sketch", "crate.toml", "--domain", "push.py", "--out", "plan.json")
    assert "is valid" in succeed("validate", "plan.json")
    actions = json.loads((folder / "plan.json").read_text())["actions"]
    sides = {action["arguments"]["side"] for action in actions if action["name"] == "push"}
    assert len(sides) == 2


def test_nothing_is_pushed_into_what_stands_in_the_way(folder) -> None:
    with (folder / "crate.toml").open("a") as file:
        file.write('\n[[object]]\nname = "post"\nsize = [0.2, 0.2, 0.3]\nat = [0.93, 0.6]\n')
    done = sketchlang("run", "push.sketch", "crate.toml", "--domain", "push.py", "--k-max", "1")
    assert done.exit_code == 1, done.output


def pushed(plan: dict[str, Any]) -> dict[str, Any]:
    """The piece of a plan in which something is pushed."""
    (action,) = [action for action in plan["actions"] if action["name"] == "push"]
    (piece,) = [piece for piece in action["pieces"] if piece.get("along")]
    return piece


@pytest.mark.parametrize(
    ("axis", "by", "says"),
    [
        (0, 0.03, "mm away from it"),
        (2, 0.01, "moved along, but not on what"),
        (1, 0.02, "does not start where it is"),
    ],
)
def test_a_body_that_is_moved_in_a_way_that_no_push_does_is_refused(folder, axis, by, says) -> None:
    succeed("run", "push.sketch", "crate.toml", "--domain", "push.py", "--out", "plan.json")
    plan = json.loads((folder / "plan.json").read_text())
    (along,) = pushed(plan)["along"]
    for pose in along["poses"][0 if axis == 1 else 1 :]:
        pose[axis] += by
    (folder / "plan.json").write_text(json.dumps(plan))
    done = sketchlang("validate", "plan.json")
    assert done.exit_code == 1, done.output
    assert says in done.output


def test_a_sort_and_two_functions(folder) -> None:
    sticks = [stick("a", 0.7, 0.5), stick("b", 0.9, 0.7), stick("c", 0.8, -0.9)]
    goals = [ON_RIGHT.format(name) for name in "ab"]
    text = "robot_start = [-0.5, 0.0, 0.0]\n" + TABLES + "\n".join(sticks + goals)
    (folder / "scene.toml").write_text(text)
    succeed("terminate", "clear.sketch", "--domain", "boards.py")
    out = ("--out", "plan.json")
    succeed("run", "clear.sketch", "scene.toml", "--domain", "boards.py", *out)
    assert "is valid" in succeed("validate", "plan.json")
    plan = json.loads((folder / "plan.json").read_text())
    assert [subgoal["rule"] for subgoal in plan["subgoals"]] == ["take", "put"] * 2
    assert [subgoal["before"]["t"] for subgoal in plan["subgoals"]] == [1, 1, 1, 0]


def test_without_its_plugin_a_sketch_says_what_is_missing(folder) -> None:
    done = sketchlang("check", "push.sketch")
    assert done.exit_code == 1
    assert "beside" in done.output
