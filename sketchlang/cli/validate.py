"""`sketchlang validate PLAN`: certify a plan file with exact geometry."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from sketchlang.analysis.words import counted
from sketchlang.cli import names
from sketchlang.cli.common import domain_pddl_option, fail, interruptible, say

if TYPE_CHECKING:
    from runtime.plan.model import Plan
    from sketchlang.compile import CompiledSketch


@click.command(
    epilog="""\b
Examples:
  sketchlang validate plan.json
  sketchlang validate plan.json --sketch pick_and_place
  sketchlang validate plan.json --scene my-scene.toml --robot my-robot.toml
  sketchlang validate plan.txt --scene task.pddl
"""
)
@click.argument("plan", type=click.Path(path_type=Path))
@click.option(
    "--scene",
    shell_complete=names.scenes,
    help="The scene, where the plan does not name a built-in one.",
)
@click.option(
    "--robot",
    shell_complete=names.robots,
    help="The robot, where the plan does not name a built-in one.",
)
@domain_pddl_option
@click.option(
    "--sketch",
    metavar="SKETCH",
    shell_complete=names.sketches,
    help="Also check that the plan is a run of this sketch: its features, rules and goal.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@interruptible
def command(
    plan: Path,
    scene: str | None,
    robot: str | None,
    domain_pddl: str | None,
    sketch: str | None,
    as_json: bool,
) -> None:
    """Replay PLAN in exact geometry, independently of the planner; a plan of a PDDL task by the
    meaning of its domain.

    Checks limits of joints, speeds and accelerations, continuity, collisions of robot, objects
    and floor at a dense resolution, grasps, supports and stability, and the goal. With
    --sketch, features are computed anew and rules and goal of the sketch checked.

    A partial plan, which an unsolved run leaves, is judged as far as it goes, and is not valid.

    Exit 0: valid. 1: not valid. 2: the file cannot be read.
    """
    from domains.pddl.plan import is_plan
    from sketchlang.errors import InputError

    if is_plan(plan):
        _validate_pddl(plan, scene, domain_pddl, as_json)
    try:
        from domains.tabletop.validation import validate
        from runtime.plan.read import read_plan

        document = read_plan(plan)
        started = time.perf_counter()
        certificate = validate(
            document, scene, robot, None if sketch is None else _compiled(sketch)
        )
        seconds = time.perf_counter() - started
    except InputError as error:
        fail(error)
    valid = certificate.valid and document.failure is None
    partial = {} if document.failure is None else {"partial": document.failure.reason}
    if as_json:
        findings = [
            {"action": finding.action, "message": finding.message}
            for finding in certificate.findings
        ]
        click.echo(
            json.dumps(
                {
                    "plan": str(plan),
                    "scene": document.scene,
                    "valid": valid,
                    **partial,
                    "findings": findings,
                    "actions": certificate.actions,
                    "samples": certificate.samples,
                    "time_s": round(seconds, 3),
                }
            )
        )
    elif document.failure is not None:
        _say_partial(plan, document.failure.reason, len(document.subgoals), len(document.actions))
        for finding in certificate.findings:
            _say_finding(finding.action, finding.message, document)
    elif certificate.valid:
        say(
            f"{plan} is valid: {counted(certificate.actions, 'action')} on {document.scene}, "
            f"{certificate.samples} robot configurations free of collision, goal reached"
        )
    else:
        say(f"{plan} is not valid:")
        for finding in certificate.findings:
            _say_finding(finding.action, finding.message, document)
    raise SystemExit(0 if valid else 1)


def _say_finding(number: int | None, message: str, plan: Plan) -> None:
    where = "plan"
    if number is not None:
        where = f"action {number + 1} ({plan.actions[number].text})"
    say(f"  {where}: {message}")


def _say_partial(path: Path, reason: str, subgoals: int | None, actions: int) -> None:
    """That a file is a partial plan, how far it goes, and why not further."""
    after = "" if subgoals is None else f"{counted(subgoals, 'subgoal')} and "
    say(f"{path} is a partial plan, of {after}{counted(actions, 'action')}: {reason}")


def _validate_pddl(
    plan: Path, scene: str | None, domain_pddl: str | None, as_json: bool
) -> NoReturn:
    """Replay a plan of a PDDL task; the task and its domain may be named in the plan's comments."""
    from domains.pddl.interface import domain_beside
    from domains.pddl.plan import read_plan
    from domains.pddl.replay import replay
    from domains.pddl.syntax.read import load, read_domain, read_task
    from runtime.plan.partial import MARK
    from sketchlang.errors import InputError

    try:
        document = read_plan(plan)
        task = scene or document.notes.get("task")
        if task is None:
            fail(f"{plan}: names no task\n  hint: give it with --scene TASK.pddl")
        noted = document.notes.get("domain") if scene is None else None
        domain = read_domain(load(domain_pddl or noted or domain_beside(task)))
        verdict = replay(read_task(load(task), domain), document.steps)
    except InputError as error:
        fail(error)
    reason = document.notes.get(MARK)
    valid = verdict.valid and reason is None
    partial = {} if reason is None else {"partial": reason}
    if as_json:
        found = [{"action": f.action, "message": f.message} for f in verdict.findings]
        report = {"plan": str(plan), "scene": task, "valid": valid, **partial, "findings": found}
        click.echo(json.dumps({**report, "actions": len(document.steps), "cost": verdict.cost}))
    elif valid:
        say(
            f"{plan} is valid: {counted(len(document.steps), 'action')} on {task}, "
            f"cost {verdict.cost}, goal reached"
        )
    else:
        if reason is None:
            say(f"{plan} is not valid:")
        else:
            _say_partial(plan, reason, None, len(document.steps))
        for finding in verdict.findings:
            where = "plan" if finding.action is None else f"action {finding.action + 1}"
            if finding.action is not None:
                step = document.steps[finding.action]
                where += f" ({' '.join((step.name, *step.arguments))})"
            say(f"  {where}: {finding.message}")
    raise SystemExit(0 if valid else 1)


def _compiled(name: str) -> CompiledSketch:
    """The sketch of a name or file, ready to be evaluated.

    Raises:
        InputError: it cannot be read, has errors, or cannot be run.
    """
    from sketchlang.compile import compile_sketch, obstacles
    from sketchlang.errors import InputError
    from sketchlang.loader import load_sketch

    loaded = load_sketch(name)
    if not loaded.ok:
        raise InputError(
            "the sketch has errors", place=name, hint=f"`sketchlang check {name}` lists them"
        )
    for obstacle in obstacles(loaded.checked):
        raise InputError(obstacle.message, place=name, hint=obstacle.hint)
    return compile_sketch(loaded.checked)
