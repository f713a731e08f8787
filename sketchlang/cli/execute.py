"""`sketchlang execute PLAN`: under physics, open loop; or a sketch and a scene, closed loop."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from sketchlang.analysis.words import counted
from sketchlang.cli import names
from sketchlang.cli.common import (
    FILE,
    check_outputs,
    fail,
    interruptible,
    load_named,
    load_valid,
    named_options,
    say,
)

if TYPE_CHECKING:
    from runtime.physics.execute import Report
    from runtime.trace.model import Trace, TraceRobot

# Those of `domains.tabletop.loop.disturb`, which is imported only where it is needed.
DISTURBANCES = ("none", "pushed", "failed-grasp", "dropped", "obstacle", "noise")


@click.command(
    epilog="""\b
Examples:
  sketchlang execute plan.json
  sketchlang execute plan.json --gui
  sketchlang execute plan.json --json --trace executed.json
  sketchlang execute pick_and_place sorting/4t-07 --closed-loop --disturbance pushed --seed 3
"""
)
@click.argument("file", shell_complete=names.sketches)
@click.argument("scene_argument", metavar="[SCENE]", required=False, shell_complete=names.scenes)
@named_options
@click.option("--closed-loop", is_flag=True, help="FILE is a sketch: sense and plan as it goes.")
@click.option(
    "--disturbance",
    type=click.Choice(DISTURBANCES),
    default="none",
    show_default=True,
    help="What goes wrong in the closed loop.",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Of the closed loop: same seed, same disturbances, same plans.",
)
@click.option("--gui", is_flag=True, help="Watch it in PyBullet's window.")
@click.option(
    "--trace",
    type=FILE,
    help="Write the trace of what happened.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@interruptible
def command(
    file: str,
    scene_argument: str | None,
    scene: str | None,
    robot: str | None,
    sketch: str | None,
    closed_loop: bool,
    disturbance: str,
    seed: int,
    gui: bool,
    trace: Path | None,
    as_json: bool,
) -> None:
    """Execute FILE under physics (PyBullet).

    FILE is a plan or a trace. Reports how well the motors track, what slips, and where every
    object ends. With --closed-loop it is a sketch, to be executed in SCENE: sense, plan one
    subgoal, carry it out, and again, whatever --disturbance does meanwhile.

    Exit 0: goal reached, and every object within 1 cm of its planned pose, where there is a
    plan. 1: not. 2: bad input.
    """
    from sketchlang.errors import InputError

    if closed_loop:
        if scene_argument is None:
            fail("--closed-loop wants a sketch and a scene: sketchlang execute SKETCH SCENE")
        if scene is not None or sketch is not None:
            fail("--scene and --sketch are for plans: the closed loop takes SKETCH and SCENE")
        check_outputs((file, scene_argument, robot), {"--trace": trace})
        _closed(file, scene_argument, robot, disturbance, seed, gui, trace, as_json)
    if scene_argument is not None or disturbance != "none" or seed:
        fail("a plan is executed as it is: SCENE, --disturbance and --seed need --closed-loop")
    check_outputs((file, scene, robot, sketch), {"--trace": trace})
    try:
        from runtime.physics.execute import execute, to_json
        from runtime.trace.write import write_trace

        planned = load_named(Path(file), scene, robot, sketch)
        check_outputs((), {"--trace": trace})  # again: what a plan names was read now
        report, happened = execute(planned, gui)
        if trace is not None:
            write_trace(happened, trace)
    except InputError as error:
        fail(error)
    if as_json:
        largest = {"tracking_largest": largest_errors(report, planned.robot)}
        click.echo(json.dumps({"plan": file} | to_json(report, planned) | largest))
    else:
        for line in summary(report, file, planned.robot):
            say(line)
        if trace is not None:
            say(f"trace written to {trace}")
    raise SystemExit(0 if report.success else 1)


def largest_errors(report: Report, robot: TraceRobot) -> dict[str, float]:
    """The largest tracking errors by kind: a torso slides, its error is no angle."""
    largest = report.tracking.largest
    joints = list(zip(map(robot.joint, robot.joints), largest[3:].tolist(), strict=True))
    turning = [error for joint, error in joints if joint.type != "prismatic"]
    sliding = [error for joint, error in joints if joint.type == "prismatic"]
    return {
        "base_m": round(float(max(largest[:2])), 6),
        "heading_rad": round(float(largest[2]), 6),
        "turning_joints_rad": round(max(turning, default=0.0), 6),
        "sliding_joints_m": round(max(sliding, default=0.0), 6),
    }


def summary(report: Report, name: str, robot: TraceRobot) -> list[str]:
    """A report in a few lines."""
    near = sum(pose.near for pose in report.objects)
    farthest = max(report.objects, key=lambda pose: pose.error, default=None)
    verdict = "goal reached" if report.goal_reached else "goal not reached"
    base, heading, turning, sliding = (
        1000 * error for error in largest_errors(report, robot).values()
    )
    lines = [
        f"{name}: {verdict}, {near} of {counted(len(report.objects), 'object')} within 10 mm of "
        f"the plan, {report.duration:.0f} s",
        f"  tracking, largest  base {base:.1f} mm {heading:.1f} mrad, "
        f"joints {turning:.1f} mrad {sliding:.1f} mm",
    ]
    if farthest is not None:
        lines.insert(1, f"  largest error      {1000 * farthest.error:.1f} mm ({farthest.object})")
    lines += [f"  missing: {message}" for message in report.unmet]
    lines += [f"  {pose.object} has fallen" for pose in report.objects if pose.lean > 0.2]
    for slip in report.slips:
        moved = f", moved {1000 * slip.moved:.1f} mm" if slip.moved else ""
        lines.append(f"  slip at {slip.time:.1f} s: {slip.object}, {slip.what}{moved}")
    lines += [f"  touch at {t.time:.1f} s: {t.link}, {t.thing}" for t in report.touches]
    return lines


def _closed(
    sketch: str,
    scene: str,
    robot: str | None,
    disturbance: str,
    seed: int,
    gui: bool,
    trace: Path | None,
    as_json: bool,
) -> NoReturn:
    """Execute a sketch closed loop, print the verdict, and end."""
    from sketchlang.compile import EvaluationError, compile_sketch, obstacles
    from sketchlang.errors import InputError

    loaded = load_valid(sketch)
    for obstacle in obstacles(loaded.checked):
        fail(obstacle.message)
    if loaded.checked.domain is None or loaded.checked.domain.name != "tabletop":
        fail("only sketches of the domain tabletop can be executed")
    try:
        from domains.tabletop.loop.closed_loop import ClosedLoop
        from domains.tabletop.scene.load import load_scene
        from runtime.robot.load import DEFAULT_ROBOT, load_robot
        from runtime.trace.sketch import trace_sketch
        from runtime.trace.write import write_trace
        from sketchlang.library import find_scene

        path, name = find_scene(scene)
        loop = ClosedLoop(
            compile_sketch(loaded.checked),
            trace_sketch(loaded),
            load_scene(path, name),
            load_robot(robot or DEFAULT_ROBOT),
            seed,
            disturbance,
            gui,
        )
        check_outputs((), {"--trace": trace})  # again: what a robot names was read now
        verdict, happened = loop.run()
        if trace is not None and happened is not None:
            write_trace(happened, trace)
    except InputError as error:
        fail(error)
    except EvaluationError as error:
        fail(f"the sketch cannot be evaluated: {error}")
    events = () if happened is None else happened.events
    if as_json:
        report = {
            "sketch": loaded.checked.model.name,
            "scene": name,
            "disturbance": disturbance,
            "seed": seed,
            "goal_reached": verdict.goal_reached,
            "reason": verdict.reason,
            "subplans": verdict.subplans,
            "broken_off": verdict.broken_off,
            "duration_s": round(verdict.duration, 3),
            "events": [{"time": round(e.time, 3), "kind": e.kind, "text": e.text} for e in events],
        }
        click.echo(json.dumps(report))
    else:
        for event in events:
            say(f"{event.time:8.1f} s  {event.kind:<12} {event.text}")
        say(
            f"{'goal reached' if verdict.goal_reached else verdict.reason}: "
            f"{counted(verdict.subplans, 'subplan')}, {verdict.broken_off} broken off, "
            f"{counted(len(verdict.touches), 'touch', 'touches')}, {verdict.duration:.0f} s"
        )
    if trace is not None:
        _tell_of_trace(trace, happened, as_json)
    raise SystemExit(0 if verdict.goal_reached else 1)


def _tell_of_trace(path: Path, happened: Trace | None, as_json: bool) -> None:
    if happened is None:
        # Standard output belongs to the one object.
        say("nothing was done: no trace was written", err=as_json)
    elif not as_json:
        say(f"trace written to {path}")
