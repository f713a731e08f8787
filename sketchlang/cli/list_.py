"""`sketchlang list`: what comes along."""

from __future__ import annotations

import shutil
import sys

import click

from sketchlang.cli.common import interruptible, say

KINDS = ("sketches", "scenes", "robots", "planners", "domains")


@click.command(
    "list",
    epilog="""\b
Examples:
  sketchlang list
  sketchlang list scenes
  sketchlang list sketches --json
""",
)
@click.argument("kind", type=click.Choice(KINDS), required=False)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@interruptible
def command(kind: str | None, as_json: bool) -> None:
    """List the sketches, scenes, robots, planners and domains that come along, or one kind of
    them. `sketchlang show NAME` tells more of each.

    Exit 0: listed. 2: bad input.
    """
    from runtime.inspect import catalogue
    from sketchlang.escape import dumps

    found = {name: catalogue.KINDS[name]() for name in ([kind] if kind else KINDS)}
    if as_json:
        data = {
            name: [{"name": e.name, "about": e.about, **e.more} for e in entries]
            for name, entries in found.items()
        }
        click.echo(dumps(data))
        return
    # Not cut where it is read by a program or goes to a file.
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else sys.maxsize
    for number, (name, entries) in enumerate(found.items()):
        if not kind:
            say(*([""] if number else []), name)
        indent = "" if kind else "  "
        say(*(indent + line for line in catalogue.columns(entries, width - len(indent))))
