"""Types of expressions: Booleans, naturals, the domain's sorts and sets of these."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Type:
    """`name` is `bool`, `nat` or a sort's; `is_set` makes it a set of that."""

    name: str
    is_set: bool = False

    def __str__(self) -> str:
        return f"set of {self.name}" if self.is_set else self.name

    @property
    def element(self) -> Type:
        """The type of a set's elements."""
        return Type(self.name)


BOOL = Type("bool")
NAT = Type("nat")
UNKNOWN = Type("?")
"""The type of an expression with a mistake in it: fits everywhere, so that one mistake is
reported once."""
