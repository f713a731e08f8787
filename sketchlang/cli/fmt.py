"""`sketchlang fmt`: sketches in their canonical form."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from sketchlang.cli.common import say
from sketchlang.errors import InputError
from sketchlang.escape import visible
from sketchlang.files import write_bytes
from sketchlang.loader import load_source
from sketchlang.render import console, full
from sketchlang.source import Source
from sketchlang.syntax.formatter import format_tree
from sketchlang.syntax.parser import parse

TAB = "\t"


@click.command("fmt")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--check", is_flag=True, help="Change nothing; exit 1 if something would change.")
@click.option("--diff", is_flag=True, help="Change nothing; print what would change.")
def command(files: tuple[str, ...], check: bool, diff: bool) -> None:
    """Write sketches in their canonical form; comments are kept.

    FILE is a path, a directory with sketches, or - to format standard input to standard
    output. Exit 0, 1 if --check or --diff found something to change, 2 if a file cannot be
    read or has syntax errors.

    \b
    Examples:
      sketchlang fmt my.sketch
      sketchlang fmt --check --diff sketches/
      sketchlang fmt - < my.sketch
    """
    outcomes = {_format(name, check, diff) for name in _expand(files)}
    if "failed" in outcomes:
        raise SystemExit(2)
    if "changed" in outcomes and (check or diff):
        raise SystemExit(1)


def _format(name: str, check: bool, diff: bool) -> str:
    """Format one file, or only look: `failed`, `changed` or `unchanged`."""
    try:
        if name != "-" and not os.path.exists(name):
            # Not the built-in sketch of the name: there would be no file to write.
            raise InputError("no such file", place=name)
        source = load_source(name)
    except InputError as error:
        click.echo(f"error: {error}", err=True)
        return "failed"
    formatted = _formatted(source)
    if formatted is None:
        return "failed"
    differs = formatted != source.text
    if diff:
        console.write(_diff(source, formatted))
    if check and differs:
        say(f"would change {source.name}", err=True)
    if name == "-" and not (check or diff):
        console.write(formatted)
    elif differs and not (check or diff):
        try:
            # As bytes: line breaks stay what they are.
            write_bytes(Path(name), formatted.encode(), over_input=True)
        except InputError as error:
            click.echo(f"error: {error}", err=True)
            return "failed"
        say(f"changed {source.name}", err=True)
    return "changed" if differs else "unchanged"


def _expand(files: tuple[str, ...]) -> list[str]:
    names: list[str] = []
    for name in files:
        path = Path(name)
        if path.is_dir():
            names.extend(sorted(map(str, path.rglob("*.sketch"))))
        else:
            names.append(name)
    return names


def _formatted(source: Source) -> str | None:
    """The canonical form; None, with the reasons on standard error, if there is none."""
    parsed, diagnostics = parse(source)
    if not diagnostics:
        return format_tree(parsed)
    colour = console.wants_colour(sys.stderr)
    for found in diagnostics:
        click.echo(full.render(found, colour) + "\n", err=True)
    say(f"{source.name}: not formatted", err=True)
    return None


def _diff(source: Source, formatted: str) -> str:
    import difflib

    lines = difflib.unified_diff(
        source.text.splitlines(keepends=True),
        formatted.splitlines(keepends=True),
        source.name,
        f"{source.name} (formatted)",
    )
    return "".join(
        # What follows the sign cannot begin a line; the sign itself keeps its place.
        f"{visible(line[:-1], keep=TAB)}\n"
        if line.endswith("\n")
        else f"{visible(line, keep=TAB)}\n\\ No newline at end of file\n"
        for line in lines
    )
