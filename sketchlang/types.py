"""Types of expressions: Booleans, naturals, the domain's sorts, sets and relations of these."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Type:
    """`name` is `bool`, `nat` or a sort's; `is_set` makes it a set of that, and `to` a relation
    between it and another sort."""

    name: str
    is_set: bool = False
    to: str | None = None

    def __str__(self) -> str:
        if self.to is not None:
            return f"relation of {self.name} and {self.to}"
        return f"set of {self.name}" if self.is_set else self.name

    @property
    def is_relation(self) -> bool:
        """Whether it is a set of pairs."""
        return self.to is not None

    @property
    def is_element(self) -> bool:
        """Whether it is a sort."""
        return not (self.is_set or self.is_relation or self.name in ("bool", "nat", "?"))

    @property
    def element(self) -> Type:
        """The type of a set's elements."""
        return Type(self.name)

    @property
    def inverse(self) -> Type:
        """The type of the relation that goes the other way."""
        return Type(self.to or self.name, to=self.name)


BOOL = Type("bool")
NAT = Type("nat")
UNKNOWN = Type("?")
"""The type of an expression with a mistake in it: fits everywhere, so that one mistake is
reported once."""
