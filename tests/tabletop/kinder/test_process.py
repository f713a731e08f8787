"""KinDER's process, where it is not there, where it fails, and where `make kinder` put it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from domains.tabletop.kinder.process import KinderProcess
from sketchlang.cli import cli
from sketchlang.cli.kinder import FOLDER
from sketchlang.errors import InputError

PYTHON = FOLDER / "bin" / "python"


def test_no_interpreter() -> None:
    with pytest.raises(InputError, match="cannot be started") as caught:
        KinderProcess(Path("nowhere") / "python")
    assert "make kinder" in str(caught.value.hint)


def test_an_environment_without_kinder_says_so() -> None:
    with (
        KinderProcess(Path(sys.executable)) as process,
        pytest.raises(InputError, match="No module named 'kinder'"),
    ):
        process.reset("Table3D-o1", 0)


def test_a_process_that_ends_says_its_last_words(tmp_path) -> None:
    script = tmp_path / "python"
    script.write_text("#!/bin/sh\necho out of order >&2\nexit 3\n")
    script.chmod(0o755)
    with (
        KinderProcess(script) as process,
        pytest.raises(InputError, match="out of order"),
    ):
        process.reset("Table3D-o1", 0)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--envs", "Table3D-o1,Nothing"], "no environment 'Nothing'"),
        (["--seeds", "3-1"], "from 3 to 1"),
        (["--seeds", "x"], "no range of seeds"),
        (["--python", "nowhere/python"], "cannot be started"),
    ],
)
def test_mistakes_are_said(arguments, said) -> None:
    done = CliRunner().invoke(cli, ["bench", "kinder", *arguments])
    assert done.exit_code == 2
    assert said in done.output


@pytest.mark.skipif(not PYTHON.exists(), reason="`make kinder` was not run")
def test_a_cube_is_held_up() -> None:
    arguments = ["bench", "kinder", "--envs", "Table3D-o1", "--seeds", "0", "--json"]
    done = CliRunner().invoke(cli, arguments)
    record = json.loads(done.output)
    assert record["success"]
    assert record["steps"] > 0
    assert done.exit_code == 0


def test_what_leads_our_python_does_not_lead_theirs(tmp_path, monkeypatch) -> None:
    """A module of the name on our path is not found there."""
    (tmp_path / "kinder.py").write_text("raise RuntimeError('ours')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with (
        KinderProcess(Path(sys.executable)) as process,
        pytest.raises(InputError, match="No module named 'kinder'"),
    ):
        process.reset("Table3D-o1", 0)
