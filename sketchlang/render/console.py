"""Diagnostics on a terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from sketchlang.diagnostics import Diagnostic, Severity
from sketchlang.escape import shown_line
from sketchlang.render import full


def wants_colour(stream: object) -> bool:
    """Colours are for terminals whose user did not ask for none (no-color.org)."""
    isatty = getattr(stream, "isatty", None)
    refused = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return bool(isatty and isatty() and not refused)


def write(text: str) -> None:
    """Print to standard output, also where its encoding does not have all the characters."""
    try:
        sys.stdout.write(text)
    except UnicodeEncodeError:
        encoding = sys.stdout.encoding or "ascii"
        sys.stdout.write(text.encode(encoding, errors="backslashreplace").decode(encoding))
    # Here, and not when Python ends: what goes wrong can still be told.
    sys.stdout.flush()


def summary(diagnostics: Sequence[Diagnostic], files: Sequence[str]) -> str:
    """One line for a list of findings."""
    errors = sum(found.severity is Severity.ERROR for found in diagnostics)
    warnings = len(diagnostics) - errors
    if not diagnostics:
        return (
            shown_line(f"{', '.join(files)}: ok") if len(files) <= 3 else f"{len(files)} files: ok"
        )
    parts = [
        f"{number} {word}{'s' if number > 1 else ''}"
        for number, word in ((errors, "error"), (warnings, "warning"))
        if number
    ]
    return " and ".join(parts)


def render(diagnostics: Sequence[Diagnostic], files: Sequence[str], colour: bool) -> str:
    """Findings and a summary, as `check` prints them."""
    parts = [full.render(found, colour) + "\n\n" for found in diagnostics]
    return "".join(parts) + summary(diagnostics, files) + "\n"
