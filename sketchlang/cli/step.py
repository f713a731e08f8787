"""`sketchlang step SKETCH SCENE`: a run, subgoal by subgoal."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from typing import Any

import click

from sketchlang.cli.common import fail, interruptible, say
from sketchlang.cli.tasks import open_walk, walk_options

PROMPT = "> "
WIDTH = 100
"""Columns of what is no terminal."""


@click.command(
    "step",
    epilog="""\b
Commands:
  enter, n   the next subgoal: rule, actions, what changes
  b          back
  g N        to the state after N subgoals
  f          features with their values, and why
  r          rules: which apply, and what keeps the others from it
  s          the scene as it is now
  q          end

\b
Examples:
  sketchlang step pick_and_place sorting/4t-07
  sketchlang step childsnack task.pddl
  printf 'g 3\\nf\\nq\\n' | sketchlang step delivery_s5 delivery/walls
""",
)
@walk_options
@interruptible
def command(sketch: str, scene: str, **options: Any) -> None:
    """Walk through a run of SKETCH on SCENE, subgoal by subgoal. Each is searched for when it is
    asked for.

    Commands are read from the terminal, or one a line from standard input.

    Exit 0: ended. 2: bad input, or no commands.
    """
    from sketchlang.compile import EvaluationError
    from sketchlang.domain import SceneError
    from sketchlang.errors import InputError
    from sketchlang.render import console

    walk = open_walk(sketch, scene, **options)
    from runtime.inspect.stepping import HELP, Stepper

    at_terminal = sys.stdin.isatty()
    colour = console.wants_colour(sys.stdout)
    width = shutil.get_terminal_size((WIDTH, 40)).columns if sys.stdout.isatty() else WIDTH
    stepper = Stepper(walk, width, colour)
    try:
        task = walk.task
        say(f"{task.sketch.model.name} on {task.scene}, seed {task.seed}", *stepper.here())
        if at_terminal:
            say(HELP)
        read = 0
        for line in _lines(at_terminal):
            read += 1
            if not at_terminal:
                say(f"{PROMPT}{line}")
            reply = stepper.answer(line)
            if reply.quits:
                return
            for each in reply.lines:
                # Scenes come with codes for colours, and fit to be shown.
                click.echo(each) if line.strip() == "s" else say(each)
    except (InputError, SceneError) as error:
        fail(error)
    except EvaluationError as error:
        fail(f"the sketch cannot be evaluated: {error}")
    if not read and not at_terminal:
        fail(
            "standard input is no terminal and holds no commands",
            hint="give commands one a line, as in: printf '\\nf\\nq\\n' | sketchlang step ...",
        )


def _lines(at_terminal: bool) -> Iterator[str]:
    """Lines of input until they end (Ctrl-D)."""
    if not at_terminal:
        yield from (line.rstrip("\r\n") for line in sys.stdin)
        return
    import contextlib

    with contextlib.suppress(ImportError):
        import readline  # noqa: F401 (lines can be edited where it is there)
    while True:
        try:
            yield input(PROMPT)
        except EOFError:
            click.echo()
            return
