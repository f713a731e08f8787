"""One line for each finding: `file:line:column: severity[code] message`."""

from __future__ import annotations

from collections.abc import Sequence

from sketchlang.diagnostics import Diagnostic
from sketchlang.escape import shown_line


def line(diagnostic: Diagnostic) -> str:
    """One finding."""
    source, span = diagnostic.primary.source, diagnostic.primary.span
    row, column = source.position(span.start)
    severity = diagnostic.severity.value
    hint = f" ({diagnostic.hint})" if diagnostic.hint else ""
    text = f"{source.name}:{row}:{column}: {severity}[{diagnostic.code}] {diagnostic.message}{hint}"
    return shown_line(" ".join(text.splitlines()))


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """All findings."""
    return "".join(line(found) + "\n" for found in diagnostics)
