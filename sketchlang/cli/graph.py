"""`sketchlang graph`: pictures of a sketch."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from sketchlang.cli import names
from sketchlang.cli.common import (
    FILE,
    check_outputs,
    domain_option,
    fail,
    interruptible,
    load_valid,
)

if TYPE_CHECKING:
    from sketchlang.loader import Loaded

SUFFIXES = {".svg": "svg", ".dot": "dot", ".gv": "dot", ".mmd": "mermaid", ".mermaid": "mermaid"}


@click.command("graph")
@click.argument("file", metavar="FILE", shell_complete=names.sketches)
@click.option(
    "--view",
    type=click.Choice(["groups", "policy", "rules"]),
    default="groups",
    show_default=True,
    help="Valuations with the same rules in one box; all valuations; or rules.",
)
@click.option(
    "--format",
    "format_",
    type=click.Choice(["svg", "dot", "mermaid"]),
    help="What to write [default: by the name of OUT, or dot]",
)
@click.option(
    "-o",
    "--out",
    type=FILE,
    metavar="OUT",
    help="Write to a file, not to standard output.",
)
@click.option(
    "--scene",
    shell_complete=names.scenes,
    help="Mark where a run of this scene starts.",
)
@domain_option
@interruptible
def command(
    *,
    file: str,
    view: str,
    format_: str | None,
    out: Path | None,
    scene: str | None,
    domain_file: str | None,
) -> None:
    """Draw how a sketch works, and why it terminates or does not.

    Arrows have the colour of the step of the proof that removes them; the legend says what
    that step is; all arrows of one colour between two boxes are one. A valuation has the colour
    of the step after which no arrow leads on from it. A run that never ends is drawn in red.
    Green is the goal, pale red are valuations without a rule.

    Exit 0 if the picture was written, 2 if the file cannot be read or has errors, or is too
    large for the view.

    \b
    Examples:
      sketchlang graph pick_and_place -o sketch.svg
      sketchlang graph pick_and_place --view rules --format mermaid
      sketchlang graph pick_and_place --view policy --scene sorting/4t-07 -o policy.svg
    """
    loaded = load_valid(file, domain_file)
    model = loaded.checked.model
    from sketchlang.analysis.graph import dot, mermaid, svg
    from sketchlang.analysis.graph.drawing import TooLargeError
    from sketchlang.analysis.graph.views import VIEWS
    from sketchlang.analysis.termination import decide_termination

    if format_ is None:
        format_ = SUFFIXES.get(out.suffix.lower()) if out else "dot"
        if format_ is None:
            fail(f"{out}: no format has this suffix; add --format svg, dot or mermaid")
    check_outputs([], {"--out": out})
    start = None if scene is None else _start(loaded, scene)
    verdict = decide_termination(model)
    writers = {"svg": svg.write, "dot": dot.write, "mermaid": mermaid.write}
    try:
        text = writers[format_](VIEWS[view](model, verdict, start))
    except TooLargeError as error:
        fail(f"{model.name} has {error}; try --view rules")
    if out is None:
        click.echo(text, nl=False)
    else:
        from sketchlang.files import write_text

        write_text(out, text)


def _start(loaded: Loaded, scene: str) -> int:
    """The valuation of a scene's initial state, a bit a feature."""
    from runtime.solve import open_task
    from sketchlang.compile import EvaluationError
    from sketchlang.domain import SceneError
    from sketchlang.errors import InputError

    try:
        task = open_task(loaded.checked, scene)
        values = task.sketch.evaluate(task.problem.initial)
    except (InputError, SceneError) as error:
        fail(error)
    except EvaluationError as error:
        fail(f"the sketch cannot be evaluated: {error}")
    return sum(1 << f for f, value in enumerate(values) if value)
