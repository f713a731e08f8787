"""What the README shows is what the commands say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import COMMANDS, cli
from sketchlang.version import __version__
from tests.pages import run_page

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def shown(command: str) -> str:
    """The output under a command, up to the next one or the end of the block."""
    block = README.partition(f"    $ sketchlang {command}\n")[2]
    lines = []
    for line in block.splitlines():
        if (line and not line.startswith("    ")) or line.startswith("    $ "):
            break
        lines.append(line[4:])
    return "\n".join(lines).strip() + "\n"


def test_the_proof() -> None:
    done = CliRunner().invoke(cli, ["terminate", "pick_and_place"])
    assert done.exit_code == 0
    assert done.stdout == shown("terminate pick_and_place")


def test_the_refutation(tmp_path, monkeypatch) -> None:
    """`v?` in place of `!v++` in the first rule, as the README says."""
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "domains" / "pick_and_place.sketch").read_text(encoding="utf-8")
    Path("careless.sketch").write_text(text.replace("!v++", "v?", 1), encoding="utf-8")
    done = CliRunner().invoke(cli, ["terminate", "careless.sketch"])
    assert done.exit_code == 1
    assert done.stdout == shown("terminate careless.sketch")


def test_the_sketch_is_the_one_that_comes_along() -> None:
    text = (ROOT / "domains" / "pick_and_place.sketch").read_text(encoding="utf-8")
    block = README.partition("    sketch pick_and_place\n")[2].partition("\n`m--` falls")[0]
    lines = [" ".join(line.split()) for line in block.splitlines() if line.strip()]
    ours = " ".join(re.sub(r"#.*", "", text).split())
    assert len(lines) > 10
    assert [line for line in lines if line not in ours] == []


def test_every_command_is_listed_once() -> None:
    table = README.partition("has examples for each command:")[2].partition("[`CONTRIBUTING")[0]
    assert sorted(re.findall(r"`([a-z]+)`", table)) == sorted(COMMANDS)


def test_the_scenes_and_robots_are_there() -> None:
    from runtime.robot.load import built_in_robots
    from sketchlang.library import find_scene

    part = README.partition("## Scenes and robots")[2].partition("## A proof")[0]
    for name in re.findall(r"`([a-z_]+/[\w-]+)`", part):
        assert find_scene(name)[1] == name
    assert all(f"`{name}`" in part for name in set(built_in_robots()) - {"tiago"})


@pytest.mark.slow
def test_the_run(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    run = "run pick_and_place sorting/4t-07 --out plan.json"
    done = CliRunner().invoke(cli, run.split())
    assert done.exit_code == 0
    judged = CliRunner().invoke(cli, ["validate", "plan.json"])
    assert judged.exit_code == 0
    assert summary(shown(run)) == summary(done.output)
    assert summary(shown("validate plan.json")) == summary(judged.output)


def summary(text: str) -> list[str]:
    """The lines that say what came of it; times, and counts that any change of the planner moves,
    are left out."""
    lines = [line for line in text.splitlines() if line.startswith(("solved", "rules", "plan"))]
    assert lines
    return [re.sub(r"[\d.]+(?= (s\b|robot configurations))", "N", line) for line in lines]


@pytest.mark.slow
def test_the_first_sketch(tmp_path) -> None:
    """The section is a page of its own: executed as it is written."""
    section = README.partition("## Your first sketch")[2].partition("\n## ")[0]
    page = tmp_path / "first.md"
    page.write_text(section, encoding="utf-8")
    (tmp_path / "here").mkdir()
    run_page(page, tmp_path / "here")


def test_the_citation_is_yaml_with_the_version_of_the_package() -> None:
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {__version__}\n" in text
    for key in ("cff-version", "message", "title", "authors"):
        assert re.search(rf"^{key}:", text, re.M)
