"""Foreign packages that are called like ours, and completion in shells."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import sketchlang
from sketchlang import guard
from sketchlang.cli import COMMANDS
from sketchlang.library import built_in_scenes
from sketchlang.loader import builtin_sketches

ROOT = Path(__file__).parents[2]


def run(folder: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """The command line, with a folder before ours on Python's path."""
    env = {**os.environ, "PYTHONPATH": f"{folder}{os.pathsep}{ROOT}", **environment}
    command = [sys.executable, "-c", "from sketchlang.cli import main; main()", *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=env, cwd=folder, check=False)


@pytest.mark.parametrize("name", guard.PACKAGES)
@pytest.mark.parametrize("shape", ["package", "module"])
def test_a_foreign_package_is_named_in_one_line(tmp_path: Path, name: str, shape: str) -> None:
    foreign = tmp_path / (name if shape == "package" else f"{name}.py")
    if shape == "package":
        foreign.mkdir()
    text = "raise RuntimeError('imported')\n"
    (foreign / "__init__.py" if shape == "package" else foreign).write_text(text)
    done = run(tmp_path, "check", "pick_and_place")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"error: {foreign} is in the way")
    assert f"`{name}`" in done.stderr


def test_a_folder_that_is_no_package_does_no_harm(tmp_path: Path) -> None:
    for name in guard.PACKAGES:
        (tmp_path / name).mkdir()
        (tmp_path / name / "notes.txt").write_text("mine")
    assert run(tmp_path, "check", "delivery_s5").returncode == 0


def test_a_module_that_a_program_has_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    assert guard.in_the_way() is None
    other = ModuleType("domains")
    other.__file__ = "/elsewhere/domains.py"
    monkeypatch.setitem(sys.modules, "domains", other)
    assert str(guard.in_the_way()).startswith("/elsewhere/domains.py is in the way")
    with pytest.raises(ImportError, match="in the way"):
        sketchlang.__getattr__("plan")


def test_a_package_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "PACKAGES", ("no_such_package_at_all",))
    assert "is missing" in str(guard.in_the_way())


def completions(tmp_path: Path, *words: str) -> list[str]:
    done = run(
        tmp_path,
        _SKETCHLANG_COMPLETE="bash_complete",
        COMP_WORDS=" ".join(["sketchlang", *words]),
        COMP_CWORD=str(len(words)),
    )
    assert done.stderr == ""
    return done.stdout.split()


def test_shells_complete_what_comes_along(tmp_path: Path) -> None:
    commands = completions(tmp_path, "")
    assert [f"plain,{name}" for name in COMMANDS] == commands
    sketches = completions(tmp_path, "check", "pick")
    assert sketches == [
        "file,pick",
        *[f"plain,{name}" for name in builtin_sketches() if name.startswith("pick")],
    ]
    scenes = completions(tmp_path, "run", "pick_and_place", "sorting/")
    assert f"plain,{built_in_scenes()[-1]}" in completions(tmp_path, "run", "pick_and_place", "w")
    assert len(scenes) == 1 + sum(name.startswith("sorting/") for name in built_in_scenes())
    robots = completions(tmp_path, "run", "pick_and_place", "sorting/4t-07", "--robot", "ti")
    assert "plain,tiago" in robots
    assert "plain,uncovered" in completions(tmp_path, "explain", "unc")


def test_completion_of_commands_imports_none_of_them(tmp_path: Path) -> None:
    done = subprocess.run(
        [
            sys.executable,
            "-X",
            "importtime",
            "-c",
            "from sketchlang.cli import main; main()",
        ],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={
            **os.environ,
            "_SKETCHLANG_COMPLETE": "bash_complete",
            "COMP_WORDS": "sketchlang ",
            "COMP_CWORD": "1",
        },
        check=True,
    )
    assert "numpy" not in done.stderr
    assert "sketchlang.cli.run" not in done.stderr
