"""`sketchlang terminate`: a proof that a sketch terminates, or a run that never ends."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click

from sketchlang import __version__
from sketchlang.cli import names
from sketchlang.cli.common import (
    DEEP,
    Number,
    check_outputs,
    domain_option,
    interruptible,
    load_valid,
    say,
)
from sketchlang.escape import dumps, shown_lines
from sketchlang.findings import Places


@click.command("terminate")
@click.argument("file", metavar="FILE", shell_complete=names.sketches)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option(
    "--certificate",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="OUT.json",
    help="Write the proof to a file.",
)
@click.option("--time-limit", type=Number(min=0), metavar="S", help="Give up after S seconds.")
@click.option(
    "--memory-limit",
    type=Number(min=0),
    metavar="MB",
    help="Give up when the whole process is larger than this.",
)
@domain_option
@interruptible
def command(
    *,
    file: str,
    as_json: bool,
    certificate: Path | None,
    time_limit: float | None,
    memory_limit: float | None,
    domain_file: str | None,
) -> None:
    """Prove that a sketch terminates, or show how it does not.

    FILE is a path, the name of a built-in sketch, or - for standard input. No run that
    follows a terminating sketch goes on for ever. Goals end a run, invariants are taken for
    granted, and a nat that is declared bounded never exceeds some number.

    Exit 0 if the sketch terminates, 1 if it does not or a limit was reached before that was
    known, 2 if the file cannot be read or has errors.

    \b
    Examples:
      sketchlang terminate pick_and_place
      sketchlang terminate my.sketch --certificate my.proof.json
      sketchlang terminate my.sketch --json --time-limit 10
    """
    loaded = load_valid(file, domain_file)
    check_outputs([], {"--certificate": certificate})
    from sketchlang.analysis import report
    from sketchlang.analysis.limits import Budget
    from sketchlang.analysis.termination import Terminating, decide_termination

    model = loaded.checked.model
    sys.setrecursionlimit(DEEP)
    started = time.perf_counter()
    budget = Budget(time_limit, memory_limit)
    verdict = decide_termination(model, budget)
    seconds = time.perf_counter() - started
    places = Places(loaded)
    proved = isinstance(verdict, Terminating)
    if certificate is not None and isinstance(verdict, Terminating):
        from sketchlang.analysis.certificate import as_text, certificate_of
        from sketchlang.files import write_text

        write_text(certificate, as_text(certificate_of(model, verdict)))
    if as_json:
        found = report.as_json(model, verdict, places.position, budget)
        found |= {"time_s": round(seconds, 6), "version": __version__}
        click.echo(dumps(found, indent=2))
    else:
        click.echo(shown_lines(report.as_text(model, verdict, places.shown, budget)))
        if certificate is not None:
            say("")
            say(f"Certificate written to {certificate}." if proved else "No certificate written.")
    sys.exit(0 if proved else 1)
