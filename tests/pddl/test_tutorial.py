"""docs/tutorial-pddl.md does what it says."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks import logistics_tasks
from domains.pddl import bench
from runtime.bench import store
from runtime.bench.job import key, new_result
from runtime.bench.runner import run_job
from sketchlang.cli import cli
from tests.pddl.small_tasks import TASKS

DOMAINS = Path(__file__).parents[2] / "domains"
PAGE = Path(__file__).parents[2] / "docs" / "tutorial-pddl.md"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The tutorial's files, in the current folder."""
    monkeypatch.chdir(tmp_path)
    logistics_tasks.main(Path("tasks"))
    for name, text in re.findall(r"```sketch (\S+)\n(.*?)```", PAGE.read_text(), re.DOTALL):
        Path(name).write_text(text)
    return tmp_path


def commands() -> list[list[str]]:
    """The commands of the page, in order."""
    lines = re.findall(r"^    sketchlang (.*)$", PAGE.read_text(), re.MULTILINE)
    return [line.split() for line in lines]


def test_every_command_succeeds(folder: Path) -> None:
    found = commands()
    assert [words[0] for words in found].count("check") == 2
    for words in found:
        if words[0] != "bench":
            result = CliRunner().invoke(cli, words)
            assert result.exit_code == 0, (words, result.output)
            assert "warning" not in result.output


@pytest.mark.slow
def test_the_twenty_tasks_are_solved(folder: Path) -> None:
    (words,) = [words for words in commands() if words[0] == "bench"]
    result = CliRunner().invoke(cli, [*words, "--jobs", "2"])
    assert result.exit_code == 0, result.output
    assert "20/20 | 20/20 |" in result.output
    runs = [json.loads(line) for line in Path("bench-ipc.jsonl").read_text().splitlines()]
    assert {run["sketch"] for run in runs} == {"stages"}


def test_a_sketch_is_found_for_a_folder(tmp_path: Path) -> None:
    for name in ("barman-sat11-strips", "somewhere"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "domain.pddl").write_text("(define (domain child-snack))")
        (tmp_path / name / "p1.pddl").touch()
    assert bench.sketch_for(tmp_path / "barman-sat11-strips" / "p1.pddl") == "barman"
    assert bench.sketch_for(tmp_path / "somewhere" / "p1.pddl") == "childsnack"


def test_tasks_are_found_below_links_and_circles(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    for name in ("domain.pddl", "p10.pddl", "p2.pddl"):
        (tmp_path / "far" / name).write_text("(define (domain child-snack))")
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "tasks").symlink_to(tmp_path / "far")
    (tmp_path / "far" / "back").symlink_to(tmp_path / "here")
    (block,) = bench.suite_of(tmp_path / "here", None).blocks
    assert [Path(scene).name for scene in block.scenes] == ["p2.pddl", "p10.pddl"]


def test_a_benchmark_goes_on_where_it_ended(folder: Path) -> None:
    """Its results are read again by the store that keeps them."""
    job = bench.suite_of(Path("tasks"), "tasks/stages.sketch").jobs()[0]
    with store.opened(Path("results.jsonl")) as results:
        results.append(new_result(job, run_job(job)))
    (found,) = store.read_results(Path("results.jsonl"))
    assert key(found) == job
    assert found["valid"]


def test_a_folder_of_tasks_bears_the_name_of_its_sketch(tmp_path: Path) -> None:
    (tmp_path / "gripper").mkdir()
    (tmp_path / "gripper" / "p1.pddl").write_text(TASKS["gripper"])
    shutil.copy(DOMAINS / "gripper" / "domain.pddl", tmp_path / "gripper")
    words = ["bench", "ipc", "--tasks", str(tmp_path), "--jobs", "1"]
    done = CliRunner().invoke(cli, [*words, "--out", str(tmp_path / "out.jsonl")])
    assert done.exit_code == 0, done.output
    assert "1/1" in done.output
