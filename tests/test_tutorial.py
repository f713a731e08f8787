"""docs/tutorial.md, as written: its files are written, its commands run by a shell, and what they
show is compared."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from sketchlang.cli import cli
from tests import tutorial

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "tutorial.md"
QUICK = ("list", "check", "terminate")
"""Commands that need no planning."""


def test_the_page_has_what_it_promises() -> None:
    steps = list(tutorial.steps(PAGE))
    lines = [step.line for step in steps if isinstance(step, tutorial.Command)]
    assert sum(isinstance(step, tutorial.Write) for step in steps) == 3
    words = {line.partition("sketchlang ")[2].split()[0] for line in lines}
    wanted = "list show check terminate run inspect step validate replay"
    assert words == set(wanted.split())
    assert "](docs/tutorial.md)" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_what_is_checked_and_proved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = 0
    for step in tutorial.steps(PAGE):
        if isinstance(step, tutorial.Write):
            Path(step.name).write_text(step.text, encoding="utf-8")
            continue
        words = step.line.split()
        if words[0] == "sketchlang" and words[1] in QUICK:
            result = CliRunner().invoke(cli, words[1:])
            assert tutorial.agrees(step.shown, result.output) is None, step.line
            done += 1
    assert done >= 6


@pytest.mark.slow
def test_every_command_as_written(tmp_path: Path) -> None:
    script = tmp_path / "bin" / "sketchlang"
    script.parent.mkdir()
    script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m sketchlang "$@"\n')
    script.chmod(0o755)
    env = {
        **os.environ,
        "PATH": f"{script.parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
    }
    for step in tutorial.steps(PAGE):
        if isinstance(step, tutorial.Write):
            (tmp_path / step.name).write_text(step.text, encoding="utf-8")
            continue
        done = subprocess.run(
            ["bash", "-c", step.line],
            cwd=tmp_path,
            env=env,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        assert done.returncode in (0, 1), done
        assert tutorial.agrees(step.shown, done.stdout) is None, (step.line, done.stdout)
    assert (tmp_path / "replay.html").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("shown", "output", "fits"),
    [
        (("a", "b"), "a\nb\n", True),
        (("a",), "a\nb\n", False),
        (("a", "..."), "a\nb\n", True),
        (("...", "c"), "a\nb\nc", True),
        (("...", "b"), "a\nb\nc", False),
        (("a", "...", "d"), "a\nb\nc", False),
        (("solved in 0.10 s: 2 actions",), "solved in 12.34 s: 7 actions", True),
        (("m is 2",), "m is 3", False),
    ],
)
def test_pages_and_outputs_are_compared(shown: tuple[str, ...], output: str, fits: bool) -> None:
    assert (tutorial.agrees(shown, output) is None) is fits
