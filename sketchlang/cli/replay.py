"""`sketchlang replay PLAN`: look at a plan or an execution."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sketchlang.analysis.words import counted
from sketchlang.cli.common import (
    FILE,
    Number,
    check_outputs,
    fail,
    interruptible,
    load_named,
    say,
    trace_options,
)

if TYPE_CHECKING:
    from runtime.trace.model import Trace


@click.command(
    epilog="""\b
Examples:
  sketchlang replay plan.json --html replay.html
  sketchlang replay plan.json --against other.json --html both.html
  sketchlang replay plan.json --png pictures --mp4 film.mp4
  sketchlang replay plan.json --gif moment.gif --from 20 --to 60
"""
)
@trace_options
@click.option("--html", type=FILE, help="Write a page for the browser.")
@click.option(
    "--against",
    type=FILE,
    metavar="FILE",
    help="Another plan or trace, beside the first one on the page.",
)
@click.option(
    "--png",
    type=click.Path(path_type=Path, file_okay=False),
    help="Write pictures into this folder: start, end, each subgoal.",
)
@click.option("--mp4", type=FILE, help="Write a film.")
@click.option("--gif", type=FILE, help="Write a small film.")
@click.option(
    "--speed",
    type=Number(0.1, 100),
    default=8.0,
    show_default=True,
    help="Of the films, times real time.",
)
@click.option(
    "--from",
    "start",
    type=Number(min=0),
    default=0.0,
    show_default=True,
    metavar="S",
    help="Where films begin.",
)
@click.option("--to", "end", type=Number(min=0), metavar="S", help="Where films end.")
@click.option("--trace", type=FILE, help="Write the trace itself.")
@interruptible
def command(
    file: Path,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    domain_file: str | None,
    html: Path | None,
    against: Path | None,
    png: Path | None,
    mp4: Path | None,
    gif: Path | None,
    speed: float,
    start: float,
    end: float | None,
    trace: Path | None,
) -> None:
    """Show FILE, a plan or a trace: a page for the browser, pictures, films.

    The page is one file that needs no network: the scene in 3D, the sketch with the rule that
    fires, the features over time, the subgoals. Pictures and films are taken of that page by a
    headless Chromium; where there is none, a software renderer draws the scene.

    Exit 0: written. 2: bad input.
    """
    from sketchlang.errors import InputError

    outputs = {"--html": html, "--png": png, "--mp4": mp4, "--gif": gif, "--trace": trace}
    if not any(outputs.values()):
        fail("nothing to write: give --html, --png, --mp4, --gif or --trace")
    if against is not None and html is None:
        fail("--against: two plans are compared on a page: give --html")
    if end is not None and end <= start:
        fail(f"--to: {end:g} s is not after {start:g} s")
    check_outputs((file, scene, robot, sketch, domain_file, against), outputs, folders=("--png",))
    try:
        for film, suffix in ((mp4, ".mp4"), (gif, ".gif")):
            if film is not None:
                from runtime.show.pictures import check_film

                check_film(film, suffix)
        found = load_named(file, scene, robot, sketch, domain_file)
        other = None
        if against is not None:
            other = load_named(against, scene, robot, sketch, domain_file)
        check_outputs((), outputs, folders=("--png",))  # again: what a plan names was read now
        if trace is not None:
            from runtime.trace.write import write_trace

            write_trace(found, trace)
            say(f"trace written to {trace}")
        if html is not None:
            _page(found, other, html)
        if png is not None:
            from runtime.show.pictures import write_pictures

            paths = write_pictures(found, png, Bar("pictures"), warn)
            say(f"{counted(len(paths), 'picture')} written to {png}")
        for film in (mp4, gif):
            if film is not None:
                from runtime.show.pictures import write_film

                until = math.inf if end is None else end
                write_film(found, film, speed, start, until, Bar("frames"), warn)
                say(f"film written to {film}")
    except InputError as error:
        fail(error)


def _page(trace: Trace, other: Trace | None, path: Path) -> None:
    from runtime.show.page import page
    from sketchlang.files import write_text

    write_text(path, page(trace, other))
    say(f"replay written to {path}")


def warn(text: str) -> None:
    """What is to be known of the pictures, on stderr."""
    say(text, err=True)


class Bar:
    """How far a film is, on stderr: a bar on a terminal, else a line at each quarter."""

    WIDTH = 30

    def __init__(self, what: str) -> None:
        self.what, self.terminal = what, sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        if self.terminal:
            full = self.WIDTH * done // total
            bar = "#" * full + "." * (self.WIDTH - full)
            click.echo(f"\r[{bar}] {done} of {total} {self.what}", nl=done == total, err=True)
        elif total >= 4 and done * 4 // total > (done - 1) * 4 // total:
            say(f"{done} of {total} {self.what}", err=True)
