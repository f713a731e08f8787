"""`sketchlang export PLAN`: trajectories for robots, models for others' tools."""

from __future__ import annotations

import json
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

ROUNDING = 0.01
"""Seconds by which `--at` may be beyond the end: durations are printed rounded."""


@click.command(
    epilog="""\b
Examples:
  sketchlang export plan.json --steps steps.json
  sketchlang export plan.json --moveit moveit.json --frame odom
  sketchlang export plan.json --bag bag --glb scene.glb --at 20
  sketchlang export gripper --dlplan policy.txt
"""
)
@trace_options
@click.option(
    "--steps",
    "steps_file",
    type=FILE,
    help="Write the goals for the robot's controllers, step by step, as JSON, which is YAML.",
)
@click.option(
    "--moveit",
    "moveit_file",
    type=FILE,
    help="Write a planning scene, and for each step its RobotTrajectory.",
)
@click.option(
    "--trajectory",
    type=FILE,
    help="Write the whole motion as two JointTrajectory messages.",
)
@click.option("--bag", type=click.Path(path_type=Path), help="Write a ROS 2 bag, a new folder.")
@click.option("--glb", type=FILE, help="Write a 3D model.")
@click.option(
    "--dlplan",
    "dlplan_file",
    type=FILE,
    help="FILE is a sketch of a PDDL domain: write it as a policy of dlplan.",
)
@click.option(
    "--runir",
    "runir_file",
    type=FILE,
    help="The same, as a policy of runir.",
)
@click.option(
    "--at",
    type=Number(min=0),
    default=0.0,
    show_default=True,
    metavar="S",
    help="The time that the model shows.",
)
@click.option(
    "--frame",
    default="map",
    show_default=True,
    metavar="NAME",
    help="The frame of the scene in steps, planning scene and bag.",
)
@click.option(
    "--rate",
    type=Number(min=0.1, max=1000),
    default=20.0,
    show_default=True,
    metavar="HZ",
    help="Messages a second on each topic of the bag.",
)
@click.option(
    "--meshes",
    metavar="URI",
    help="Where the bag's robot_description finds its meshes.  [default: in the bag]",
)
@interruptible
def command(
    file: Path,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    domain_file: str | None,
    steps_file: Path | None,
    moveit_file: Path | None,
    trajectory: Path | None,
    bag: Path | None,
    glb: Path | None,
    dlplan_file: Path | None,
    runir_file: Path | None,
    at: float,
    frame: str,
    rate: float,
    meshes: str | None,
) -> None:
    """Write FILE, a plan or a trace, in formats of others; or a sketch as a policy.

    What of a sketch a policy cannot say is named: a feature with its place, and then nothing is
    written; goal, invariants and atoms in a note.

    Exit 0: written. 2: a feature cannot be said there, or bad input.
    """
    from sketchlang.errors import InputError

    outputs = {
        "--steps": steps_file,
        "--moveit": moveit_file,
        "--trajectory": trajectory,
        "--bag": bag,
        "--glb": glb,
        "--dlplan": dlplan_file,
        "--runir": runir_file,
    }
    if not any(outputs.values()):
        fail(f"nothing to write: give one of {', '.join(outputs)}")
    if not frame.strip("/").strip():
        fail("--frame: a frame has a name")
    check_outputs((file, scene, robot, sketch, domain_file), outputs, folders=("--bag",))
    policies = {"dlplan": dlplan_file, "runir": runir_file}
    if any(policies.values()):
        if any((steps_file, moveit_file, trajectory, bag, glb)):
            fail("--dlplan and --runir write a sketch, the other options a plan")
        _write_policies(str(file), domain_file, policies)
        return
    try:
        if bag is not None:
            from runtime.export.bag import check_bag

            check_bag(bag)
        trace = load_named(file, scene, robot, sketch, domain_file)
        check_outputs((), outputs, folders=("--bag",))  # again: what a plan names was read now
        if glb is not None and at > trace.duration + ROUNDING:
            fail(f"--at: {at:g} s is after the end, {trace.duration:.2f} s")
        if steps_file is not None or moveit_file is not None:
            _write_steps(trace, steps_file, moveit_file, frame)
        if trajectory is not None:
            from runtime.export.messages import trajectories
            from sketchlang.files import write_text

            write_text(trajectory, json.dumps(trajectories(trace), indent=1) + "\n")
            say(f"trajectories written to {trajectory}")
        if bag is not None:
            from runtime.export.bag import BagOptions, write_bag

            write_bag(trace, bag, BagOptions(rate, frame, meshes))
            say(f"bag written to {bag}")
        if glb is not None:
            from runtime.export.model import glb as model
            from sketchlang.files import write_bytes

            write_bytes(glb, model(trace, min(at, trace.duration)))
            say(f"model written to {glb}")
    except InputError as error:
        fail(error)


def _write_policies(sketch: str, domain_file: str | None, paths: dict[str, Path | None]) -> None:
    """Write a sketch in the notations that have a path; all of them or none."""
    from domains.pddl.interchange import export
    from domains.pddl.interface import PddlInterface
    from sketchlang.errors import InputError
    from sketchlang.files import write_text
    from sketchlang.loader import load_sketch

    try:
        loaded = load_sketch(sketch, domain_file)
    except InputError as error:
        fail(error)
    # Again, for what the sketch includes was read now.
    check_outputs((), {f"--{name}": path for name, path in paths.items()})
    checked = loaded.checked
    if not loaded.ok:
        fail(InputError("the sketch has errors: see `sketchlang check`", place=sketch))
    if not isinstance(checked.domain, PddlInterface):
        fail(InputError("policies are about PDDL domains, and its domain is none", place=sketch))
    written = {}
    for name, path in paths.items():
        if path is not None:
            try:
                writer = export.to_dlplan if name == "dlplan" else export.to_runir
                written[path] = writer(checked, checked.domain)
            except InputError as error:
                fail(error)
    for path, policy in written.items():
        write_text(path, policy.text)
        say(f"{path}: {counted(len(checked.model.rules), 'rule')}")
        say(*(f"note: {note}" for note in policy.notes), err=True)


def _write_steps(
    trace: Trace, steps_file: Path | None, moveit_file: Path | None, frame: str
) -> None:
    from runtime.export.as_json import steps_to_json
    from runtime.export.moveit import moveit
    from runtime.export.steps import steps_of, summary
    from sketchlang.files import write_text

    steps = steps_of(trace, frame)
    if steps_file is not None:
        write_text(steps_file, json.dumps(steps_to_json(trace, steps, frame), indent=1) + "\n")
        say(f"{summary(steps)}, written to {steps_file}")
    if moveit_file is not None:
        write_text(moveit_file, json.dumps(moveit(trace, steps, frame), indent=1) + "\n")
        trajectories = counted(len(steps), "trajectory", "trajectories")
        say(f"planning scene and {trajectories} written to {moveit_file}")
