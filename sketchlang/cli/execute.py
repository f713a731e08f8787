"""`sketchlang execute PLAN`: under physics, open loop; or a sketch and a scene, closed loop."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sketchlang.cli.common import fail, interruptible, trace_options

if TYPE_CHECKING:
    from runtime.execution.execute import Report


@click.command(
    epilog="""\b
Examples:
  sketchlang execute plan.json
  sketchlang execute plan.json --gui
  sketchlang execute plan.json --json --trace executed.json
"""
)
@trace_options
@click.option("--gui", is_flag=True, help="Watch it in PyBullet's window.")
@click.option(
    "--trace",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write the trace of what happened.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@interruptible
def command(
    file: Path,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    gui: bool,
    trace: Path | None,
    as_json: bool,
) -> None:
    """Execute FILE, a plan or a trace, under physics (PyBullet).

    Reports how well the motors track, what slips, and where every object ends.

    Exit 0: goal reached, every object within 1 cm of its planned pose. 1: not. 2: bad input.
    """
    from runtime.errors import InputError

    try:
        from runtime.execution.execute import execute, to_json
        from runtime.trace.load import load_trace
        from runtime.trace.write import write_trace

        planned = load_trace(file, scene, robot, sketch)
        report, happened = execute(planned, gui)
        if trace is not None:
            write_trace(happened, trace)
    except InputError as error:
        fail(str(error))
    if as_json:
        click.echo(json.dumps({"plan": str(file)} | to_json(report, planned)))
    else:
        for line in summary(report, str(file)):
            click.echo(line)
        if trace is not None:
            click.echo(f"trace written to {trace}")
    raise SystemExit(0 if report.success else 1)


def summary(report: Report, name: str) -> list[str]:
    """A report in a few lines."""
    near = sum(pose.near for pose in report.objects)
    farthest = max(report.objects, key=lambda pose: pose.error)
    verdict = "goal reached" if report.goal_reached else "goal not reached"
    tracking = report.tracking
    lines = [
        f"{name}: {verdict}, {near} of {len(report.objects)} objects within 10 mm of the plan, "
        f"{report.duration:.0f} s",
        f"  largest error      {1000 * farthest.error:.1f} mm ({farthest.object})",
        f"  tracking, largest  base {1000 * max(tracking.largest[:2]):.1f} mm "
        f"{1000 * tracking.largest[2]:.1f} mrad, joints {1000 * max(tracking.largest[3:]):.1f} mrad",
    ]
    lines += [f"  missing: {message}" for message in report.unmet]
    lines += [f"  {pose.object} has fallen" for pose in report.objects if pose.lean > 0.2]
    for slip in report.slips:
        moved = f", moved {1000 * slip.moved:.1f} mm" if slip.moved else ""
        lines.append(f"  slip at {slip.time:.1f} s: {slip.object}, {slip.what}{moved}")
    lines += [f"  touch at {t.time:.1f} s: {t.link}, {t.thing}" for t in report.touches]
    return lines
