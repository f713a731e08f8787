"""Sets and relations as Python sees them: sets of elements, and sets of pairs.

This is the meaning of set expressions, over any domain. Domains that know more of their states
(`Domain.evaluator`) have quicker ways, and tests that compare them with this.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from itertools import pairwise
from typing import Any, cast

from sketchlang.checking.typed import MANY, ONE, OPEN, Node
from sketchlang.compile.errors import BrokenPromiseError, shown
from sketchlang.compile.seam import Frame, Run
from sketchlang.domain import Domain, Function

KINDS = frozenset(
    {
        "image",
        "apply",
        "apply+",
        "apply*",
        "closure+",
        "closure*",
        "inverse",
        "identity",
        "compose",
        "restrict",
        "list",
        "set",
        "pairs",
        "|",
        "-",
        "&",
        "same",
        "subset",
        "distance",
        "if",
    }
)
"""The kinds of nodes that are compiled here."""

Pairs = Collection[tuple[Any, Any]]


def compiled(node: Node, parts: list[Run], domain: Domain, slot: Callable[[int], int]) -> Run:
    """The closure of a node; `slot` tells where the variable of a level lies in a frame."""
    match node.kind:
        case "image":
            function, pattern = cast(tuple[Function, tuple[str, ...]], node.value)
            return _image(function, pattern, parts, node.text)
        case "apply" | "apply+" | "apply*":
            return _apply(node.kind[5:], cast(tuple[str, ...], node.value), parts)
        case "set":
            assert isinstance(node.value, int)
            return _set(slot(node.value), *parts)
        case "pairs":
            assert isinstance(node.value, int)
            return _pairs(slot(node.value), slot(node.value + 1), *parts)
        case "closure*":
            return _reflexive(node, parts[0], domain)
    return _PLAIN[node.kind](*parts)


def _image(function: Function, pattern: tuple[str, ...], parts: list[Run], text: str) -> Run:
    extension = function.extension
    assert extension is not None

    def tuples(frame: Frame) -> Iterable[tuple[Any, ...]]:
        try:
            found = extension(frame[0])
            for one in found:
                if len(one) != len(pattern):
                    raise ValueError(f"{shown(one)} is no tuple of {len(pattern)}")
        except Exception as error:
            reason = f"{function.name} cannot be listed: {type(error).__name__}: {error}"
            raise BrokenPromiseError(reason, text, function.name) from error
        return found

    return lambda frame: _matching(tuples(frame), pattern, [part(frame) for part in parts])


def _matching(tuples: Iterable[tuple[Any, ...]], pattern: tuple[str, ...], given: list[Any]) -> Any:
    """What the open places of the tuples hold that agree with the given ones elsewhere; where
    none is open, whether there is such a tuple."""
    wanted = iter(given)
    tests = []
    for place, kind in enumerate(pattern):
        if kind == ONE:
            tests.append((place, frozenset((next(wanted),))))
        elif kind == MANY:
            tests.append((place, frozenset(next(wanted))))
    fitting = (one for one in tuples if all(one[place] in test for place, test in tests))
    places = [place for place, kind in enumerate(pattern) if kind == OPEN]
    if not places:
        return any(True for _ in fitting)
    if len(places) == 1:
        return frozenset(one[places[0]] for one in fitting)
    return frozenset((one[places[0]], one[places[1]]) for one in fitting)


def _apply(sign: str, pattern: tuple[str, ...], parts: list[Run]) -> Run:
    relation, *given = parts

    def run(frame: Frame) -> Any:
        values = [part(frame) for part in given]
        pairs = relation(frame)
        if sign:
            pairs = closure(pairs)
        if sign == "*":
            # What is asked about is related to itself, whatever else is.
            known = {
                x
                for kind, value in zip([k for k in pattern if k != OPEN], values, strict=True)
                for x in (value if kind == MANY else (value,))
            }
            pairs = pairs | {(x, x) for x in known}
        return _matching(pairs, pattern, values)

    return run


def closure(pairs: Pairs) -> frozenset[tuple[Any, Any]]:
    """The transitive closure of a relation."""
    after: dict[Any, set[Any]] = {}
    for first, second in pairs:
        after.setdefault(first, set()).add(second)
    found = set()
    for start, following in after.items():
        todo, seen = list(following), set(following)
        while todo:
            for one in after.get(todo.pop(), ()):
                if one not in seen:
                    seen.add(one)
                    todo.append(one)
        found |= {(start, end) for end in seen}
    return frozenset(found)


def _reflexive(node: Node, relation: Run, domain: Domain) -> Run:
    members = domain.members
    assert members is not None
    sort = node.type.name
    return lambda frame: closure(relation(frame)) | {(x, x) for x in members(frame[0], sort)}


def _set(slot: int, over: Run, condition: Run) -> Run:
    def run(frame: Frame) -> Any:
        outer = frame[slot]
        found = []
        for element in over(frame):
            frame[slot] = element
            if condition(frame):
                found.append(element)
        frame[slot] = outer
        return frozenset(found)

    return run


def _pairs(first: int, second: int, over: Run, other: Run, condition: Run) -> Run:
    def run(frame: Frame) -> Any:
        outer = frame[first], frame[second]
        found = []
        for x in over(frame):
            frame[first] = x
            for y in other(frame):
                frame[second] = y
                if condition(frame):
                    found.append((x, y))
        frame[first], frame[second] = outer
        return frozenset(found)

    return run


def _distance(start: Run, relation: Run, end: Run) -> Run:
    def run(frame: Frame) -> Any:
        pairs = relation(frame)
        return steps(frozenset(start(frame)), pairs, frozenset(end(frame)))

    return run


def steps(start: frozenset[Any], pairs: Pairs, end: frozenset[Any]) -> int:
    """The fewest steps from an element of one set to one of another: one more than there are
    pairs if there is no way."""
    after: dict[Any, list[Any]] = {}
    for first, second in pairs:
        after.setdefault(first, []).append(second)
    seen, frontier, number = set(start), set(start), 0
    while frontier:
        if frontier & end:
            return number
        number += 1
        frontier = {y for x in frontier for y in after.get(x, ())} - seen
        seen |= frontier
    return len(pairs) + 1


def _composed(relations: list[Pairs]) -> frozenset[tuple[Any, Any]]:
    found = frozenset(relations[0])
    for _, following in pairwise(relations):
        after: dict[Any, list[Any]] = {}
        for first, second in following:
            after.setdefault(first, []).append(second)
        found = frozenset((x, z) for x, y in found for z in after.get(y, ()))
    return found


def _restricted(pairs: Pairs, sides: list[Collection[Any]]) -> frozenset[tuple[Any, Any]]:
    kept = [frozenset(side) for side in sides]
    return frozenset(
        pair for pair in pairs if all(x in side for x, side in zip(pair, kept, strict=False))
    )


def _common(sets: list[Collection[Any]]) -> frozenset[Any]:
    first, *others = (frozenset(part) for part in sets)
    return first.intersection(*others)


_PLAIN: dict[str, Callable[..., Run]] = {
    "closure+": lambda r: lambda frame: closure(r(frame)),
    "inverse": lambda r: lambda frame: frozenset((y, x) for x, y in r(frame)),
    "identity": lambda s: lambda frame: frozenset((x, x) for x in s(frame)),
    "compose": lambda *parts: lambda frame: _composed([part(frame) for part in parts]),
    "restrict": lambda r, *sides: lambda frame: _restricted(r(frame), [s(frame) for s in sides]),
    "list": lambda *parts: lambda frame: frozenset(part(frame) for part in parts),
    "|": lambda a, b: lambda frame: frozenset(a(frame)) | frozenset(b(frame)),
    "-": lambda a, b: lambda frame: frozenset(a(frame)) - frozenset(b(frame)),
    "&": lambda *parts: lambda frame: _common([part(frame) for part in parts]),
    "same": lambda a, b: lambda frame: frozenset(a(frame)) == frozenset(b(frame)),
    "subset": lambda a, b: lambda frame: frozenset(a(frame)) <= frozenset(b(frame)),
    "distance": _distance,
    "if": lambda c, a, b: lambda frame: a(frame) if c(frame) else b(frame),
}
