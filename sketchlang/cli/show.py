"""`sketchlang show NAME`: a domain, scene, robot or sketch."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import click

from sketchlang.cli import names
from sketchlang.cli.common import FILE, check_outputs, fail, interruptible

WIDTH = 100
"""Columns of what goes to a file or to another program."""


@click.command(
    "show",
    epilog="""\b
Examples:
  sketchlang show tabletop
  sketchlang show sorting/4t-07
  sketchlang show my-scene.toml --svg scene.svg
  sketchlang show kitchen/tidy --source > my-scene.toml
  sketchlang show tiago
  sketchlang show gripper --as domain --json
  sketchlang show task.pddl
""",
)
@click.argument("name", shell_complete=names.anything)
@click.option(
    "--as",
    "kind",
    type=click.Choice(["domain", "scene", "robot", "sketch"]),
    help="What NAME is, where it can be several things.",
)
@click.option(
    "--svg",
    "out",
    type=FILE,
    metavar="OUT",
    help="Draw a scene into an SVG file.",
)
@click.option("--source", is_flag=True, help="Print the file itself, to start one's own from.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option(
    "--domain",
    metavar="NAME|FILE",
    shell_complete=names.domains,
    help="The domain of a scene, where it is not tabletop; the domain file of a PDDL task.",
)
@interruptible
def command(
    name: str,
    kind: str | None,
    out: Path | None,
    source: bool,
    as_json: bool,
    domain: str | None,
) -> None:
    """Show what NAME stands for, a built-in name or a path: the functions, atoms and actions of a
    domain; a scene from above, or the objects and the goal of a PDDL task; joints, gripper and
    reach of a robot; the text of a sketch. Where a name is of several kinds, all are shown.

    With --json, one object with a key for each kind.

    Exit 0: shown. 2: there is no such thing, or something is wrong with it.
    """
    from runtime.inspect.find import find, source_of
    from sketchlang.domain import SceneError
    from sketchlang.errors import InputError
    from sketchlang.escape import dumps
    from sketchlang.render import console

    if source and (as_json or out is not None):
        fail("--source goes with neither --json nor --svg")
    check_outputs((name, domain), {"--svg": out})
    try:
        if source:
            click.echo(source_of(name, kind), nl=False)
            return
        found = find(name, kind, domain)
        drawings = [one.picture.svg() for one in found] if out is not None else []
        drawn = next((drawing for drawing in drawings if drawing is not None), None)
        if out is not None:
            if drawn is None:
                raise InputError(f"--svg: {name} is no scene that could be drawn")
            from sketchlang.files import write_text

            check_outputs((), {"--svg": out})  # again, for what it names was read now
            write_text(out, drawn)
    except (InputError, SceneError) as error:
        fail(error)
    if as_json:
        click.echo(dumps({one.kind: one.picture.data() for one in found}))
        return
    if out is not None:
        click.echo(f"drawn in {out}")
        return
    colour = console.wants_colour(sys.stdout)
    width = shutil.get_terminal_size((WIDTH, 40)).columns if sys.stdout.isatty() else WIDTH
    for number, one in enumerate(found):
        if number:
            click.echo()
        for line in one.picture.text(width, colour):
            click.echo(line)
