"""`sketchlang check`: what is wrong with sketches."""

from __future__ import annotations

import click

from sketchlang.diagnostics import Diagnostic, Severity
from sketchlang.loader import Loaded, LoadError, domains_of_file, load_source, load_text
from sketchlang.render import console


def further_warnings(_loaded: Loaded) -> list[Diagnostic]:
    """Findings of analyses that only make sense for a sketch without errors."""
    return []


@click.command("check")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--domain", "domain_file", metavar="FILE.py", help="A Python file with a domain.")
def command(files: tuple[str, ...], domain_file: str | None) -> None:
    """Parse sketches, check names, types and rules.

    FILE is a path, the name of a built-in sketch, or - for standard input. Exit 0 if there
    are no errors, 1 if there are, 2 if a file cannot be read.
    """
    try:
        extra = domains_of_file(domain_file) if domain_file is not None else {}
        loaded = [load_text(load_source(file), extra) for file in files]
    except LoadError as error:
        click.echo(f"error: {error}", err=True)
        raise SystemExit(2) from None
    found: list[Diagnostic] = []
    for one in loaded:
        found.extend(one.diagnostics)
        if one.ok:
            found.extend(further_warnings(one))
    console.show(found, [one.source.name for one in loaded])
    if any(one.severity is Severity.ERROR for one in found):
        raise SystemExit(1)
