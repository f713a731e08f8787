"""Workflow commands that GitHub shows beside the changed lines of a pull request."""

from __future__ import annotations

from collections.abc import Sequence

from sketchlang.diagnostics import Diagnostic
from sketchlang.escape import visible


def _value(text: str, separators: str = "") -> str:
    """A text as the commands need it; properties must not contain `,` or `:`."""
    text = visible(text, keep="\r\n")
    for sign in f"%\r\n{separators}":
        text = text.replace(sign, f"%{ord(sign):02X}")
    return text


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """All findings, one command for each."""
    lines = []
    for found in diagnostics:
        source, span = found.primary.source, found.primary.span
        row, column = source.position(span.start)
        end_row, end_column = source.position(span.end)
        properties = {
            "file": source.name,
            "line": str(row),
            "col": str(column),
            "title": found.code,
        }
        # Columns are shown for places on one line only.
        if end_row == row:
            properties["endLine"] = str(end_row)
            properties["endColumn"] = str(end_column)
        listed = ",".join(f"{name}={_value(text, ',:')}" for name, text in properties.items())
        message = found.message if found.hint is None else f"{found.message}\n{found.hint}"
        lines.append(f"::{found.severity.value} {listed}::{_value(message)}\n")
    return "".join(lines)
