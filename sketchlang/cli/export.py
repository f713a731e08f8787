"""`sketchlang export PLAN`: trajectories for robots, models for others' tools."""

from __future__ import annotations

import json
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

ROUNDING = 0.01
"""Seconds by which `--at` may be beyond the end: durations are printed rounded."""


@click.command(
    epilog="""\b
Examples:
  sketchlang export plan.json --trajectory trajectory.yaml
  sketchlang export plan.json --bag bag --glb scene.glb --at 20
"""
)
@trace_options
@click.option(
    "--trajectory",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write ROS 2 JointTrajectory messages, as JSON, which is YAML.",
)
@click.option("--bag", type=click.Path(path_type=Path), help="Write a ROS 2 bag, a new folder.")
@click.option("--glb", type=click.Path(path_type=Path, dir_okay=False), help="Write a 3D model.")
@click.option(
    "--at",
    type=Number(min=0),
    default=0.0,
    show_default=True,
    metavar="S",
    help="The time that the model shows.",
)
@interruptible
def command(
    file: Path,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    domain_file: str | None,
    trajectory: Path | None,
    bag: Path | None,
    glb: Path | None,
    at: float,
) -> None:
    """Write FILE, a plan or a trace, in formats of others.

    Exit 0: written. 2: bad input.
    """
    from sketchlang.errors import InputError

    if trajectory is None and bag is None and glb is None:
        fail("nothing to write: give --trajectory, --bag or --glb")
    outputs = {"--trajectory": trajectory, "--bag": bag, "--glb": glb}
    check_outputs((file, scene, robot, sketch, domain_file), outputs, folders=("--bag",))
    try:
        if bag is not None:
            from runtime.export.bag import check_bag

            check_bag(bag)
        trace = load_named(file, scene, robot, sketch, domain_file)
        check_outputs((), outputs, folders=("--bag",))  # again: what a plan names was read now
        if glb is not None and at > trace.duration + ROUNDING:
            fail(f"--at: {at:g} s is after the end, {trace.duration:.2f} s")
        if trajectory is not None:
            from runtime.export.messages import trajectories
            from sketchlang.files import write_text

            write_text(trajectory, json.dumps(trajectories(trace), indent=1) + "\n")
            say(f"trajectories written to {trajectory}")
        if bag is not None:
            from runtime.export.bag import write_bag

            write_bag(trace, bag)
            say(f"bag written to {bag}")
        if glb is not None:
            from runtime.export.model import glb as model
            from sketchlang.files import write_bytes

            write_bytes(glb, model(trace, min(at, trace.duration)))
            say(f"model written to {glb}")
    except InputError as error:
        fail(error)
