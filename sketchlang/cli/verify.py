"""`sketchlang verify`: an independent check of a termination certificate."""

from __future__ import annotations

import sys

import click

from sketchlang.cli import names
from sketchlang.cli.common import DEEP, domain_option, fail, interruptible, load_valid, say
from sketchlang.errors import InputError
from sketchlang.escape import dumps
from sketchlang.model import SketchModel
from sketchlang.reading import read_bytes


@click.command("verify")
@click.argument("certificate", metavar="CERTIFICATE")
@click.argument("file", metavar="FILE", shell_complete=names.sketches)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@domain_option
@interruptible
def command(*, certificate: str, file: str, as_json: bool, domain_file: str | None) -> None:
    """Check that a certificate proves that a sketch terminates.

    CERTIFICATE is what `sketchlang terminate --certificate` wrote, FILE the sketch. The
    checker shares no code with the prover.

    Exit 0 if the certificate is valid for this very sketch, 1 if it is not, 2 if one of the
    files cannot be read or the sketch has errors.

    \b
    Example:
      sketchlang terminate my.sketch --certificate my.proof.json
      sketchlang verify my.proof.json my.sketch
    """
    try:
        data = read_bytes(certificate)
    except InputError as error:
        fail(error)
    model = load_valid(file, domain_file).checked.model
    sys.setrecursionlimit(DEEP)
    reason = _reason(data, model)
    if as_json:
        found = {"valid": reason is None, "sketch": model.name, "reason": reason}
        click.echo(dumps(found, indent=2))
    elif reason is None:
        say(f"{certificate} is valid: {model.name} terminates.")
    else:
        say(f"{certificate} is refused: {reason}.")
    sys.exit(0 if reason is None else 1)


def _reason(data: bytes, model: SketchModel) -> str | None:
    """Why a certificate is refused, None if it is valid."""
    from sketchlang.analysis.verify import RefusedError, read_certificate, verify

    try:
        verify(read_certificate(data), model)
    except RefusedError as refused:
        return str(refused)
    except RecursionError:
        return "it is nested too deeply"
    return None
