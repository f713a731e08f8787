"""Quantifiers and comprehensions: a set is chosen first, and then counted or gone through."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from domains.pddl.features.called import function_of
from domains.pddl.features.rows import Mask, bits_of
from sketchlang.checking.typed import ONE, OPEN, Node

if TYPE_CHECKING:
    from domains.pddl.features.compiler import Compiler, Frame, Run


def compiled(compiler: Compiler, node: Node) -> Run:
    """The closure of a quantifier, or of a set or relation by its condition."""
    level = node.value
    assert isinstance(level, int)
    if node.kind == "set":
        over, condition = node.parts
        return chosen(compiler, over, [(condition, True)], level)
    if node.kind == "pairs":
        return _pairs(compiler, node, level)
    over, condition, body, *rest = node.parts
    if node.kind in ("some", "count"):
        found = chosen(compiler, over, [(condition, True), (body, True)], level)
        if node.kind == "some":
            return lambda frame: bool(found(frame))
        return lambda frame: found(frame).bit_count()
    if node.kind == "all":
        broken = chosen(compiler, over, [(condition, True), (body, False)], level)
        return lambda frame: not broken(frame)
    found = chosen(compiler, over, [(condition, True)], level)
    value, slot = compiler.run(body), level + 1
    if node.kind == "sum":
        return _sum(found, value, slot)
    default = compiler.run(rest[0]) if rest else None
    return _extreme(found, value, slot, default, node.kind == "min")


def chosen(compiler: Compiler, over: Node, conditions: list[tuple[Node, bool]], level: int) -> Run:
    """The elements of a set for which conditions on the variable of a level are true, or false.

    What can be said of all elements at once is said first; the rest is asked one by one.
    """
    sets: list[tuple[Run, bool]] = []
    tests: list[tuple[Run, bool]] = []
    for condition, wanted in _conjuncts(conditions):
        if condition.kind == "constant":
            if bool(condition.value) != wanted:
                return lambda frame: 0
            continue
        whole = as_set(compiler, condition, level)
        if whole is not None:
            sets.append((whole, wanted))
        else:
            tests.append((compiler.run(condition), wanted))
    start, slot = compiler.run(over), level + 1

    def at_once(frame: Frame) -> Mask:
        found: Mask = start(frame)
        for whole, wanted in sets:
            if not found:
                break
            found &= whole(frame) if wanted else ~whole(frame)
        return found

    if not tests:
        return at_once if sets else start

    def one_by_one(frame: Frame) -> Mask:
        found = 0
        outer = frame[slot]
        for element in bits_of(at_once(frame)):
            frame[slot] = element
            for test, wanted in tests:
                if bool(test(frame)) != wanted:
                    break
            else:
                found |= 1 << element
        frame[slot] = outer
        return found

    return one_by_one


def _conjuncts(conditions: list[tuple[Node, bool]]) -> Iterator[tuple[Node, bool]]:
    """Conditions that all have to be as wanted, taken apart."""
    for node, wanted in conditions:
        if node.kind == "not":
            yield from _conjuncts([(node.parts[0], not wanted)])
        elif (node.kind == "and" and wanted) or (node.kind == "or" and not wanted):
            yield from _conjuncts([(part, wanted) for part in node.parts])
        elif node.kind == "->" and not wanted:
            yield from _conjuncts([(node.parts[0], True), (node.parts[1], False)])
        else:
            yield node, wanted


def as_set(compiler: Compiler, node: Node, level: int) -> Run | None:
    """The objects for which a condition on the variable of a level holds, as one expression;
    None where it has to be asked one by one. What it says of objects that are not of the
    variable's sort does not matter."""
    if level not in node.free:
        run, full = compiler.run(node), compiler.everything
        return lambda frame: full if run(frame) else 0
    match node.kind:
        case "call" | "image":
            return _of_predicate(compiler, node, level)
        case "in" if _is(node.parts[0], level) and level not in node.parts[1].free:
            return compiler.run(node.parts[1])
        case "=" if node.parts[0].type.is_element:
            for one, other in (node.parts, node.parts[::-1]):
                if _is(one, level) and level not in other.free:
                    value = compiler.run(other)
                    return lambda frame: 1 << value(frame)
            return None
        case "subset":
            return _of_rows(compiler, node, level)
        case "not":
            inner = as_set(compiler, node.parts[0], level)
            return None if inner is None else (lambda frame: ~inner(frame))
        case "and" | "or" | "->":
            parts = [as_set(compiler, part, level) for part in node.parts]
            known = [part for part in parts if part is not None]
            return _joined(node.kind, known) if len(known) == len(parts) else None
    return None


def _joined(kind: str, parts: list[Run]) -> Run:
    if kind == "->":
        first, second = parts
        return lambda frame: ~first(frame) | second(frame)
    if kind == "or":

        def either(frame: Frame) -> Mask:
            found = 0
            for part in parts:
                found |= part(frame)
            return found

        return either

    def both(frame: Frame) -> Mask:
        found = -1
        for part in parts:
            found &= part(frame)
        return found

    return both


def _of_predicate(compiler: Compiler, node: Node, level: int) -> Run | None:
    """A predicate with the variable in one place, which is left open instead."""
    function = function_of(node)
    assert function is not None
    places = [place for place, part in enumerate(node.parts) if level in part.free]
    if len(places) != 1 or not _is(node.parts[places[0]], level):
        return None
    pattern = [ONE] * len(node.parts)
    if node.kind == "image":
        if node.type.is_set or node.type.is_relation:
            return None
        pattern = list(node.value[1])  # type: ignore[index]
    pattern[places[0]] = OPEN
    given = [compiler.run(part) for place, part in enumerate(node.parts) if place != places[0]]
    return compiler.image(compiler.source(compiler.meanings[function]), tuple(pattern), given)


def _of_rows(compiler: Compiler, node: Node, level: int) -> Run | None:
    """`p(x, _) <= q(x, _)`, what most goals are about: only the rows of `p` are looked at, and
    only atoms that are missing where `p` never changes."""
    if not all(_is(argument, level) for part in node.parts for argument in part.parts):
        return None
    wanted = compiler.wanted_rows(node)
    if wanted is not None:
        lacking = wanted.lacking
        return lambda frame: ~lacking(frame[0])
    first, second = (compiler.row_source(part) for part in node.parts)
    if first is None or second is None:
        return None
    rows, last = first.rows, second.last

    def run(frame: Frame) -> Mask:
        bits, broken = frame[0], 0
        for element, row in rows(bits).items():
            if row & ~last(bits, (element,)):
                broken |= 1 << element
        return ~broken

    return run


def _is(node: Node, level: int) -> bool:
    return node.kind == "variable" and node.value == level


def _pairs(compiler: Compiler, node: Node, level: int) -> Run:
    over, other, condition = node.parts
    start = compiler.run(over)
    row = chosen(compiler, other, [(condition, True)], level + 1)
    slot = level + 1

    def run(frame: Frame) -> dict[int, Mask]:
        outer = frame[slot]
        found = {}
        for element in bits_of(start(frame)):
            frame[slot] = element
            related = row(frame)
            if related:
                found[element] = related
        frame[slot] = outer
        return found

    return run


def _sum(found: Run, value: Run, slot: int) -> Run:
    def run(frame: Frame) -> int:
        outer, total = frame[slot], 0
        for element in bits_of(found(frame)):
            frame[slot] = element
            total += value(frame)
        frame[slot] = outer
        return total

    return run


def _extreme(found: Run, value: Run, slot: int, default: Run | None, least: bool) -> Run:
    def run(frame: Frame) -> int:
        outer, best = frame[slot], None
        for element in bits_of(found(frame)):
            frame[slot] = element
            this: int = value(frame)
            if best is None or (this < best if least else this > best):
                best = this
                if least and not best:
                    break
        frame[slot] = outer
        if best is not None:
            return best
        return default(frame) if default is not None else 0

    return run
