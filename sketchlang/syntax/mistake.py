"""One syntax error."""

from __future__ import annotations

from typing import NamedTuple

from sketchlang.diagnostics import Fix
from sketchlang.source import Span


class Mistake(NamedTuple):
    """Code, message, place and hint of a syntax error, and what would put it right."""

    code: str
    message: str
    span: Span
    hint: str | None
    fix: Fix | None = None
