"""What is said to the user about a source text.

Mistakes in a sketch are values, not exceptions: every stage returns the diagnostics it
found beside its result, and only `sketchlang.render` turns them into text.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sketchlang.source import Source, Span


class Severity(Enum):
    """`ERROR` keeps a sketch from being used, `WARNING` does not."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Label:
    """A place in a source and, if it needs words, what is to be seen there."""

    source: Source
    span: Span
    text: str = ""


@dataclass(frozen=True, slots=True)
class Fix:
    """What the hint says as an edit: `text` in the place of `span`, in the primary's source."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding: stable code (kebab-case), one terse sentence, where, and what to do.

    `primary` is the place to fix; `secondary` are the other places that matter (the first
    of two definitions, the condition that an effect contradicts). `hint` is a complete
    sentence, often "did you mean ...?". `fix` is there if the hint comes down to one edit.
    """

    code: str
    message: str
    primary: Label
    secondary: tuple[Label, ...] = ()
    hint: str | None = None
    severity: Severity = Severity.ERROR
    fix: Fix | None = None
