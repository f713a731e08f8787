"""Formulas to lists of conjunctions, over the objects of one task.

Universal quantifiers are written out; existential ones become further parameters.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from domains.pddl.syntax.model import (
    And,
    Atom,
    Equal,
    Formula,
    Not,
    Or,
    Parameter,
    PddlTask,
    Quantified,
    substitute,
)

MAX_CONJUNCTIONS = 1000
"""So many cases may a condition be split into ..."""

MAX_INSTANCES = 50_000
"""... and so many instances may its quantifiers have."""


class TooLargeError(Exception):
    """A condition that is too large when it is written out; the text says how."""


@dataclass(frozen=True, slots=True)
class Conjunction:
    """Atoms that have to be true and false, and pairs of terms with whether they are equal.
    `parameters` are existentially quantified."""

    parameters: tuple[Parameter, ...] = ()
    true: tuple[Atom, ...] = ()
    false: tuple[Atom, ...] = ()
    equal: tuple[tuple[str, str, bool], ...] = ()

    def joined(self, other: Conjunction) -> Conjunction:
        """Both together."""
        return Conjunction(
            self.parameters + other.parameters,
            self.true + other.true,
            self.false + other.false,
            self.equal + other.equal,
        )


def conjunctions(
    formula: Formula, task: PddlTask, numbers: Iterator[int] | None = None
) -> list[Conjunction]:
    """The cases of a condition: it holds if one of them does.

    `numbers` are for the names of further parameters. Without it there are none: existential
    quantifiers are written out as well.

    Raises:
        TooLargeError: there are too many cases.
    """
    return _Splitter(task, numbers).cases(formula, True)


@dataclass
class _Splitter:
    task: PddlTask
    numbers: Iterator[int] | None
    instances: int = 0

    def cases(self, formula: Formula, wanted: bool) -> list[Conjunction]:
        """The cases in which a formula has a truth value."""
        match formula:
            case Atom():
                return [Conjunction(true=(formula,)) if wanted else Conjunction(false=(formula,))]
            case Equal(left, right):
                return [Conjunction(equal=((left, right, wanted),))]
            case Not(part):
                return self.cases(part, not wanted)
            case And(parts) | Or(parts):
                found = [self.cases(part, wanted) for part in parts]
                return _all(found) if isinstance(formula, And) == wanted else _any(found)
            case Quantified(every, parameters, part):
                if every == wanted:
                    return _all([self.cases(one, wanted) for one in self._written_out(formula)])
                numbers = self.numbers
                if numbers is None:
                    return _any([self.cases(one, wanted) for one in self._written_out(formula)])
                names = {parameter.name: f"?~{next(numbers)}" for parameter in parameters}
                further = tuple(
                    Parameter(names[parameter.name], parameter.types, parameter.span)
                    for parameter in parameters
                )
                inner = self.cases(substitute(part, names), wanted)
                return [Conjunction(further).joined(case) for case in inner]

    def _written_out(self, formula: Quantified) -> Iterator[Formula]:
        members = [tuple(self.task.members(p.types)) for p in formula.parameters]
        names = [parameter.name for parameter in formula.parameters]
        for values in product(*members):
            self.instances += 1
            if self.instances > MAX_INSTANCES:
                message = f"its quantifiers have more than {MAX_INSTANCES} instances"
                raise TooLargeError(message)
            yield substitute(formula.part, dict(zip(names, values, strict=True)))


def _any(found: list[list[Conjunction]]) -> list[Conjunction]:
    cases = [case for part in found for case in part]
    if len(cases) > MAX_CONJUNCTIONS:
        raise TooLargeError(f"it splits into more than {MAX_CONJUNCTIONS} cases")
    return cases


def _all(found: list[list[Conjunction]]) -> list[Conjunction]:
    # Parts with one case, by far the most, are gathered before any product is made.
    single = [part[0] for part in found if len(part) == 1]
    cases = [
        Conjunction(
            tuple(p for case in single for p in case.parameters),
            tuple(a for case in single for a in case.true),
            tuple(a for case in single for a in case.false),
            tuple(e for case in single for e in case.equal),
        )
    ]
    for part in found:
        if len(part) == 1:
            continue
        if len(cases) * len(part) > MAX_CONJUNCTIONS:
            raise TooLargeError(f"it splits into more than {MAX_CONJUNCTIONS} cases")
        cases = [first.joined(second) for first in cases for second in part]
    return cases
