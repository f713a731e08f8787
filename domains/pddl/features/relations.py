"""Relations with arguments, closures and distances."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import TYPE_CHECKING, cast

from domains.pddl.features import rows
from domains.pddl.features.rows import Mask, Row, Rows, bits_of
from sketchlang.checking.typed import MANY, OPEN, Node

if TYPE_CHECKING:
    from domains.pddl.features.compiler import Compiler, Frame, Run

KINDS = frozenset(
    {
        "apply",
        "apply+",
        "apply*",
        "closure+",
        "closure*",
        "inverse",
        "identity",
        "compose",
        "restrict",
        "distance",
    }
)


def compiled(compiler: Compiler, node: Node) -> Run:
    """The closure of a node of these kinds."""
    if node.kind.startswith("apply"):
        return _apply(compiler, node)
    if node.kind == "distance":
        return _distance(compiler, node)
    parts = [compiler.run(part) for part in node.parts]
    first = parts[0]
    match node.kind:
        case "closure+":
            return lambda frame: rows.closure(first(frame))
        case "closure*":
            members = rows.identity(compiler.task.types[compiler.sorts[node.type.name]])
            return lambda frame: rows.combined("|", rows.closure(first(frame)), members)
        case "inverse":
            return lambda frame: rows.inverse(first(frame))
        case "identity":
            return lambda frame: rows.identity(first(frame))
        case "compose":
            return lambda frame: reduce(rows.composed, [part(frame) for part in parts])
    start = parts[1]
    end = parts[2] if len(parts) == 3 else None
    return lambda frame: rows.restricted(
        first(frame), start(frame), None if end is None else end(frame)
    )


def row_of(compiler: Compiler, node: Node) -> Callable[[Frame], Row]:
    """A relation as a function of its left side: where a predicate of the state has its rows at
    hand, they are not gathered first."""
    if node.kind == "image" and not node.parts:
        where = compiler.source(compiler.meanings[node.value[0]])  # type: ignore[index]

        def of_state(frame: Frame) -> Row:
            bits, last = frame[0], where.last
            return lambda element: last(bits, (element,))

        return of_state
    if node.kind == "restrict":
        return _restricted_rows(compiler, node)
    run = compiler.run(node)
    return lambda frame: rows.getter(run(frame))


def _restricted_rows(compiler: Compiler, node: Node) -> Callable[[Frame], Row]:
    """The rows of a restricted relation, of which only those are made that are asked for."""
    relation = row_of(compiler, node.parts[0])
    start = compiler.run(node.parts[1])
    end = compiler.run(node.parts[2]) if len(node.parts) == 3 else None

    def of_frame(frame: Frame) -> Row:
        row, first = relation(frame), start(frame)
        last = -1 if end is None else end(frame)
        return lambda element: row(element) & last if first >> element & 1 else 0

    return of_frame


def _apply(compiler: Compiler, node: Node) -> Run:
    """A relation or its closure with arguments, one of which may be open."""
    relation, *arguments = node.parts
    pattern = cast(tuple[str, str], node.value)
    given = iter([compiler.run(part) for part in arguments])
    left, right = (
        None if kind == OPEN else _as_mask(next(given), kind == MANY) for kind in pattern
    )
    if left is not None:
        after = _after(row_of(compiler, relation), left, node.kind[5:])
        if right is None:
            return after
        end = right
        return lambda frame: bool(after(frame) & end(frame))
    assert right is not None
    run, wanted = compiler.run(relation), right
    if node.kind == "apply":

        def before(frame: Frame) -> Mask:
            end, found = wanted(frame), 0
            for element, row in run(frame).items():
                if row & end:
                    found |= 1 << element
            return found

        return before

    def other_way(frame: Frame) -> Row:
        return rows.getter(rows.inverse(run(frame)))

    return _after(other_way, right, node.kind[5:])


def _as_mask(run: Run, many: bool) -> Run:
    return run if many else lambda frame: 1 << run(frame)


def _after(row: Callable[[Frame], Row], start: Run, sign: str) -> Run:
    if sign == "":
        return lambda frame: rows.image(row(frame), start(frame))
    if sign == "+":
        return lambda frame: rows.reached(row(frame), start(frame))

    def reflexive(frame: Frame) -> Mask:
        elements: Mask = start(frame)
        return elements | rows.reached(row(frame), elements)

    return reflexive


def _distance(compiler: Compiler, node: Node) -> Run:
    first, relation, last = node.parts
    start, end = compiler.run(first), compiler.run(last)
    run = compiler.run(relation)
    if not compiler.depends(relation) and not relation.free:
        table: Rows = run([0] * (compiler.first_feature + 1))
        return _measured(table, start, end)

    def searched(frame: Frame) -> int:
        found: Rows = run(frame)
        otherwise = rows.size(found) + 1
        return rows.steps(rows.getter(found), start(frame), end(frame), otherwise)

    return searched


def _measured(table: Rows, start: Run, end: Run) -> Run:
    """Distances in a relation that never changes: the layers around an element are kept."""
    row, otherwise = rows.getter(table), rows.size(table) + 1
    layers: dict[int, list[Mask]] = {}

    def around(element: int) -> list[Mask]:
        found = layers.get(element)
        if found is None:
            seen = frontier = 1 << element
            found = []
            while frontier:
                found.append(frontier)
                frontier = rows.image(row, frontier) & ~seen
                seen |= frontier
            layers[element] = found
        return found

    def run(frame: Frame) -> int:
        wanted: Mask = end(frame)
        best = otherwise
        if not wanted:
            return best
        for element in bits_of(start(frame)):
            for number, layer in enumerate(around(element)):
                if number >= best:
                    break
                if layer & wanted:
                    best = number
                    break
        return best

    return run
