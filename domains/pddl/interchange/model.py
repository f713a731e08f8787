"""What the other notations have in common: elements of description logic, and rules."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sketchlang.errors import InputError


@dataclass(frozen=True)
class Element:
    """A constructor with its arguments: elements, names and numbers. Constructors are named as in
    dlplan: `c_and`, `r_primitive`, `n_count`."""

    name: str
    arguments: tuple[Element | str, ...]


@dataclass(frozen=True)
class Rule:
    """Conditions and effects: pairs of a feature's name and what is said of it, as a word:
    `pos neg gt eq` and `pos neg bot inc dec`."""

    conditions: tuple[tuple[str, str], ...]
    effects: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Policy:
    """Features by name, and rules. What a rule's effects do not name may change in any way."""

    booleans: Mapping[str, Element]
    numericals: Mapping[str, Element]
    rules: tuple[Rule, ...]


class NotTranslatedError(InputError):
    """A part that the language has no words for; the text names it."""
