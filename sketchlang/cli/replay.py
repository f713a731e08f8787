"""`sketchlang replay PLAN`: look at a plan or an execution."""

from __future__ import annotations

from pathlib import Path

import click

from sketchlang.cli.common import (
    Number,
    check_outputs,
    fail,
    interruptible,
    load_named,
    say,
    trace_options,
)


@click.command(
    epilog="""\b
Examples:
  sketchlang replay plan.json --html replay.html
  sketchlang replay plan.json --png pictures --mp4 film.mp4
  sketchlang replay executed-trace.json --html executed.html
"""
)
@trace_options
@click.option(
    "--html", type=click.Path(path_type=Path, dir_okay=False), help="Write a page for the browser."
)
@click.option(
    "--png",
    type=click.Path(path_type=Path, file_okay=False),
    help="Write pictures into this folder: start, end, each subgoal.",
)
@click.option("--mp4", type=click.Path(path_type=Path, dir_okay=False), help="Write a film.")
@click.option(
    "--speed",
    type=Number(0.1, 100),
    default=8.0,
    show_default=True,
    help="Of the film, times real time.",
)
@click.option(
    "--trace", type=click.Path(path_type=Path, dir_okay=False), help="Write the trace itself."
)
@interruptible
def command(
    file: Path,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    domain_file: str | None,
    html: Path | None,
    png: Path | None,
    mp4: Path | None,
    speed: float,
    trace: Path | None,
) -> None:
    """Show FILE, a plan or a trace: a page for the browser, pictures, a film.

    The page is one file that needs no network: the scene in 3D, the sketch with the rule that
    fires, the features over time, the subgoals.

    Exit 0: written. 2: bad input.
    """
    from sketchlang.errors import InputError

    if html is None and png is None and mp4 is None and trace is None:
        fail("nothing to write: give --html, --png, --mp4 or --trace")
    outputs = {"--html": html, "--png": png, "--mp4": mp4, "--trace": trace}
    check_outputs((file, scene, robot, sketch, domain_file), outputs, folders=("--png",))
    try:
        if mp4 is not None:
            from runtime.show.pictures import check_film

            check_film(mp4)
        found = load_named(file, scene, robot, sketch, domain_file)
        check_outputs((), outputs, folders=("--png",))  # again: what a plan names was read now
        if trace is not None:
            from runtime.trace.write import write_trace

            write_trace(found, trace)
            say(f"trace written to {trace}")
        if html is not None:
            from runtime.show.page import page
            from sketchlang.files import write_text

            write_text(html, page(found))
            say(f"replay written to {html}")
        if png is not None:
            from runtime.show.pictures import write_pictures

            say(f"{len(write_pictures(found, png))} pictures written to {png}")
        if mp4 is not None:
            from runtime.show.pictures import write_film

            write_film(found, mp4, speed)
            say(f"film written to {mp4}")
    except InputError as error:
        fail(error)
