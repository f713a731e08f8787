"""`sketchlang terminate`: a proof that a sketch terminates, or a run that never ends."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sketchlang.cli import names
from sketchlang.cli.common import (
    DEEP,
    FILE,
    Number,
    check_outputs,
    domain_option,
    fail,
    interruptible,
    load_valid,
    say,
)
from sketchlang.escape import dumps, shown_lines
from sketchlang.findings import Places
from sketchlang.model import SketchModel
from sketchlang.suggest import did_you_mean
from sketchlang.version import __version__

if TYPE_CHECKING:
    from sketchlang.analysis.limits import Budget


@click.command("terminate")
@click.argument("file", metavar="FILE", shell_complete=names.sketches)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option(
    "--certificate",
    type=FILE,
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
@click.option(
    "--assume",
    is_flag=True,
    help="Say what would have to hold of the features for it to terminate.",
)
@click.option(
    "--fair",
    multiple=True,
    metavar="RULE",
    help="A rule whose outcomes are all taken, or `all`; may be given more than once.",
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
    assume: bool,
    fair: tuple[str, ...],
    domain_file: str | None,
) -> None:
    """Prove that a sketch terminates, or show how it does not.

    FILE is a path, the name of a built-in sketch, or - for standard input. No run that
    follows a terminating sketch goes on for ever. Goals end a run, invariants are taken for
    granted, and a nat that is declared bounded never exceeds some number.

    --fair makes a rule fair: a run that uses it again and again in a valuation sees all that it
    may lead to from there again and again. The verdict says if that was needed.

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
    from sketchlang.analysis.termination import (
        NonTerminating,
        Terminating,
        decide_termination,
    )

    model = loaded.checked.model
    fair_rules = _fair_rules(model, fair)
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
    if fair_rules and isinstance(verdict, NonTerminating):
        _end_if_fair(model, fair_rules, budget, as_json, certificate)
    needed = None
    if assume and isinstance(verdict, NonTerminating):
        from sketchlang.analysis import conditional

        needed = conditional.sufficient_assumptions(model, budget)
    if as_json:
        found = report.as_json(model, verdict, places.position, budget)
        if needed is not None:
            found["assumptions"] = conditional.assumptions_json(model, needed)
        found |= {"time_s": round(seconds, 6), "version": __version__}
        click.echo(dumps(found, indent=2))
    else:
        click.echo(shown_lines(report.as_text(model, verdict, places.shown, budget)))
        if needed is not None:
            say(*conditional.assumptions_text(model, needed))
        if certificate is not None:
            say("")
            say(f"Certificate written to {certificate}." if proved else "No certificate written.")
    sys.exit(0 if proved else 1)


def _fair_rules(model: SketchModel, names: tuple[str, ...]) -> set[int]:
    """The rules that --fair names."""
    numbers = {rule.name: r for r, rule in enumerate(model.rules)}
    if "all" in names and "all" not in numbers:
        return set(numbers.values())
    for name in names:
        if name not in numbers:
            fail(f"--fair: the sketch has no rule {name}", did_you_mean(name, numbers))
    return {numbers[name] for name in names}


def _end_if_fair(
    model: SketchModel,
    fair: set[int],
    budget: Budget,
    as_json: bool,
    certificate: Path | None,
) -> None:
    """Ends the command with a verdict under fairness, if the sketch terminates under it."""
    from sketchlang.analysis import conditional
    from sketchlang.analysis.fairness import TooManyFeaturesError, terminates_fairly
    from sketchlang.analysis.limits import LimitReachedError
    from sketchlang.analysis.report import wrapped

    started = time.perf_counter()
    try:
        if not terminates_fairly(model, fair, budget):
            return
    except TooManyFeaturesError as error:
        fail(f"--fair: {model.name} has {error}")
    except LimitReachedError:
        return
    if as_json:
        seconds = round(time.perf_counter() - started, 6)
        found = conditional.fair_json(model, fair)
        click.echo(dumps(found | {"time_s": seconds, "version": __version__}, indent=2))
    else:
        for line in conditional.fair_text(model, fair):
            say(*wrapped(line))
        if certificate is not None:
            say("", "No certificate written: there is none of a proof under fairness.")
    sys.exit(0)
