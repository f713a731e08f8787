"""What the grammar allows and the language does not."""

from __future__ import annotations

from sketchlang.source import Span


class RejectedError(Exception):
    """The item follows the grammar and is wrong all the same."""

    def __init__(self, code: str, message: str, span: Span, hint: str | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.span = span
        self.hint = hint
