"""`sketchlang run SKETCH SCENE`: plan."""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path
from typing import Any

import click

from sketchlang.cli.common import domain_option, fail, interruptible, load_valid


@click.command(
    epilog="""\b
Examples:
  sketchlang run pick_and_place sorting/4t-07
  sketchlang run pick_and_place sorting/3t-02 --seed 7 --out plan.json
  sketchlang run my.sketch my-scene.toml --timeout 30 --json
"""
)
@click.argument("sketch")
@click.argument("scene")
@click.option("--planner", type=click.Choice(["lazy-siiw-r", "siw-r"]), help="Search algorithm.")
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Same seed, same plan.",
)
@click.option(
    "--timeout",
    type=click.FloatRange(min=0, min_open=True),
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
@click.option("--robot", help="Name or robot file (.toml), where the domain has robots.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write the plan here.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@domain_option
@interruptible
def command(
    sketch: str,
    scene: str,
    planner: str | None,
    seed: int,
    timeout: float,
    k_max: int,
    robot: str | None,
    out: Path | None,
    as_json: bool,
    domain_file: str | None,
) -> None:
    """Plan SCENE with SKETCH: names of built-in ones, or paths.

    Exit 0: solved. 1: no plan found. 2: bad input.
    """
    from runtime.errors import InputError
    from sketchlang.compile import EvaluationError
    from sketchlang.domain import SceneError

    if math.isnan(timeout):
        fail("--timeout: not a number of seconds")
    loaded = load_valid(sketch, domain_file)
    try:
        report = _run(loaded, scene, planner, seed, timeout, k_max, robot, out, as_json)
    except (InputError, SceneError) as error:
        fail(str(error))
    except EvaluationError as error:
        fail(f"the sketch cannot be evaluated: {error}")
    if as_json:
        click.echo(json.dumps(report))
    raise SystemExit(0 if report["solved"] else 1)


def _run(
    loaded: Any,
    scene: str,
    planner: str | None,
    seed: int,
    timeout: float,
    k_max: int,
    robot: str | None,
    out: Path | None,
    as_json: bool,
) -> dict[str, Any]:
    from sketchlang.compile import compile_sketch, obstacles

    checked = loaded.checked
    for obstacle in obstacles(checked):
        fail(f"{obstacle.message}\n  hint: {obstacle.hint}" if obstacle.hint else obstacle.message)
    if checked.domain.load is None:
        fail(f"the domain {checked.domain.name} has no scenes")

    import numpy as np

    from domains.library import find_scene
    from runtime.collector import spared
    from runtime.errors import InputError
    from runtime.report import make_report, summary
    from runtime.search.limits import Limits
    from runtime.search.planners import DEFAULT, PLANNERS
    from runtime.search.problem import searchable

    if out is not None and not out.parent.is_dir():
        raise InputError(f"there is no folder {str(out.parent)!r}", place=str(out))
    compiled = compile_sketch(checked)
    path, name = find_scene(scene)
    options = Options(seed=seed, name=name, robot=robot)
    problem = searchable(_load(checked.domain, path, options))
    if robot is not None and "robot" not in options.asked:
        fail(f"--robot: the domain {checked.domain.name} has no robots")
    planner = planner or DEFAULT
    say = Speaker(quiet=as_json)
    say(f"{compiled.model.name} on {name}, planner {planner}, seed {seed}")
    problem.warm_up()
    limits = Limits(timeout=timeout, k_max=k_max)
    started = time.perf_counter()
    with spared():
        outcome = PLANNERS[planner](
            compiled,
            problem,
            limits,
            np.random.default_rng(seed),
            progress=lambda subgoal, seconds: say(
                f"{seconds:8.2f} s  {subgoal.rule:<14} {problem.describe(subgoal)}"
            ),
        )
    seconds = time.perf_counter() - started
    report = make_report(compiled.model, problem, name, planner, seed, outcome, seconds)
    if out is not None and outcome.solved:
        problem.write_plan(compiled.model, outcome, planner, seed, out)
    if not as_json:
        for line in summary(compiled.model, report, outcome):
            click.echo(line)
        if out is not None and outcome.solved:
            click.echo(f"plan written to {out}")
        elif out is not None and out.exists():
            click.echo(f"{out} was there before and is left as it was")
    return report


class Options(dict[str, object]):
    """Options for a domain's loader; remembers which ones it asked for."""

    def __init__(self, **options: object) -> None:
        super().__init__(options)
        self.asked: set[str] = set()

    def __getitem__(self, key: str) -> object:
        self.asked.add(key)
        return super().__getitem__(key)

    def get(self, key: str, default: object = None) -> object:
        self.asked.add(key)
        return super().get(key, default)


def _load(domain: Any, path: Path, options: Options) -> Any:
    """The problem of a scene; what goes wrong in a domain's own code is said, not raised."""
    from runtime.errors import InputError
    from sketchlang.domain import SceneError

    try:
        return domain.load(str(path), options)
    except (InputError, SceneError):
        raise
    except Exception as error:
        raise InputError(
            f"the scene loader of domain {domain.name} fails: {type(error).__name__}: {error}",
            place=str(path),
        ) from error


class Speaker:
    """Progress for people, on stderr."""

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet

    def __call__(self, text: str) -> None:
        if not self.quiet:
            print(text, file=sys.stderr, flush=True)
