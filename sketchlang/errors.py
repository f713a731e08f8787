"""The one exception for what a user got wrong outside a sketch: files, options, scenes."""

from __future__ import annotations

from collections.abc import Sequence

from sketchlang.escape import shown_line, visible


class InputError(Exception):
    """Bad input. `place` says where (a file, a key), `hint` what to do about it.

    As a text it is one line, and one more for the hint, whatever characters the parts hold.
    """

    def __init__(self, message: str, *, place: str | None = None, hint: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.place = place
        self.hint = hint

    def __str__(self) -> str:
        text = f"{self.place}: {self.message}" if self.place else self.message
        return (
            f"{shown_line(text)}\n  hint: {visible(self.hint)}" if self.hint else shown_line(text)
        )


class CollectedInputError(InputError):
    """Several of them, found in one run. Message, place and hint are those of the first."""

    def __init__(self, errors: Sequence[InputError]) -> None:
        first = errors[0]
        super().__init__(first.message, place=first.place, hint=first.hint)
        self.errors = tuple(errors)

    def __str__(self) -> str:
        return "\n".join(str(error) for error in self.errors)
