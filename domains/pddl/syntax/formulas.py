"""Formulas and effects of PDDL, read in a scope of names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from domains.pddl.syntax.lists import Item, List, Reader, Word
from domains.pddl.syntax.model import (
    OBJECT,
    TRUE,
    And,
    Atom,
    Effect,
    Equal,
    Formula,
    Not,
    Or,
    Parameter,
    Quantified,
)
from sketchlang.suggest import did_you_mean

MAX_NUMBER = 10**9


def typed_list(reader: Reader, items: tuple[Item, ...], what: str) -> list[Parameter]:
    """`a b - type c - (either t u) d`: names with their types; `object` where none is given."""
    found: list[Parameter] = []
    waiting: list[Word] = []
    number = 0
    while number < len(items):
        item = items[number]
        if isinstance(item, List):
            raise reader.error(f"expected the name of {what}, found a list", item)
        if item.text != "-":
            waiting.append(item)
            number += 1
            continue
        if number + 1 == len(items):
            raise reader.error("expected a type after `-`", item)
        types = _types(reader, items[number + 1])
        found += [Parameter(word.text, types, word.span) for word in waiting]
        waiting = []
        number += 2
    return found + [Parameter(word.text, (OBJECT,), word.span) for word in waiting]


def _types(reader: Reader, item: Item) -> tuple[str, ...]:
    if isinstance(item, Word):
        return (item.text,)
    words = [part for part in item.items[1:] if isinstance(part, Word)]
    if item.head() != "either" or len(words) != len(item.items) - 1 or not words:
        raise reader.error("expected a type or `(either TYPE ...)`", item)
    return tuple(word.text for word in words)


@dataclass(frozen=True)
class Scope:
    """The names that formulas can use. `objects` are constants and, in a task, its objects."""

    reader: Reader
    types: Mapping[str, tuple[str, ...]]
    predicates: Mapping[str, tuple[Parameter, ...]]
    functions: Mapping[str, tuple[Parameter, ...]]
    objects: frozenset[str]
    variables: frozenset[str] = frozenset()

    def parameters(self, item: Item | None, after: Item | List) -> tuple[Parameter, ...]:
        """A list of typed variables."""
        if not isinstance(item, List):
            raise self.reader.error("expected a list of parameters", item or after)
        found = typed_list(self.reader, item.items, "a variable")
        seen: set[str] = set()
        for parameter in found:
            if not parameter.name.startswith("?"):
                raise self.reader.error(
                    f"`{parameter.name}` is no variable",
                    parameter.span,
                    f"Write `?{parameter.name}`.",
                )
            if parameter.name in seen:
                message = f"parameter `{parameter.name}` is listed twice"
                raise self.reader.error(message, parameter.span)
            seen.add(parameter.name)
            self.known_types(parameter)
        return tuple(found)

    def known_types(self, parameter: Parameter) -> None:
        """Raises `PddlError` if a type is not declared."""
        for type_ in parameter.types:
            if type_ != OBJECT and type_ not in self.types:
                raise self.reader.error(
                    f"there is no type `{type_}`",
                    parameter.span,
                    did_you_mean(type_, {*self.types, OBJECT}),
                )

    def within(self, parameters: tuple[Parameter, ...]) -> Scope:
        """The scope with more variables."""
        names = self.variables | {parameter.name for parameter in parameters}
        return Scope(self.reader, self.types, self.predicates, self.functions, self.objects, names)

    # Terms and atoms.

    def term(self, item: Item) -> str:
        """A variable or object that is known here."""
        if isinstance(item, List):
            raise self.reader.error("expected a variable or an object, found a list", item)
        text = item.text
        known = self.variables if item.is_variable else self.objects
        if text not in known:
            kind = "variable" if item.is_variable else "object"
            raise self.reader.error(f"there is no {kind} `{text}`", item, did_you_mean(text, known))
        return text

    def atom(self, item: List, functions: bool = False) -> Atom:
        """A predicate, or a function, with as many terms as it takes."""
        declared = self.functions if functions else self.predicates
        kind = "function" if functions else "predicate"
        name = item.head()
        if not name:
            raise self.reader.error(f"expected a {kind}", item)
        if name not in declared:
            message = f"there is no {kind} `{name}`"
            raise self.reader.error(message, item.items[0], did_you_mean(name, declared))
        wanted, given = len(declared[name]), len(item.items) - 1
        if wanted != given:
            raise self.reader.error(f"`{name}` takes {_count(wanted)}, {given} given", item)
        return Atom(name, tuple(self.term(part) for part in item.items[1:]), item.span)

    # Formulas.

    def formula(self, item: Item) -> Formula:
        """A condition."""
        if isinstance(item, Word):
            raise self.reader.error(f"expected a condition, found `{item.text}`", item)
        if not item.items:
            return TRUE
        head, rest = item.head(), item.items[1:]
        match head:
            case "and":
                return And(tuple(map(self.formula, rest)))
            case "or":
                return Or(tuple(map(self.formula, rest)))
            case "not":
                return Not(self.formula(*self._exactly(item, 1)))
            case "imply":
                first, second = self._exactly(item, 2)
                return Or((Not(self.formula(first)), self.formula(second)))
            case "forall" | "exists":
                first, second = self._exactly(item, 2)
                parameters = self.parameters(first, item)
                inner = self.within(parameters).formula(second)
                return Quantified(head == "forall", parameters, inner)
            case "=":
                first, second = self._exactly(item, 2)
                return Equal(self.term(first), self.term(second))
            case "<" | ">" | "<=" | ">=":
                message = "numbers cannot be compared here: numeric fluents are not supported"
                raise self.reader.error(message, item)
            case "preference" | "always" | "sometime" | "within" | "at-most-once":
                raise self.reader.error(f"`{head}` is not supported", item)
        return self.atom(item)

    def _exactly(self, item: List, number: int) -> tuple[Item, ...]:
        if len(item.items) - 1 != number:
            given = len(item.items) - 1
            raise self.reader.error(f"`{item.head()}` takes {_count(number)}, {given} given", item)
        return item.items[1:]

    # Effects.

    def effects(self, item: Item) -> tuple[list[Effect], list[int | Atom]]:
        """The literals of an effect and what it adds to the total cost."""
        if isinstance(item, Word):
            raise self.reader.error(f"expected an effect, found `{item.text}`", item)
        found: list[Effect] = []
        costs: list[int | Atom] = []
        self._effect(item, (), TRUE, found, costs)
        return found, costs

    def _effect(
        self,
        item: Item,
        parameters: tuple[Parameter, ...],
        condition: Formula,
        found: list[Effect],
        costs: list[int | Atom],
    ) -> None:
        if isinstance(item, Word):
            raise self.reader.error(f"expected an effect, found `{item.text}`", item)
        if not item.items:
            return
        match item.head():
            case "and":
                for part in item.items[1:]:
                    self._effect(part, parameters, condition, found, costs)
            case "forall":
                first, second = self._exactly(item, 2)
                more = self.parameters(first, item)
                self.within(more)._effect(second, parameters + more, condition, found, costs)
            case "when":
                first, second = self._exactly(item, 2)
                both = _both(condition, self.formula(first))
                self._effect(second, parameters, both, found, costs)
            case "not":
                (part,) = self._exactly(item, 1)
                if not isinstance(part, List):
                    raise self.reader.error("expected a predicate", part)
                found.append(Effect(False, self.atom(part), parameters, condition))
            case "increase":
                costs.append(self._cost(item, bool(parameters) or condition != TRUE))
            case "decrease" | "assign" | "scale-up" | "scale-down":
                message = f"`{item.head()}` is not supported: only the total cost may change"
                raise self.reader.error(message, item)
            case _:
                found.append(Effect(True, self.atom(item), parameters, condition))

    def _cost(self, item: List, conditional: bool) -> int | Atom:
        first, second = self._exactly(item, 2)
        target = first.head() if isinstance(first, List) else first.text
        if target != "total-cost":
            raise self.reader.error(
                f"`{target}` cannot change: of numeric fluents only the total cost is supported",
                first,
            )
        if conditional:
            raise self.reader.error("costs under a condition are not supported", item)
        if isinstance(second, List):
            return self.atom(second, functions=True)
        return number(self.reader, second)


def number(reader: Reader, item: Item) -> int:
    """A whole number."""
    text = item.text if isinstance(item, Word) else ""
    digits = text.removesuffix(".0")
    if not (digits.isascii() and digits.isdigit()):
        raise reader.error("expected a whole number that is not negative", item)
    if len(digits) > 10 or int(digits) > MAX_NUMBER:
        raise reader.error(f"numbers end at {MAX_NUMBER}", item)
    return int(digits)


def _both(first: Formula, second: Formula) -> Formula:
    return second if first == TRUE else And((first, second))


def _count(number: int) -> str:
    return "1 argument" if number == 1 else f"{number or 'no'} arguments"
