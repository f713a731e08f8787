"""`sketchlang check`: what is wrong with sketches."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator

import click

from sketchlang.cli import names
from sketchlang.cli.common import fail
from sketchlang.cli.last import say_error
from sketchlang.diagnostics import Diagnostic, Severity
from sketchlang.domain import Domain
from sketchlang.errors import InputError
from sketchlang.findings import findings
from sketchlang.loader import given_domain, load_source, load_text
from sketchlang.syntax import tree

FORMATS = ("full", "concise", "json", "github", "sarif")


@click.command("check")
@click.argument("files", nargs=-1, required=True, metavar="FILE...", shell_complete=names.sketches)
@click.option("--domain", "domain_file", metavar="FILE.py", help="A Python file with a domain.")
@click.option(
    "--format",
    "format_",
    type=click.Choice(FORMATS),
    default="full",
    show_default=True,
    help="How findings are printed.",
)
@click.option("--watch", "again", is_flag=True, help="Check again whenever a file changes.")
def command(files: tuple[str, ...], domain_file: str | None, format_: str, again: bool) -> None:
    """Parse sketches, check names, types and rules.

    FILE is a path, the name of a built-in sketch, or - for standard input. Exit 0 if there
    are no errors, 1 if there are, 2 if a file cannot be read; --watch goes on until Ctrl-C.

    \b
    Examples:
      sketchlang check pick_and_place
      sketchlang check my.sketch --domain my_domain.py --watch
      sketchlang check *.sketch --format json
    """
    if again:
        if "-" in files:
            fail("--watch needs files: standard input does not change")
        from sketchlang.cli.watch import ticks, watch

        watch(lambda: _look(files, domain_file, format_)[1], ticks())
    status, _ = _look(files, domain_file, format_)
    if status:
        raise SystemExit(status)


def _look(files: tuple[str, ...], domain_file: str | None, format_: str) -> tuple[int, list[str]]:
    """Check files and print what was found: the exit status, and all files that were read."""
    found: list[Diagnostic] = []
    shown: list[str] = []
    paths = list(files)
    extra: dict[str, Domain] = {}
    domain: Domain | None = None
    unreadable = False
    try:
        if domain_file is not None:
            paths.append(domain_file)
            extra, domain = given_domain(domain_file)
    except InputError as error:
        say_error(f"error: {error}")
        return 2, paths
    for file in files:
        try:
            loaded = load_text(load_source(file), extra, domain)
        except InputError as error:
            say_error(f"error: {error}")
            unreadable = True
            continue
        shown.append(loaded.source.name)
        found.extend(findings(loaded))
        paths.extend(_included(loaded.tree))
    if shown:
        from sketchlang.render import console

        console.write(rendered(found, shown, format_))
    errors = any(one.severity is Severity.ERROR for one in found)
    return 2 if unreadable else int(errors), paths


def _included(parsed: tree.Tree) -> Iterator[str]:
    """The files that a sketch includes, those that are not there too."""
    for item in parsed.items:
        if isinstance(item, tree.Include) and item.tree is not None:
            yield item.tree.source.name
            yield from _included(item.tree)
        elif isinstance(item, tree.Include) and item.quoted:
            yield os.path.join(os.path.dirname(parsed.source.name), item.target)


def rendered(found: list[Diagnostic], files: list[str], format_: str) -> str:
    """The findings in one of `FORMATS`."""
    match format_:
        case "concise":
            from sketchlang.render import concise

            return concise.render(found)
        case "json":
            from sketchlang.render import as_json

            return as_json.render(found)
        case "github":
            from sketchlang.render import github

            return github.render(found)
        case "sarif":
            from sketchlang.render import sarif

            return sarif.render(found)
        case _:
            from sketchlang.render import console

            return console.render(found, files, console.wants_colour(sys.stdout))
