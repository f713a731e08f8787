"""A domain function, or an invariant, that broke its promise."""

from __future__ import annotations

MAX_TEXT = 300


class EvaluationError(Exception):
    """Feature values cannot be trusted, so whoever asked for them has to stop.

    `feature` is the feature being computed (None while invariants are checked), `expression`
    the part of its definition that failed, `function` the domain function called there (None
    if it was none), `position` its file and line, `state` the state, and `reason` what went wrong.
    """

    def __init__(
        self,
        reason: str,
        *,
        expression: str,
        state: object,
        feature: str | None = None,
        function: str | None = None,
        position: str | None = None,
    ) -> None:
        self.reason = reason
        self.expression = expression
        self.state = state
        self.feature = feature
        self.function = function
        self.position = position
        super().__init__(str(self))

    def __str__(self) -> str:
        where = f"feature {self.feature}: " if self.feature else ""
        at = f" ({self.position})" if self.position else ""
        function = f"\n  function: {self.function}{at}" if self.function else ""
        return (
            f"{where}{self.reason}\n  expression: {self.expression}{function}"
            f"\n  state: {shown(self.state)}"
        )


class BrokenPromiseError(Exception):
    """The same while it is not known which feature is being computed."""

    def __init__(
        self,
        reason: str,
        expression: str,
        function: str | None = None,
        position: str | None = None,
    ) -> None:
        super().__init__(reason)
        self.position = position
        self.reason = reason
        self.expression = expression
        self.function = function


def shown(value: object) -> str:
    """A value in a message: its `repr`, shortened, even where `repr` itself fails."""
    try:
        text = repr(value)
    except Exception as error:
        text = f"<{type(value).__name__} whose repr() raises {type(error).__name__}>"
    text = " ".join(text.split())
    return text if len(text) <= MAX_TEXT else text[: MAX_TEXT - 1] + "…"
