"""Domain and task files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from domains.pddl.syntax.formulas import Scope, number, typed_list
from domains.pddl.syntax.lists import MAX_BYTES, Item, List, PddlError, Reader, Word
from domains.pddl.syntax.model import (
    OBJECT,
    TRUE,
    Action,
    Formula,
    Parameter,
    PddlDomain,
    PddlTask,
)
from sketchlang.reading import read_bytes
from sketchlang.source import Source, Span
from sketchlang.suggest import did_you_mean

_UNSUPPORTED = {
    ":durative-action": "durative actions",
    ":derived": "derived predicates",
    ":axiom": "axioms",
    ":constraints": "constraints on plans",
    ":process": "processes",
    ":event": "events",
}


def load(path: str | Path) -> Source:
    """The text of a PDDL file. Raises `InputError` where it cannot be read."""
    # Old benchmark files have comments in other encodings.
    text = read_bytes(path, MAX_BYTES).decode("utf-8", errors="replace")
    return Source(str(path), text)


def read_domain(source: Source) -> PddlDomain:  # noqa: PLR0912 (a case for every section)
    """The domain of a text.

    Raises:
        PddlError: what is wrong with it, and where.
    """
    reader = Reader(source)
    name, sections = _define(reader, "domain")
    types: dict[str, tuple[str, ...]] = {}
    constants: list[Parameter] = []
    predicates: dict[str, tuple[Parameter, ...]] = {}
    functions: dict[str, tuple[Parameter, ...]] = {}
    places: dict[str, Span] = {}
    for section in sections:
        if section.head() == ":types":
            for found in typed_list(reader, section.items[1:], "a type"):
                parents = () if found.name == OBJECT else found.types
                types[found.name] = types.get(found.name, ()) + parents
                places.setdefault(f"type {found.name}", found.span)
    for parent in {parent for parents in types.values() for parent in parents}:
        types.setdefault(parent, ())
    scope = Scope(reader, types, predicates, functions, frozenset())
    for section in sections:
        match section.head():
            case ":constants":
                constants += _objects(scope, section)
            case ":predicates":
                for item in section.items[1:]:
                    _declare(scope, item, predicates, "predicate", places)
            case ":functions":
                # `- number` may follow: it says nothing.
                for item in section.items[1:]:
                    if isinstance(item, List):
                        _declare(scope, item, functions, "function", places)
            case ":requirements" | ":types" | ":action":
                pass
            case other:
                raise _section(reader, section, other, "domain")
    predicates.pop("=", None)
    names = frozenset(constant.name for constant in constants)
    scope = Scope(reader, types, predicates, functions, names)
    actions: dict[str, Action] = {}
    for section in sections:
        if section.head() == ":action":
            action = _action(scope, section)
            if action.name in actions:
                raise reader.error(f"action `{action.name}` is declared twice", section)
            actions[action.name] = action
    return PddlDomain(
        source,
        name,
        types,
        tuple(constants),
        predicates,
        functions,
        tuple(actions.values()),
        places,
    )


def read_task(source: Source, domain: PddlDomain) -> PddlTask:  # noqa: PLR0912 (the same)
    """The task of a text.

    Raises:
        PddlError: what is wrong with it, and where.
    """
    reader = Reader(source)
    name, sections = _define(reader, "problem")
    scope = Scope(reader, domain.types, domain.predicates, domain.functions, frozenset())
    objects = {thing.name: thing for thing in domain.constants}
    for section in sections:
        if section.head() == ":domain":
            _same_domain(reader, section, domain)
        elif section.head() == ":objects":
            for thing in _objects(scope, section):
                known = objects.get(thing.name)
                types = () if known is None else known.types
                objects[thing.name] = replace(thing, types=tuple({*types, *thing.types}))
    scope = replace(scope, objects=frozenset(objects))
    init: set[tuple[str, ...]] = set()
    values: dict[tuple[str, ...], int] = {}
    goal: Formula | None = None
    minimises = False
    for section in sections:
        match section.head():
            case ":init":
                for item in section.items[1:]:
                    _fact(scope, item, init, values)
            case ":goal":
                if len(section.items) != 2:
                    raise reader.error("expected one condition after `:goal`", section)
                goal = scope.formula(section.items[1])
            case ":metric":
                minimises = True
            case ":domain" | ":objects" | ":requirements" | ":length":
                pass
            case other:
                raise _section(reader, section, other, "problem")
    if goal is None:
        end = len(source.text.rstrip())
        raise reader.error("the task has no goal", Span(end, end), "Write `(:goal CONDITION)`.")
    return PddlTask(
        source, domain, name, tuple(objects.values()), frozenset(init), values, goal, minimises
    )


# Parts of both.


def _define(reader: Reader, kind: str) -> tuple[str, list[List]]:
    """`(define (KIND NAME) SECTION ...)`"""
    found = reader.lists()
    if not found:
        raise reader.error("the file is empty", Span(0, 0), f"It begins `(define ({kind} NAME)`.")
    define = found[0]
    if len(found) > 1:
        raise reader.error("only one `(define ...)` is expected in a file", found[1])
    items = define.items
    title = items[1] if len(items) > 1 else define
    if define.head() != "define" or not isinstance(title, List):
        raise reader.error(
            f"expected `(define ({kind} NAME) ...)`", define.items[0] if items else define
        )
    if title.head() != kind:
        other = f"This is the file of a {title.head()}." if title.head() else None
        raise reader.error(f"expected `({kind} NAME)`", title, other)
    if len(title.items) != 2 or not isinstance(title.items[1], Word):
        raise reader.error(f"expected the name of the {kind}", title)
    sections = []
    for item in items[2:]:
        if not isinstance(item, List) or not item.head():
            raise reader.error("expected a section in parentheses", item)
        sections.append(item)
    return title.items[1].text, sections


def _section(reader: Reader, section: List, name: str, kind: str) -> PddlError:
    if name in _UNSUPPORTED:
        return reader.error(f"{_UNSUPPORTED[name]} are not supported", section.items[0])
    known = {":requirements", ":types", ":constants", ":predicates", ":functions", ":action"}
    if kind == "problem":
        known = {":domain", ":objects", ":init", ":goal", ":metric", ":requirements"}
    hint = did_you_mean(name, known)
    return reader.error(f"a {kind} has no section `{name}`", section.items[0], hint)


def _objects(scope: Scope, section: List) -> list[Parameter]:
    found = typed_list(scope.reader, section.items[1:], "an object")
    for thing in found:
        if thing.name.startswith("?"):
            message = f"`{thing.name}` is a variable, expected an object"
            raise scope.reader.error(message, thing.span)
        scope.known_types(thing)
    return found


def _declare(
    scope: Scope,
    item: Item,
    declared: dict[str, tuple[Parameter, ...]],
    kind: str,
    places: dict[str, Span],
) -> None:
    """`(NAME PARAMETERS)` among predicates or functions."""
    if not isinstance(item, List) or not item.head():
        raise scope.reader.error(f"expected `(NAME PARAMETERS)` of a {kind}", item)
    name = item.head()
    if name in declared:
        raise scope.reader.error(f"{kind} `{name}` is declared twice", item)
    parameters = typed_list(scope.reader, item.items[1:], "a variable")
    for parameter in parameters:
        scope.known_types(parameter)
    declared[name] = tuple(parameters)
    places[name] = item.span


def _action(scope: Scope, section: List) -> Action:
    reader = scope.reader
    items = section.items
    if len(items) < 2 or not isinstance(items[1], Word):
        raise reader.error("expected the name of an action", section)
    parts: dict[str, Item] = {}
    keys = (":parameters", ":precondition", ":effect")
    for place in range(2, len(items), 2):
        key = items[place]
        if not isinstance(key, Word) or key.text not in keys:
            hint = did_you_mean(key.text, keys) if isinstance(key, Word) else None
            message = "expected `:parameters`, `:precondition` or `:effect`"
            raise reader.error(message, key, hint)
        if place + 1 == len(items):
            raise reader.error(f"expected something after `{key.text}`", key)
        if key.text in parts:
            raise reader.error(f"an action has only one `{key.text}`", key)
        parts[key.text] = items[place + 1]
    parameters: tuple[Parameter, ...] = ()
    if ":parameters" in parts:
        parameters = scope.parameters(parts[":parameters"], section)
    inner = scope.within(parameters)
    condition = inner.formula(parts[":precondition"]) if ":precondition" in parts else TRUE
    effects, costs = inner.effects(parts[":effect"]) if ":effect" in parts else ([], [])
    return Action(items[1].text, parameters, condition, tuple(effects), tuple(costs), items[1].span)


def _same_domain(reader: Reader, section: List, domain: PddlDomain) -> None:
    name = section.items[1] if len(section.items) == 2 else None
    if not isinstance(name, Word):
        raise reader.error("expected the name of the domain", section)
    if name.text != domain.name:
        message = f"the task belongs to domain `{name.text}`, not to `{domain.name}`"
        raise reader.error(message, name, f"The domain was read from {domain.source.name}.")


def _fact(
    scope: Scope, item: Item, init: set[tuple[str, ...]], values: dict[tuple[str, ...], int]
) -> None:
    reader = scope.reader
    if not isinstance(item, List):
        raise reader.error(f"expected a fact, found `{item.text}`", item)
    match item.head():
        case "=":
            if len(item.items) != 3 or not isinstance(item.items[1], List):
                raise reader.error("expected `(= (FUNCTION ...) NUMBER)`", item)
            atom = scope.atom(item.items[1], functions=True)
            values[(atom.name, *atom.terms)] = number(reader, item.items[2])
        case "not":
            # What is not listed is false anyway.
            if len(item.items) != 2 or not isinstance(item.items[1], List):
                raise reader.error("expected `(not FACT)`", item)
            scope.atom(item.items[1])
        case "at" if "at" not in scope.predicates:
            raise reader.error("timed initial literals are not supported", item)
        case _:
            atom = scope.atom(item)
            init.add((atom.name, *atom.terms))
