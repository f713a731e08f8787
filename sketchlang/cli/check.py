"""`sketchlang check`: what is wrong with sketches."""

from __future__ import annotations

import sys

import click

from sketchlang.cli.common import fail
from sketchlang.diagnostics import Diagnostic, Severity
from sketchlang.errors import InputError
from sketchlang.loader import Loaded, domains_of_file, load_source, load_text

FORMATS = ("full", "concise", "json", "github", "sarif")


def findings(loaded: Loaded) -> list[Diagnostic]:
    """All that `check` says of a sketch, in the order of the text."""
    found = list(loaded.diagnostics)
    if loaded.ok:
        found.extend(further_warnings(loaded))
    main = loaded.source.name
    found.sort(key=lambda one: (one.primary.source.name != main, one.primary.span))
    return found


def further_warnings(loaded: Loaded) -> list[Diagnostic]:
    """Findings of analyses that only make sense for a sketch without errors."""
    if not loaded.checked.model.rules:
        return []
    from sketchlang.analysis.coverage_report import warnings
    from sketchlang.cli.common import Places, title

    more = warnings(loaded.checked.model, Places(loaded).source, title(loaded))
    return [one for one in more if one.code != "unusable-rule" or not _explained(one, loaded)]


def _explained(unusable: Diagnostic, loaded: Loaded) -> bool:
    """Whether it was said already why a rule can never be used."""
    whole = unusable.primary
    if any(one.code == "empty-goal" for one in loaded.diagnostics):
        return True
    return any(
        one.code in ("goal-rule", "rule-against-invariant")
        and one.primary.source.name == whole.source.name
        and whole.span.start <= one.primary.span.start < whole.span.end
        for one in loaded.diagnostics
    )


@click.command("check")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--domain", "domain_file", metavar="FILE.py", help="A Python file with a domain.")
@click.option(
    "--format",
    "format_",
    type=click.Choice(FORMATS),
    default="full",
    show_default=True,
    help="How findings are printed.",
)
def command(files: tuple[str, ...], domain_file: str | None, format_: str) -> None:
    """Parse sketches, check names, types and rules.

    FILE is a path, the name of a built-in sketch, or - for standard input. Exit 0 if there
    are no errors, 1 if there are, 2 if a file cannot be read.

    \b
    Examples:
      sketchlang check pick_and_place
      sketchlang check my.sketch --domain my_domain.py
      sketchlang check *.sketch --format json
    """
    unreadable = False
    found: list[Diagnostic] = []
    names: list[str] = []
    try:
        extra = domains_of_file(domain_file) if domain_file is not None else {}
    except InputError as error:
        fail(error)
    for file in files:
        try:
            loaded = load_text(load_source(file), extra)
        except InputError as error:
            click.echo(f"error: {error}", err=True)
            unreadable = True
            continue
        names.append(loaded.source.name)
        found.extend(findings(loaded))
    if names:
        from sketchlang.render import console

        console.write(rendered(found, names, format_))
    if unreadable:
        raise SystemExit(2)
    if any(one.severity is Severity.ERROR for one in found):
        raise SystemExit(1)


def rendered(found: list[Diagnostic], names: list[str], format_: str) -> str:
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

            return console.render(found, names, console.wants_colour(sys.stdout))
