"""`sketchlang new domain`: a working domain to start from."""

from __future__ import annotations

import keyword
import re
import sys
from importlib.resources import files
from pathlib import Path

import click

from sketchlang.cli.common import fail, say
from sketchlang.errors import InputError
from sketchlang.files import new_folder, write_text
from sketchlang.loader import domain_names
from sketchlang.syntax.grammar import words

FILES = {
    "{name}.py": "domain.py.txt",
    "{name}.sketch": "sketch.txt",
    "scenes/small.toml": "scene.toml.txt",
    "test_{name}.py": "test.py.txt",
    "README.md": "readme.txt",
    "pyproject.toml": "pyproject.txt",
}

LONGEST = 100
"""Characters of a domain's name: with more, names of files would be too long somewhere."""


@click.group("new")
def command() -> None:
    """Write files to start from.

    \b
    Example:
      sketchlang new domain hanoi
    """


@command.command("domain")
@click.argument("name")
@click.option(
    "--into",
    type=click.Path(file_okay=False, path_type=Path),
    help="The folder to write to; it must not exist yet.  [default: NAME]",
)
def domain(name: str, into: Path | None) -> None:
    """Write a working domain: typed functions, a sketch, a scene, a test and a README.

    Exit 0, or 2 if NAME cannot be the name of a domain or the folder exists.

    \b
    Examples:
      sketchlang new domain hanoi
      sketchlang new domain hanoi --into domains/hanoi
    """
    problem = _why_not(name)
    folder = into or Path(name)
    if problem is not None:
        fail(problem)
    try:
        with new_folder(folder) as new:
            for target, template in FILES.items():
                path = new / target.format(name=name)
                path.parent.mkdir(parents=True, exist_ok=True)
                write_text(path, _filled(template, name))
    except InputError as error:
        fail(error)
    say(f"wrote {folder}/: " + ", ".join(f.format(name=name) for f in FILES))
    say("try:")
    files_ = f"{folder / name}.sketch --domain {folder / name}.py"
    say(f"  sketchlang check {files_}")
    scene = folder / "scenes" / "small.toml"
    say(f"  sketchlang run {folder / name}.sketch {scene} --domain {folder / name}.py")


def _why_not(name: str) -> str | None:
    """What is wrong with a name, or None."""
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        return f"{name!r} is no name for a domain: use small letters, digits and _"
    if len(name) > LONGEST:
        return f"{name[:20]}...: a name has at most {LONGEST} characters"
    if name in words() or keyword.iskeyword(name) or name == "sketchlang":
        return f"{name!r} is a reserved word"
    if name in sys.stdlib_module_names:
        # Its file would stand in the way of Python's own one.
        return f"{name!r} is a module of Python"
    if name in domain_names():
        return f"there is a domain {name!r} already"
    return None


def _filled(template: str, name: str) -> str:
    text = files("sketchlang.template").joinpath(template).read_text(encoding="utf-8")
    return re.sub(r"\bNAME\b|(?<=_)NAME\b", name, text)
