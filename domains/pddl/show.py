"""PDDL domains and tasks as people read them: in lines, as PDDL writes things."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from domains.pddl.syntax.model import (
    Action,
    And,
    Atom,
    Equal,
    Formula,
    Not,
    Or,
    Parameter,
    PddlDomain,
    PddlTask,
    Quantified,
)
from domains.pddl.syntax.read import load, read_task

if TYPE_CHECKING:
    from runtime.reporting import TextPicture

_DEFINED = re.compile(r"\(\s*(domain|problem)\b")


def by_predicate(atoms: Iterable[str]) -> Iterator[tuple[str, list[str]]]:
    """Atoms (`(on a b)`) grouped by their predicate, in the order in which those come first."""
    groups: dict[str, list[str]] = {}
    for atom in atoms:
        groups.setdefault(atom.strip("()").partition(" ")[0], []).append(atom)
    yield from groups.items()


def formula_text(formula: Formula) -> str:
    """A formula as PDDL writes it."""
    match formula:
        case Atom():
            return str(formula)
        case Equal(left, right):
            return f"(= {left} {right})"
        case Not(part):
            return f"(not {formula_text(part)})"
        case And(parts) | Or(parts):
            word = "and" if isinstance(formula, And) else "or"
            return f"({' '.join((word, *map(formula_text, parts)))})"
        case Quantified(every, parameters, part):
            word = "forall" if every else "exists"
            return f"({word} ({parameters_text(parameters)}) {formula_text(part)})"


def parameters_text(parameters: Iterable[Parameter]) -> str:
    """`?x - ball ?y - (either room hall)`; a type is left out where it is `object`."""
    found = []
    for parameter in parameters:
        types = parameter.types
        kind = types[0] if len(types) == 1 else f"(either {' '.join(types)})"
        found.append(parameter.name if kind == "object" else f"{parameter.name} - {kind}")
    return " ".join(found)


def action_lines(domain: PddlDomain) -> dict[str, str]:
    """Each action with its parameters, and what it makes true and false."""
    return {
        f"{action.name}({parameters_text(action.parameters)})": _changes(action)
        for action in domain.actions
    }


def _changes(action: Action) -> str:
    groups = []
    for positive, word in ((True, "makes true"), (False, "makes false")):
        atoms = [str(effect.atom) for effect in action.effects if effect.positive is positive]
        if atoms:
            groups.append(f"{word} {' '.join(dict.fromkeys(atoms))}")
    return "; ".join(groups)


def task_lines(task: PddlTask) -> Iterator[str]:
    """Objects by their type, what is true at the start by predicate, and the goal."""
    yield f"task {task.name} of domain {task.domain.name}"
    types: dict[str, list[str]] = {}
    for thing in task.objects:
        types.setdefault(" or ".join(thing.types), []).append(thing.name)
    yield "objects"
    for type_, names in types.items():
        yield f"  {type_} ({len(names)}): {' '.join(names)}"
    yield "true at the start"
    facts = [f"({' '.join(fact)})" for fact in sorted(task.init)]
    for name, atoms in by_predicate(facts):
        yield f"  {name} ({len(atoms)}): {' '.join(atoms)}"
    yield "goal"
    parts = task.goal.parts if isinstance(task.goal, And) else (task.goal,)
    for part in parts:
        yield f"  {formula_text(part)}"


def task_picture(path: str, domain: PddlDomain) -> TextPicture:
    """A task file in lines.

    Raises:
        PddlError: what is wrong with it, and where.
    """
    from runtime.reporting import TextPicture  # here, for `check` reads domains as well

    return TextPicture(tuple(task_lines(read_task(load(path), domain))))


def is_domain(path: str | Path) -> bool:
    """Whether a PDDL file declares a domain, not a task.

    Raises:
        InputError: it cannot be read.
    """
    code = "\n".join(line.partition(";")[0] for line in load(path).text.splitlines())
    found = _DEFINED.search(code.lower())
    return found is not None and found[1] == "domain"
