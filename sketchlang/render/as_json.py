"""Findings as JSON, for editors and scripts.

One object: `diagnostics`, a list in the order in which they are printed, and `errors` and
`warnings`, their numbers. Lines and columns count from 1, offsets (in characters) from 0;
ends are exclusive.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sketchlang.diagnostics import Diagnostic, Label, Severity
from sketchlang.escape import dumps


def place(label: Label) -> dict[str, Any]:
    """A label as plain data."""
    source, span = label.source, label.span
    row, column = source.position(span.start)
    end_row, end_column = source.position(span.end)
    return {
        "file": source.name,
        "line": row,
        "column": column,
        "end_line": end_row,
        "end_column": end_column,
        "start": span.start,
        "end": span.end,
        "text": label.text,
    }


def finding(diagnostic: Diagnostic) -> dict[str, Any]:
    """A diagnostic as plain data."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "hint": diagnostic.hint,
        "primary": place(diagnostic.primary),
        "secondary": [place(label) for label in diagnostic.secondary],
    }


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """All findings."""
    errors = sum(found.severity is Severity.ERROR for found in diagnostics)
    value = {
        "diagnostics": [finding(found) for found in diagnostics],
        "errors": errors,
        "warnings": len(diagnostics) - errors,
    }
    return dumps(value, indent=2) + "\n"
