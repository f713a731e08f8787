"""`sketchlang send PLAN --rosbridge URL`: a plan to the controllers of a robot."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sketchlang.cli.common import Number, fail, interruptible, load_named, say, trace_options

if TYPE_CHECKING:
    from runtime.export.send import Failure
    from runtime.export.steps import Step
    from runtime.trace.model import Trace


@click.command(
    epilog="""\b
Examples:
  sketchlang send plan.json --dry-run
  sketchlang send plan.json --rosbridge ws://robot:9090
  sketchlang send plan.json --rosbridge ws://robot:9090 --from 12
"""
)
@trace_options
@click.option("--rosbridge", metavar="URL", help="The rosbridge server, such as ws://robot:9090.")
@click.option("--dry-run", is_flag=True, help="Print the steps and send nothing.")
@click.option(
    "--from",
    "first",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    metavar="STEP",
    help="Begin with this step.",
)
@click.option(
    "--frame",
    default="map",
    show_default=True,
    metavar="NAME",
    help="The frame of the scene: where base poses are given.",
)
@click.option(
    "--patience",
    type=Number(min=0, max=3600),
    default=10.0,
    show_default=True,
    metavar="S",
    help="Seconds beyond one and a half times its duration that a goal may take.",
)
@click.option(
    "--unseen",
    is_flag=True,
    help="Do not ask where the robot's joints are before the first step.",
)
@click.option(
    "--untimed",
    is_flag=True,
    help="Send steps in which base and arm move at once to a base that keeps no times.",
)
@interruptible
def command(
    file: Path,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    domain_file: str | None,
    rosbridge: str | None,
    dry_run: bool,
    first: int,
    frame: str,
    patience: float,
    unseen: bool,
    untimed: bool,
) -> None:
    """Send FILE, a plan, to a robot's controllers, step by step.

    Each step is sent when all goals of the one before have succeeded. At the first failure the
    rest of its step is cancelled, and it is said how to go on. Before the first step it is
    asked where the joints are: the robot has to be where that step starts, or to have stopped
    within it.

    Exit 0: all steps succeeded. 1: it stopped at one. 2: bad input.
    """
    from sketchlang.errors import InputError

    if dry_run == (rosbridge is not None):
        fail("give either --rosbridge URL or --dry-run")
    try:
        from runtime.export.rosbridge import check_rosbridge
        from runtime.export.steps import steps_of, summary

        if rosbridge is not None:
            check_rosbridge(rosbridge)
        _refuse_partial(file)
        trace = load_named(file, scene, robot, sketch, domain_file)
        steps = steps_of(trace, frame)
        if first >= max(len(steps), 1):
            fail(f"--from: there is no step {first}; the last one is {len(steps) - 1}")
        if dry_run:
            for step in steps[first:]:
                say(_line(step, len(steps)))
            say(summary(steps[first:]))
            return
        assert rosbridge is not None
        if not untimed:
            _refuse_untimed(steps[first:])
        failure = _send(trace, steps, first, rosbridge, frame, patience, unseen)
    except InputError as error:
        fail(error)
    if failure is not None:
        number = failure.step.number
        say(f"stopped at step {number}: {failure.controller}: {failure.reason}")
        say(f"to go on when the cause is gone: --from {number}")
        raise SystemExit(1)
    say(f"done: {summary(steps[first:])}")


def _refuse_partial(file: Path) -> None:
    """Half a plan leaves a robot, and whatever it holds, where it should not stay."""
    from runtime.plan.node import read_json
    from sketchlang.errors import InputError

    data = read_json(file).value
    if isinstance(data, dict) and data.get("failure") is not None:
        raise InputError(
            "this plan does not reach its goal",
            place=str(file),
            hint="`sketchlang run` said why; to look at its steps: sketchlang export --steps",
        )


def _refuse_untimed(steps: Sequence[Step]) -> None:
    """Where base and arm move at once, a plan is free of collision at its own times only."""
    from sketchlang.errors import InputError

    for step in steps:
        if step.untimed is not None:
            raise InputError(
                f"step {step.number} moves base and arm at once, and {step.untimed} keeps no times",
                hint="plan with `run --in-turn`, or name a controller that does in the robot file",
            )


def _send(
    trace: Trace,
    steps: Sequence[Step],
    first: int,
    url: str,
    frame: str,
    patience: float,
    unseen: bool,
) -> Failure | None:
    from runtime.export.resume import resumed
    from runtime.export.rosbridge import RosBridge
    from runtime.export.send import Failure, send
    from sketchlang.errors import InputError

    def report(step: Step, took: float | None) -> None:
        if took is None:
            say(_line(step, len(steps)), err=True)
        else:
            say(f"    done in {took:.1f} s", err=True)

    left = list(steps[first:])
    with RosBridge(url) as bridge:
        if left and not unseen:
            found = bridge.joint_values(timeout=5.0)
            if found is None:
                return Failure(left[0], "/joint_states", "the robot does not say where it is")
            try:
                left[0] = resumed(trace, left[0], found, frame)
            except InputError as error:
                hint = f" ({error.hint})" if error.hint else ""
                return Failure(left[0], "/joint_states", f"{error.message}{hint}")
        return send(left, bridge, report, patience)


def _line(step: Step, count: int) -> str:
    """A step in one line."""
    who = ", ".join(goal.controller.name for goal in step.goals)
    grip = ""
    if step.grip is not None:
        grip = f", {'grasps' if step.grip.attach else 'releases'} {step.grip.object}"
    return f"{step.number:>4}/{count - 1}  {step.text}: {who}, {step.duration:.1f} s{grip}"
