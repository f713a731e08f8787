"""`sketchlang coverage`: states that no rule provides for, and rules that no state can use."""

from __future__ import annotations

import sys

import click

from sketchlang.cli import names
from sketchlang.cli.common import domain_option, interruptible, load_valid
from sketchlang.escape import dumps, shown_lines
from sketchlang.findings import Places


@click.command("coverage")
@click.argument("file", metavar="FILE", shell_complete=names.sketches)
@click.option("--overlaps", is_flag=True, help="List rules that apply together, too.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@domain_option
@interruptible
def command(*, file: str, overlaps: bool, as_json: bool, domain_file: str | None) -> None:
    """Find valuations without a rule, and rules that can never be used.

    A valuation says which Booleans are true and which nats are > 0. It needs a rule unless
    the goal holds or an invariant is false there: one whose conditions are true and whose
    effects can happen (`n--` needs n > 0).

    Exit 0 if nothing was found, 1 if there are such valuations or rules, 2 if the file
    cannot be read or has errors. Overlaps are no fault and do not count.

    \b
    Examples:
      sketchlang coverage pick_and_place
      sketchlang coverage my.sketch --overlaps --json
    """
    loaded = load_valid(file, domain_file)
    from sketchlang.analysis import coverage_report
    from sketchlang.analysis.coverage import find_coverage, find_overlaps
    from sketchlang.analysis.cubes import TooManyCubesError

    model = loaded.checked.model
    places = Places(loaded)
    try:
        found = find_coverage(model)
        pairs = find_overlaps(model) if overlaps else None
    except TooManyCubesError:
        click.echo(f"{model.name}: its valuations fall into too many groups to list.", err=True)
        sys.exit(1)
    if as_json:
        result = coverage_report.as_json(model, found, pairs, places.position)
        click.echo(dumps(result, indent=2))
    else:
        click.echo(shown_lines(coverage_report.as_text(model, found, pairs, places.shown)))
    sys.exit(1 if found.gaps or found.dead else 0)
