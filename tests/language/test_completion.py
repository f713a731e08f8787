"""Completion in shells: what comes along is known wherever it can be named."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from runtime.search.planners import PLANNERS
from sketchlang.cli import cli, names
from sketchlang.library import built_in_scenes
from sketchlang.loader import builtin_sketches, domain_names

ROOT = Path(__file__).parents[2]
KNOWN = {
    "sketch": "pick_and_place",
    "scene": "sorting/4t-07",
    "scenes": "sorting/4t-07",
    "robot": "tiago",
    "planner": "siw-r",
    "planners": "siw-r",
}
"""Something that comes along for each kind of parameter."""


def parameters(name: str, command: click.Command) -> Iterator[tuple[str, click.Parameter]]:
    """All parameters of the command line that name what comes along."""
    if isinstance(command, click.Group):
        context = click.Context(command)
        for inner in command.list_commands(context):
            found = command.get_command(context, inner)
            assert found is not None
            yield from parameters(f"{name} {inner}".strip(), found)
    for parameter in command.params:
        if parameter.name in KNOWN:
            yield name, parameter


ALL = list(parameters("", cli))


@pytest.mark.parametrize(("command", "parameter"), ALL, ids=str)
def test_every_name_is_completed(command: str, parameter: click.Parameter) -> None:
    wanted = KNOWN[str(parameter.name)]
    context = click.Context(click.Command(command))
    found = [item.value for item in parameter.shell_complete(context, wanted[:3])]
    assert wanted in found, (command, parameter)


def test_the_commands_that_name_them_are_all_here() -> None:
    assert len(ALL) > 20
    assert {"run", "inspect", "step", "test", "validate", "execute"} <= {name for name, _ in ALL}


def test_the_planners_are_those_that_there_are() -> None:
    assert tuple(PLANNERS) == names.PLANNERS


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def source(shell: str) -> str:
    """What a shell is told to run when it starts."""
    done = subprocess.run(
        [sys.executable, "-m", "sketchlang"],
        env={**environment(), "_SKETCHLANG_COMPLETE": f"{shell}_source"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    return done.stdout


BASH = """
compopt() { :; }  # means something while a completion runs only
%s
COMP_WORDS=(sketchlang %s); COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
_sketchlang_completion sketchlang
printf '%%s\\n' "${COMPREPLY[@]}"
"""


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("show sorting/3", [name for name in built_in_scenes() if name.startswith("sorting/3")]),
        ("step delivery_s", [n for n in builtin_sketches() if n.startswith("delivery_s")]),
        ("show x --domain d", [name for name in domain_names() if name.startswith("d")]),
    ],
)
def test_bash_completes(words: str, expected: list[str], tmp_path: Path) -> None:
    script = tmp_path / "sketchlang"
    script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m sketchlang "$@"\n')
    script.chmod(0o755)
    # The function asks `sketchlang` itself, found on the path.
    env = {**environment(), "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}
    text = BASH % (source("bash"), words)
    done = subprocess.run(
        ["bash", "--norc", "-c", text],
        env=env,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert set(expected) <= set(done.stdout.split()), done
    assert expected


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_get_names_and_what_they_are(shell: str) -> None:
    """zsh and fish ask with other variables and read other answers."""
    assert f"_SKETCHLANG_COMPLETE={shell}_complete" in source(shell)
    # zsh counts words; fish gives the word that is begun.
    asked = {"zsh": {"COMP_CWORD": "2"}, "fish": {"COMP_CWORD": "kit"}}[shell]
    words = {"zsh": "sketchlang show kit", "fish": "sketchlang show"}[shell]
    done = subprocess.run(
        [sys.executable, "-m", "sketchlang"],
        env={
            **environment(),
            "_SKETCHLANG_COMPLETE": f"{shell}_complete",
            "COMP_WORDS": words,
            **asked,
        },
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    assert "kit/parts" in done.stdout
    assert "sorting" not in done.stdout


def test_the_page_says_how_it_is_switched_on() -> None:
    page = (ROOT / "docs" / "editors.md").read_text(encoding="utf-8")
    for shell in ("bash", "zsh", "fish"):
        assert f"_SKETCHLANG_COMPLETE={shell}_source sketchlang" in page
