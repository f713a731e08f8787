"""Relations with arguments, closures and distances."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, cast

from domains.pddl.features import rows
from domains.pddl.features.images import (
    REMEMBERED,
    by_components,
    image_of,
    remembering,
    steps,
)
from domains.pddl.features.rows import Image, Mask, Rows, bits_of, by_rows, reached
from domains.pddl.features.sources import Changing, Fixed
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


@dataclass(frozen=True)
class Related:
    """A relation as its images. `of` takes a frame and returns a key, equal where the relation is
    the same (None where nobody knows), and the images; of the relation itself, no more is made than
    is asked for. `symmetric`: every such relation is."""

    of: Callable[[Frame], tuple[Hashable, Image]]
    symmetric: bool = False


def related(compiler: Compiler, node: Node, turned: bool = False) -> Related:
    """The images of a relation, or `turned` of its inverse."""
    if node.kind == "inverse":
        return related(compiler, node.parts[0], not turned)
    if node.kind == "restrict":
        return _restricted(compiler, node, turned)
    if node.kind == "image" and not node.parts:
        where = compiler.source(compiler.meanings[node.value[0]])  # type: ignore[index]
        if isinstance(where, Fixed):
            always = 0, where.preimage if turned else where.image
            return Related(lambda frame: always, where.symmetric)
        if not turned:
            return Related(lambda frame: _of_state(where, frame[0]))
    run, mask, known = compiler.run(node), compiler.depends(node), not node.free
    if known and not mask:
        table: Rows = run([0] * (compiler.first_feature + 1))
        image = image_of(rows.inverse(table) if turned else table)
        return Related(lambda frame: (0, image))

    def of_frame(frame: Frame) -> tuple[Hashable, Image]:
        found: Rows = run(frame)
        image = by_rows(rows.inverse(found) if turned else found)
        return (frame[0] & mask if known else None), image

    return Related(of_frame)


def _of_state(where: Changing, bits: Mask) -> tuple[Hashable, Image]:
    last = where.last

    def image(start: Mask) -> Mask:
        found = 0
        for element in bits_of(start):
            found |= last(bits, (element,))
        return found

    return bits & where.mask, image


def _restricted(compiler: Compiler, node: Node, turned: bool) -> Related:
    relation = related(compiler, node.parts[0], turned)
    inner = relation.of
    sides = [compiler.run(part) for part in node.parts[1:]]
    if len(sides) == 1:
        sides.append(lambda frame: -1)
    first, second = reversed(sides) if turned else sides

    def of_frame(frame: Frame) -> tuple[Hashable, Image]:
        key, image = inner(frame)
        start, end = first(frame), second(frame)
        return (
            None if key is None else (key, start, end),
            lambda elements: image(elements & start) & end,
        )

    same = len(node.parts) == 3 and node.parts[1] == node.parts[2]
    return Related(of_frame, relation.symmetric and same)


def _apply(compiler: Compiler, node: Node) -> Run:
    """A relation or its closure with arguments, one of which may be open."""
    relation, *arguments = node.parts
    pattern = cast(tuple[str, str], node.value)
    given = iter([compiler.run(part) for part in arguments])
    left, right = (
        None if kind == OPEN else _as_mask(next(given), kind == MANY) for kind in pattern
    )
    sign = node.kind[5:]
    if left is not None:
        after = _after(related(compiler, relation), left, sign)
        if right is None:
            return after
        end = right
        return lambda frame: bool(after(frame) & end(frame))
    assert right is not None
    return _after(related(compiler, relation, turned=True), right, sign)


def _as_mask(run: Run, many: bool) -> Run:
    return run if many else lambda frame: 1 << run(frame)


def _after(relation: Related, start: Run, sign: str) -> Run:
    of = relation.of
    if sign == "":
        return lambda frame: of(frame)[1](start(frame))
    reach = by_components() if relation.symmetric else remembering()

    def reflexive(frame: Frame) -> Mask:
        key, image = of(frame)
        elements: Mask = start(frame)
        return elements | reached(image, elements) if key is None else reach(key, image, elements)

    if sign == "*":
        return reflexive

    def transitive(frame: Frame) -> Mask:
        key, image = of(frame)
        following = image(start(frame))
        if key is None:
            return following | reached(image, following)
        return reach(key, image, following)

    return transitive


def _distance(compiler: Compiler, node: Node) -> Run:
    first, relation, last = node.parts
    start, end = compiler.run(first), compiler.run(last)
    run = compiler.run(relation)
    if not compiler.depends(relation) and not relation.free:
        table: Rows = run([0] * (compiler.first_feature + 1))
        return _measured(table, start, end)
    of = related(compiler, relation).of
    memory: dict[Hashable, int] = {}

    def searched(frame: Frame) -> int:
        key, image = of(frame)
        asked = key, start(frame), end(frame)
        number = memory.get(asked)
        if number is None or key is None:
            number = steps(image, asked[1], asked[2])
            if number is None:
                number = rows.size(run(frame)) + 1
            if key is not None:
                if len(memory) >= REMEMBERED:
                    memory.clear()
                memory[asked] = number
        return number

    return searched


def _measured(table: Rows, start: Run, end: Run) -> Run:
    """Distances in a relation that never changes: the layers around an element are kept."""
    image, otherwise = image_of(table), rows.size(table) + 1
    layers: dict[int, list[Mask]] = {}

    def around(element: int) -> list[Mask]:
        found = layers.get(element)
        if found is None:
            seen = frontier = 1 << element
            found = []
            while frontier:
                found.append(frontier)
                frontier = image(frontier) & ~seen
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
