"""`list` and `show`: everything that comes along can be listed and shown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from runtime.inspect.catalogue import KINDS, head
from runtime.search.planners import PLANNERS
from sketchlang.cli import cli
from sketchlang.library import built_in_scenes
from sketchlang.loader import builtin_sketches, domain_names
from tests.pddl.small_tasks import TASKS

ROOT = Path(__file__).parents[3]


def call(*arguments: str) -> Result:
    return CliRunner().invoke(cli, arguments)


def shown(*arguments: str) -> dict:
    done = call("show", *arguments, "--json")
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


def test_list_has_everything_with_a_line_about_it() -> None:
    done = call("list", "--json")
    assert done.exit_code == 0
    data = json.loads(done.stdout)
    assert list(data) == list(KINDS)
    names = {kind: [entry["name"] for entry in entries] for kind, entries in data.items()}
    assert names["sketches"] == builtin_sketches()
    assert names["scenes"] == built_in_scenes()
    assert names["domains"] == domain_names()
    assert {"tiago", "ur5e_desk"} <= set(names["robots"])
    assert [entry for entries in data.values() for entry in entries if not entry["about"]] == []
    assert {entry["domain"] for entry in data["sketches"]} <= set(domain_names())


def test_list_of_one_kind_has_columns() -> None:
    lines = call("list", "planners").stdout.splitlines()
    assert len(lines) == len(PLANNERS)
    assert lines[0].startswith("lazy-siiw-r  ")
    assert lines[1].startswith("siw-r        ")
    assert call("list", "tables").exit_code == 2


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("# One thing. And more.\nx = 1", "One thing"),
        ("# A thing that goes\n# on. And on.\n", "A thing that goes on"),
        ("x = 1\n# later", ""),
        ("# Version 1.5 of it", "Version 1.5 of it"),
    ],
)
def test_the_line_about_a_file(text: str, sentence: str) -> None:
    assert head(text) == sentence


def test_a_domain_is_shown() -> None:
    domain = shown("delivery")["domain"]
    functions = {one["name"]: one for one in domain["functions"]}
    assert functions["distance"] == {
        "name": "distance",
        "parameters": ["Package"],
        "result": "nat",
        "about": "Steps from the agent to the package; 0 if the agent carries it.",
    }
    assert set(domain["atoms"]) == {"agent_at", "package_at", "holding"}
    assert len(domain["actions"]) == 3
    text = call("show", "delivery").stdout
    assert "distance(Package) : nat" in text
    assert "packages : set of Package" in text


def test_a_name_of_two_kinds_is_shown_as_both() -> None:
    assert set(shown("gripper")) == {"domain", "sketch"}
    assert set(shown("gripper", "--as", "sketch")) == {"sketch"}


def test_a_sketch_is_shown_with_what_it_includes() -> None:
    sketch = shown("delivery_s5")["sketch"]
    assert [one["name"] for one in sketch["features"]] == ["H", "p", "t", "n"]
    assert sketch["rules"][0] == {
        "name": "pick",
        "conditions": ["!H"],
        "effects": ["H", "p?", "t?"],
    }
    text = call("show", "delivery_s5").stdout
    assert text.index("feature H") < text.index("rule pick")


def test_pddl_files_are_shown(tmp_path: Path) -> None:
    (tmp_path / "domain.pddl").write_text((ROOT / "domains/gripper/domain.pddl").read_text())
    (tmp_path / "task.pddl").write_text(TASKS["gripper"])
    domain = shown(str(tmp_path / "domain.pddl"))["domain"]
    assert "at_robby" in [one["name"] for one in domain["functions"]]
    assert any(name.startswith("pick(") for name in domain["actions"])
    lines = shown(str(tmp_path / "task.pddl"))["scene"]["lines"]
    assert "objects" in lines
    assert "goal" in lines
    assert any(line.strip().startswith("(at ") for line in lines[lines.index("goal") :])


def test_a_robot_is_shown() -> None:
    robot = shown("ur5e_desk")["robot"]
    assert robot["base"]["type"] == "fixed"
    assert len(robot["joints"]) == 6
    assert all(one["lower"] <= one["home"] <= one["upper"] for one in robot["joints"])
    assert robot["gripper"]["min_opening_m"] < robot["gripper"]["max_opening_m"]
    path = ROOT / "runtime" / "robot" / "ur5e_desk" / "ur5e_desk.toml"
    assert shown(str(path)) == {"robot": robot}


def test_scenes_of_other_domains_are_shown(tmp_path: Path) -> None:
    assert "A . # . a ." in call("show", "delivery/walls").stdout
    copy = tmp_path / "mine.toml"
    copy.write_text((ROOT / "domains/blocks/scenes/three.toml").read_text())
    done = call("show", str(copy), "--domain", "blocks")
    assert "tower: c b a" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["sorting/4t-70"], "did you mean 'sorting/4t-07'?"),
        (["tiago", "--as", "sketch"], "there is no sketch 'tiago'"),
        (["README.md"], "neither a domain, a scene, a robot nor a sketch"),
        (["delivery/one", "--svg", "x.svg"], "is no scene that could be drawn"),
        (["delivery/one", "--domain", "nothing"], "there is no domain 'nothing'"),
    ],
)
def test_what_cannot_be_shown(
    arguments: list[str], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    done = call("show", *arguments)
    assert done.exit_code == 2
    assert said in done.output
    assert not Path("x.svg").exists()


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("kitchen/tidy", "domains/kitchen/scenes/tidy.toml"),
        ("tiago", "runtime/robot/tiago/tiago.toml"),
        ("pick_and_place", "domains/pick_and_place.sketch"),
    ],
)
def test_the_source_of_what_comes_along_can_be_printed(name, path) -> None:
    done = call("show", name, "--source")
    assert done.exit_code == 0, done.output
    assert done.output == (ROOT / path).read_text(encoding="utf-8")
    assert call("show", name, "--source", "--json").exit_code == 2
