"""`sketchlang bench kinder`: problems of KinDER, planned here and judged there."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import click

from sketchlang.cli.common import FILE, Number, fail, interruptible, say

FOLDER = Path(sys.prefix) / "kinder"
"""Where `make kinder` puts KinDER's own environment: beside the one that this runs in."""

MOST_SEEDS = 10_000


@click.command(
    epilog="""\b
Examples:
  make kinder
  sketchlang bench kinder --envs KinematicShelf3D-o3,Packing3D-p2 --seeds 0-9
  sketchlang bench kinder --envs Table3D-o1 --seeds 7 --json
  sketchlang bench kinder --seeds 0-49 --keep kinder.jsonl
"""
)
@click.option("--envs", metavar="ID,...", help="Environments, as Obstruction3D-o2; all 21.")
@click.option(
    "--seeds", default="0-4", show_default=True, metavar="A-B", help="Seeds of the environments."
)
@click.option(
    "--timeout",
    type=Number(min=0, max=1e6, min_open=True),
    default=30.0,
    show_default=True,
    metavar="S",
    help="Seconds of planning for each problem.",
)
@click.option(
    "--python",
    "interpreter",
    type=FILE,
    help="The Python of KinDER's environment; that which `make kinder` made.",
)
@click.option(
    "--keep",
    type=FILE,
    metavar="FILE",
    help="Keep records there, one a line; what it has already is not played again.",
)
@click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object a problem, as it ends."
)
@interruptible
def command(
    envs: str | None,
    seeds: str,
    timeout: float,
    interpreter: Path | None,
    keep: Path | None,
    as_json: bool,
) -> None:
    """Plan problems of KinDER and play the plans back in it, step by step; its own `terminated`
    flag tells whether a goal was reached. KinDER runs in an environment of its own, which `make
    kinder` sets up.

    Exit 0: all goals were reached. 1: some were not. 2: bad input.
    """
    from domains.tabletop.kinder.kept import records_in, write_records
    from domains.tabletop.kinder.run import Record, run_all
    from domains.tabletop.kinder.scenes import ENVS, NAMES, is_known
    from domains.tabletop.kinder.table import table
    from sketchlang.errors import InputError
    from sketchlang.files import check_output

    named = ENVS if envs is None else [name.strip() for name in envs.split(",")]
    for name in named:
        if not is_known(name):
            fail(f"--envs: there is no environment {name!r}", f"known: {', '.join(NAMES)}")
    numbers = _seeds(seeds)

    def told(record: Record) -> None:
        if keep is not None:
            known.append(record)
            write_records(keep, known)
        if as_json:
            click.echo(json.dumps(record.as_json()))
        elif not record.success:
            say(f"{record.env} seed {record.seed}: {record.reason}", err=True)

    python = interpreter or FOLDER / "bin" / "python"
    try:
        if keep is not None:
            check_output(keep, option="--keep")
        known = [] if keep is None else records_in(keep)
        records = run_all(python, named, numbers, timeout, told, tuple(known))
    except InputError as error:
        fail(error)
    if not as_json:
        say(*table(records))
    raise SystemExit(0 if all(record.success for record in records) else 1)


def _seeds(text: str) -> range:
    """The seeds of `A-B` or `A`; ends the command where it is neither."""
    found = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text)
    if found is None:
        fail(f"--seeds: {text!r} is no range of seeds", "as in --seeds 0-49")
    first, last = int(found[1]), int(found[2] or found[1])
    if not 0 <= last - first < MOST_SEEDS:
        fail(f"--seeds: from {first} to {last} are none, or too many")
    return range(first, last + 1)
