"""`sketchlang inspect SKETCH SCENE`: what a sketch sees in a state, and why."""

from __future__ import annotations

from typing import Any

import click

from sketchlang.cli.common import fail, interruptible, say
from sketchlang.cli.tasks import open_walk, walk_options


@click.command(
    "inspect",
    epilog="""\b
Examples:
  sketchlang inspect pick_and_place sorting/4t-07
  sketchlang inspect my.sketch my-scene.toml --after 3
  sketchlang inspect childsnack task.pddl --after 10 --json
""",
)
@walk_options
@click.option(
    "--after",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    metavar="N",
    help="Look at the state after N subgoals of a run.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@interruptible
def command(sketch: str, scene: str, after: int, as_json: bool, **options: Any) -> None:
    """Show the value of every feature and what makes it so, which rules apply and which
    condition keeps the others from it, at the start of SCENE or after some subgoals.

    Names of built-in sketches and scenes, or paths; SCENE may be a PDDL task.

    Exit 0: shown, even where the run ended before. 2: bad input.
    """
    from sketchlang.compile import EvaluationError
    from sketchlang.domain import SceneError
    from sketchlang.errors import InputError
    from sketchlang.escape import dumps

    walk = open_walk(sketch, scene, **options)
    from runtime.inspect.look import look, look_data, look_lines, where

    try:
        seen = look(walk, after)
    except (InputError, SceneError) as error:
        fail(error)
    except EvaluationError as error:
        fail(f"the sketch cannot be evaluated: {error}")
    if as_json:
        click.echo(dumps(look_data(walk, seen)))
        return
    task = walk.task
    say(f"{task.sketch.model.name} on {task.scene}, seed {task.seed}, {where(seen.reached)}", "")
    say(*look_lines(seen))
