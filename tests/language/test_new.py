"""A newcomer's path: `new domain`, edit, `check`, `run`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import cli

ROOT = Path(__file__).parents[2]


@pytest.fixture
def hanoi(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(cli, ["new", "domain", "hanoi"])
    assert result.exit_code == 0, result.output
    return tmp_path / "hanoi"


def test_it_works_as_written(hanoi: Path) -> None:
    for command in (["check"], ["terminate"], ["fmt", "--check"]):
        arguments = [*command, "hanoi/hanoi.sketch"]
        if command != ["fmt", "--check"]:
            arguments += ["--domain", "hanoi/hanoi.py"]
        result = CliRunner().invoke(cli, arguments)
        assert result.exit_code == 0, result.output
    for path in hanoi.rglob("*"):
        if path.is_file() and path.suffix != ".pyc":
            assert "NAME" not in path.read_text(encoding="utf-8")


def test_its_scene_is_solved(hanoi: Path) -> None:
    arguments = ["run", "hanoi/hanoi.sketch", "hanoi/scenes/small.toml"]
    result = CliRunner().invoke(cli, [*arguments, "--domain", "hanoi/hanoi.py"])
    assert result.exit_code == 0, result.output
    assert "solved" in result.output


def test_its_own_tests_pass(hanoi: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(hanoi)],
        capture_output=True,
        text=True,
        cwd=hanoi,
        env={"PYTHONPATH": str(ROOT), "PATH": "", "PYTHONDONTWRITEBYTECODE": "1"},
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_an_edit_that_does_not_fit_is_told(hanoi: Path) -> None:
    path = hanoi / "hanoi.py"
    path.write_text(path.read_text().replace("def steps(", "def paces("))
    result = CliRunner().invoke(cli, ["check", "hanoi/hanoi.sketch", "--domain", "hanoi/hanoi.py"])
    assert result.exit_code == 1
    assert "`steps` is neither declared here nor a function in domain hanoi" in result.output


@pytest.mark.parametrize(
    "name", ["Hanoi", "2hanoi", "count", "class", "random", "delivery", "a/b", "é"]
)
def test_names_that_do_not_do(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert CliRunner().invoke(cli, ["new", "domain", name]).exit_code == 2
    assert not list(tmp_path.iterdir())


def test_nothing_is_overwritten(hanoi: Path) -> None:
    result = CliRunner().invoke(cli, ["new", "domain", "hanoi"])
    assert result.exit_code == 2
    assert "exists already" in result.output
