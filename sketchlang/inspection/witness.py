"""Witnesses: what makes an expression have the value that it has.

A witness is a tree like the expression's own, cut down to what decided: the element for which a
`some` holds, those that a `count` counts, the parts of a `sum`, the element with the least value,
the operand at which an `and` fails. `explain` makes them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Element:
    """An element of the set that a quantifier runs over: what it is called, the value of the
    quantifier's body for it, and why that is so."""

    name: str
    value: bool | int
    because: Witness


@dataclass(frozen=True)
class Witness:
    """Why an expression has its value.

    `kind` is that of the expression's node (`sketchlang.checking.typed.Node`), `text` the
    expression with the arguments that it has here. `value` is a truth value, a number, an
    element's name, or the names of a set's elements. `parts` are the operands that decided.

    Of a quantifier, `elements` are those that decided: the first for which a `some` holds or an
    `all` fails, all that a `count` counts or that add to a `sum`; of a `min` or `max` the first
    with its value, then the others that were looked at. `members` is how many elements its set
    has, `considered` how many of these pass its `where` (of those that were looked at), `over` the
    set as it is written, `where` the condition, and `default` whether the value is the one for no
    elements at all.
    """

    kind: str
    text: str
    value: Any
    parts: tuple[Witness, ...] = ()
    elements: tuple[Element, ...] = ()
    members: int = 0
    considered: int = 0
    over: str = ""
    where: str | None = None
    default: bool = False

    def walk(self) -> Iterator[Witness]:
        """This witness and all those below it."""
        yield self
        for part in self.parts:
            yield from part.walk()
        for element in self.elements:
            yield from element.because.walk()


@dataclass(frozen=True)
class FeatureWitness:
    """The value of a feature in a state, and why it has it; `definition` is how it is written."""

    name: str
    kind: str
    value: int
    definition: str
    because: Witness
