"""What the commands share that walk through a task: `inspect` and `step`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, ParamSpec, TypeVar

import click

from sketchlang.cli import names
from sketchlang.cli.common import (
    Number,
    domain_option,
    domain_pddl_option,
    fail,
    load_valid,
    pddl_of,
)

if TYPE_CHECKING:
    from runtime.inspect.walk import Walk

P = ParamSpec("P")
R = TypeVar("R")


def walk_options(command: Callable[P, R]) -> Callable[P, R]:
    """SKETCH and SCENE, and how the way through the task is searched."""
    for option in (
        domain_pddl_option,
        domain_option,
        click.option(
            "--robot",
            shell_complete=names.robots,
            help="Name or robot file (.toml), where the domain has robots.",
        ),
        click.option(
            "--k-max",
            type=click.IntRange(1, 3),
            default=2,
            show_default=True,
            help="Largest width k of IW(k).",
        ),
        click.option(
            "--timeout",
            type=Number(min=0, min_open=True),
            default=60.0,
            show_default=True,
            metavar="S",
            help="Seconds for each subgoal.",
        ),
        click.option(
            "--planner",
            metavar="NAME",
            default="lazy-siiw-r",
            show_default=True,
            shell_complete=names.planners,
            help="Search algorithm.",
        ),
        click.option(
            "--seed",
            type=click.IntRange(min=0),
            default=0,
            show_default=True,
            help="The seed of `run`: the same subgoals.",
        ),
        click.argument("scene", shell_complete=names.scenes),
        click.argument("sketch", shell_complete=names.sketches),
    ):
        command = option(command)
    return command


def open_walk(
    sketch: str,
    scene: str,
    *,
    seed: int,
    planner: str,
    timeout: float,
    k_max: int,
    robot: str | None,
    domain_file: str | None,
    domain_pddl: str | None,
) -> Walk:
    """The walk through a task; ends the command if it cannot be had."""
    from runtime.inspect.walk import Walk
    from runtime.search.limits import Limits
    from runtime.solve import open_task
    from sketchlang.domain import SceneError
    from sketchlang.errors import InputError

    checked = load_valid(sketch, domain_file, pddl_of(scene, domain_pddl)).checked
    try:
        task = open_task(checked, scene, seed, robot)
        return Walk(task, Limits(timeout=timeout, k_max=k_max), planner)
    except (InputError, SceneError) as error:
        fail(error)
