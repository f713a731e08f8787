"""What is wrong with a robot file: each mistake is a value with a name of its own."""

from __future__ import annotations

from dataclasses import dataclass

from sketchlang.errors import InputError


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a robot: `code` names the kind, `place` the file and table,
    `hint` says what to do about it."""

    code: str
    message: str
    place: str
    hint: str | None = None

    def error(self) -> InputError:
        """The finding as an error, for those who cannot go on with it."""
        return InputError(self.message, place=self.place, hint=self.hint)
