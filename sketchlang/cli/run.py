"""`sketchlang run SKETCH SCENE`: plan."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sketchlang.cli import names
from sketchlang.cli.common import (
    FILE,
    Number,
    check_outputs,
    domain_option,
    domain_pddl_option,
    fail,
    interruptible,
    load_valid,
    pddl_of,
    say,
)

if TYPE_CHECKING:
    from runtime.improve import Improvement
    from runtime.solve import Result
    from sketchlang.loader import Loaded


@click.command(
    epilog="""\b
Examples:
  sketchlang run pick_and_place sorting/4t-07
  sketchlang run pick_and_place sorting/3t-02 --seed 7 --out plan.json
  sketchlang run my.sketch my-scene.toml --timeout 30 --json
  sketchlang run childsnack task.pddl --out plan.txt
"""
)
@click.argument("sketch", shell_complete=names.sketches)
@click.argument("scene", shell_complete=names.scenes)
@click.option("--planner", type=click.Choice(names.PLANNERS), help="Search algorithm.")
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Same seed, same plan.",
)
@click.option(
    "--timeout",
    type=Number(min=0, min_open=True),
    default=300.0,
    show_default=True,
    metavar="S",
    help="Seconds of planning.",
)
@click.option(
    "--k-max",
    type=click.IntRange(1, 3),
    default=2,
    show_default=True,
    help="Largest width k of IW(k).",
)
@click.option(
    "--robot",
    shell_complete=names.robots,
    help="Name or robot file (.toml), where the domain has robots.",
)
@click.option(
    "--in-turn",
    is_flag=True,
    help="Base and arm never move at once: for a robot whose base keeps no times.",
)
@click.option(
    "--out",
    type=FILE,
    help="Write the plan here; of an unsolved run, what it reached to NAME.unsolved.json.",
)
@click.option(
    "--improve",
    type=Number(min=0),
    default=0.0,
    show_default=True,
    metavar="S",
    help="Seconds in which a plan that was found is made shorter to execute.",
)
@click.option(
    "--improve-steps",
    type=click.IntRange(min=0),
    metavar="N",
    help="At most so many changes are tried: without --improve, the same seed gives the same plan.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@domain_option
@domain_pddl_option
@interruptible
def command(
    sketch: str,
    scene: str,
    planner: str | None,
    seed: int,
    timeout: float,
    k_max: int,
    robot: str | None,
    in_turn: bool,
    out: Path | None,
    improve: float,
    improve_steps: int | None,
    as_json: bool,
    domain_file: str | None,
    domain_pddl: str | None,
) -> None:
    """Plan SCENE with SKETCH: names of built-in ones, or paths. SCENE may be a PDDL task.

    Exit 0: solved. 1: no plan found. 2: bad input.
    """
    from runtime.improve import Improvement
    from sketchlang.compile import EvaluationError
    from sketchlang.domain import SceneError
    from sketchlang.errors import InputError

    improvement = Improvement(improve, improve_steps)
    loaded = load_valid(sketch, domain_file, pddl_of(scene, domain_pddl))
    check_outputs((sketch, scene, robot, domain_file, domain_pddl), {"--out": out})
    try:
        report = _run(
            loaded, scene, planner, seed, timeout, k_max, robot, in_turn, out, as_json, improvement
        )
    except (InputError, SceneError) as error:
        fail(error)
    except EvaluationError as error:
        fail(f"the sketch cannot be evaluated: {error}")
    if as_json:
        click.echo(json.dumps(report))
    raise SystemExit(0 if report["solved"] else 1)


def _run(
    loaded: Loaded,
    scene: str,
    planner: str | None,
    seed: int,
    timeout: float,
    k_max: int,
    robot: str | None,
    in_turn: bool,
    out: Path | None,
    as_json: bool,
    improvement: Improvement,
) -> dict[str, Any]:
    from runtime.report import make_report, step_in_words, summary
    from runtime.search.limits import Limits
    from runtime.search.planners import DEFAULT
    from runtime.solve import open_task

    task = open_task(loaded.checked, scene, seed, robot, in_turn)
    check_outputs((), {"--out": out})  # again, for what a scene or a robot names was read now
    planner = planner or DEFAULT
    progress = Speaker(quiet=as_json)
    progress(f"{task.sketch.model.name} on {task.scene}, planner {planner}, seed {seed}")
    warnings = task.warnings()
    for warning in warnings:
        progress(f"warning: {warning['text']}")
    result = task.solve(
        Limits(timeout=timeout, k_max=k_max),
        planner,
        progress=lambda step, seconds: progress(f"{seconds:8.2f} s  {step_in_words(task, step)}"),
        improve=improvement,
        told=lambda tried, seconds: progress(
            f"{improvement.seconds_taken:8.2f} s  {seconds:.1f} s to execute, after {tried} changes"
        ),
    )
    report = make_report(result)
    if warnings:
        report["warnings"] = warnings
    said = _save(result, out)
    if not as_json:
        for line in summary(report) + said:
            say(line)
    return report


def _save(result: Result, out: Path | None) -> list[str]:
    """Write the plan, or what an unsolved run reached beside it, and say so."""
    from runtime.plan.partial import may_write, partial_path
    from sketchlang.errors import InputError
    from sketchlang.files import is_special

    if out is None:
        return []
    if result.solved:
        result.plan.save(out)
        return [f"plan written to {out}"]
    said = [f"{out} was there before and is left as it was"] if out.exists() else []
    partial = partial_path(out)
    if is_special(out):
        return []
    if not may_write(partial):
        return [*said, f"{partial} is no partial plan and is left as it was"]
    try:
        result.plan.save(partial)
    except InputError as error:
        return [*said, f"what was reached is not written: {error}"]
    return [*said, f"what was reached is written to {partial}"]


class Speaker:
    """Progress for people, on stderr."""

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet

    def __call__(self, text: str) -> None:
        if not self.quiet:
            say(text, err=True)
