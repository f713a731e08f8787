"""`sketchlang bench compare A B`: the results of two benchmarks, pair by pair."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sketchlang.cli.common import fail, interruptible, say

if TYPE_CHECKING:
    from runtime.bench.comparison import Compared
    from runtime.bench.job import Result


@click.command("compare")
@click.argument("first", metavar="A")
@click.argument("second", metavar="B")
@click.option(
    "--format", "shape", type=click.Choice(("md", "latex", "json")), default="md",
    show_default=True, help="What is printed.",
)  # fmt: skip
@interruptible
def command(first: str, second: str, shape: str) -> None:
    """Compare the results A and B of benchmarks, run by run: the same scene and seed.

    A and B are files of results, as `--out` names them. `FILE:planner=NAME` chooses among the
    results of a file; sketch, scene and robot can be chosen as well. What is chosen on both sides
    may differ between the two runs of a pair.

    \b
    Examples:
      sketchlang bench compare before.jsonl after.jsonl
      sketchlang bench compare r.jsonl:planner=siw-r r.jsonl:planner=lazy-siiw-r

    Exit 0: compared. 2: bad input, or no pairs.
    """
    from runtime.bench import comparison
    from runtime.bench.store import read_results
    from sketchlang.errors import InputError

    try:
        sides: list[list[Result]] = []
        choices: list[dict[str, str]] = []
        for side in (first, second):
            file, _, words = side.partition(":")
            if not os.path.lexists(file):
                raise InputError("no such file", place=file)
            choices.append(comparison.choice_of(words))
            sides.append(comparison.chosen(read_results(Path(file)), choices[-1]))
        pairs = comparison.paired(sides[0], sides[1], set(choices[0]) & set(choices[1]))
        if not pairs:
            message = "no run of A has the sketch, scene, planner, robot and seed of one of B"
            raise InputError(message, hint="choose what may differ: FILE:planner=NAME")
        found = {scene: comparison.compared(group) for scene, group in pairs.items()}
        if len(found) > 1:
            found["all"] = comparison.compared([pair for group in pairs.values() for pair in group])
    except InputError as error:
        fail(error)
    _tell(first, second, found, shape)


def _tell(first: str, second: str, found: dict[str, Compared], shape: str) -> None:
    from runtime.bench.comparison import tables
    from runtime.bench.write.tables import lines_of

    if shape == "json":
        data: dict[str, Any] = {"a": first, "b": second}
        data["scenes"] = {scene: c.as_data() for scene, c in found.items()}
        click.echo(json.dumps(data, indent=1))
        return
    if shape == "md":
        say(f"A: {first}", f"B: {second}", "")
    say(*lines_of([table for table in tables(found) if table.rows], shape))
