"""Typed expressions to closures over bits.

A closure takes a frame: the state's bits, the values of variables, the values of features. An
object is its number, a set of objects a mask, a relation rows of masks. Conditions on one variable
become sets where they can: `count x in A: p(x) and not q(x, y)` is a few operations on whole
numbers, whatever the size of `A`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from domains.pddl.features import quantifiers, relations, rows
from domains.pddl.features.called import function_of
from domains.pddl.features.rows import Mask, Rows, bits_of, mask_of
from domains.pddl.features.sources import (
    NARROW,
    Changing,
    Fixed,
    Source,
    WantedRows,
    source,
    wanted_rows,
)
from domains.pddl.ground.task import GroundTask
from sketchlang.checking.typed import BINDERS, MANY, ONE, OPEN, QUANTIFIERS, Node
from sketchlang.domain import Function

Frame = list[Any]
Run = Callable[[Frame], Any]

MEMORY = 50_000
"""So many results of an expression are kept at most, ..."""

MEMORY_BYTES = 64 << 20
"""... and so much of the states that they belong to."""


def kept_of(mask: Mask) -> int:
    """How many results are kept of what looks at these bits of a state."""
    return max(1, min(MEMORY, MEMORY_BYTES // (64 + mask.bit_length() // 8)))


_WORTH_KEEPING = (
    frozenset(
        [
            "image",
            "closure+",
            "closure*",
            "inverse",
            "compose",
            "restrict",
            "pairs",
            "set",
            "distance",
            "apply",
            "apply+",
            "apply*",
        ]
    )
    | QUANTIFIERS
)


@dataclass(frozen=True)
class Meaning:
    """What a function of a PDDL domain is: `kind` is `predicate`, `type`, `constant` or
    `goals` (how many are open), `name` its name in PDDL; `goal`: it speaks of the goal."""

    kind: str
    name: str
    goal: bool = False


class Compiler:
    """Makes closures for one task, one for each node."""

    def __init__(
        self,
        task: GroundTask,
        meanings: Mapping[Function, Meaning],
        sorts: Mapping[str, str],
        first_feature: int,
        depends: Mapping[int, Mask],
    ) -> None:
        self.task = task
        self.meanings = meanings
        self.sorts = sorts
        self.first_feature = first_feature
        self.feature_masks = depends
        self.sources: dict[tuple[str, bool], Source] = {}
        self.done: dict[Node, Run] = {}
        self.masks: dict[Node, Mask] = {}

    @cached_property
    def everything(self) -> Mask:
        """All objects."""
        return (1 << len(self.task.objects)) - 1

    # What expressions look at.

    def source(self, meaning: Meaning) -> Source:
        """The bits of a predicate."""
        key = (meaning.name, meaning.goal)
        if key not in self.sources:
            self.sources[key] = source(self.task, *key)
        return self.sources[key]

    def row_source(self, node: Node) -> Source | None:
        """The predicate `p` of `p(x, _)`; None for other nodes."""
        if node.kind != "image" or len(node.parts) != 1 or node.value[1] != (ONE, OPEN):  # type: ignore[index]
            return None
        function = function_of(node)
        assert function is not None
        return self.source(self.meanings[function])

    def wanted_rows(self, node: Node) -> WantedRows | None:
        """The atoms that `p(x, _) <= q(x, _)` asks for, where `p` never changes and `q` does."""
        if node.kind != "subset" or node.parts[0].parts != node.parts[1].parts:
            return None
        first, second = (self.row_source(part) for part in node.parts)
        if isinstance(first, Fixed) and isinstance(second, Changing):
            return wanted_rows(first, second)
        return None

    def depends(self, node: Node) -> Mask:
        """The bits of a state that an expression looks at."""
        found = self.masks.get(node)
        if found is None:
            found = 0
            wanted = self.wanted_rows(node)
            if wanted is not None:
                # What the argument depends on, and of `q` not all.
                found = self.masks[node] = wanted.mask | self.depends(node.parts[0].parts[0])
                return found
            for part in node.parts:
                found |= self.depends(part)
            if node.kind == "feature":
                assert isinstance(node.value, int)
                found |= self.feature_masks[node.value]
            function = function_of(node)
            if function is not None:
                meaning = self.meanings[function]
                if meaning.kind == "predicate":
                    found |= self.source(meaning).mask
                elif meaning.kind == "goals":
                    found |= self.task.goal_mask
            self.masks[node] = found
        return found

    # Closures.

    def run(self, node: Node) -> Run:
        """The closure of a node."""
        found = self.done.get(node)
        if found is None:
            found = self._compile(node)
            if not node.free and not _has_features(node):
                found = self._kept(node, found)
            self.done[node] = found
        return found

    def _kept(self, node: Node, run: Run) -> Run:
        """The closure with a memory, by the bits it looks at. What looks at none is a constant."""
        mask = self.depends(node)
        if not mask:
            value = run([0] * (self.first_feature + 1))
            return lambda frame: value
        if node.kind not in _WORTH_KEEPING:
            return run
        memory: dict[int, Any] = {}
        most = kept_of(mask)

        def kept(frame: Frame) -> Any:
            key = frame[0] & mask
            value = memory.get(key)
            if value is None:
                if len(memory) >= most:
                    memory.clear()
                value = memory[key] = run(frame)
            return value

        return kept

    def _compile(self, node: Node) -> Run:
        kind, value = node.kind, node.value
        if kind == "constant":
            return lambda frame: value
        if kind in ("variable", "feature"):
            assert isinstance(value, int)
            slot = value + (1 if kind == "variable" else self.first_feature)
            return lambda frame: frame[slot]
        if kind in ("call", "image"):
            function = function_of(node)
            assert function is not None
            meaning = self.meanings[function]
            if meaning.kind == "type":
                members = self.task.types[meaning.name]
                return lambda frame: members
            if meaning.kind == "goals":
                count = self.task.open_goals
                return lambda frame: count(frame[0])
            if meaning.kind == "constant":
                number = self.task.number(meaning.name)
                return lambda frame: number
            pattern: tuple[str, ...] = (ONE,) * len(node.parts)
            if kind == "image":
                pattern = value[1]  # type: ignore[index]
            return self.image(self.source(meaning), pattern, [self.run(p) for p in node.parts])
        if kind in BINDERS:
            return quantifiers.compiled(self, node)
        if kind in relations.KINDS:
            return relations.compiled(self, node)
        return self._operator(node)

    def _operator(self, node: Node) -> Run:
        kind = node.kind
        parts = [self.run(part) for part in node.parts]
        if kind in ("|", "&", "-") and node.type.is_relation:
            return _folded(parts, lambda a, b: rows.combined(kind, a, b))
        if kind == "list":
            return lambda frame: mask_of(part(frame) for part in parts)
        if kind == "subset" and node.parts[0].type.is_relation:
            first, second = parts
            return lambda frame: not rows.combined("-", first(frame), second(frame))
        if kind in _BINARY and len(parts) == 2:
            return _BINARY[kind](*parts)
        return _MANY[kind](parts)

    # Predicates with arguments, some of them open.

    def image(self, where: Source, pattern: tuple[str, ...], given: list[Run]) -> Run:
        """The closure of a predicate: whether it holds, or the set or rows of what is open."""
        if pattern and all(kind == ONE for kind in pattern[:-1]):
            last = self._last(where, given[: len(pattern) - 1])
            if pattern[-1] == OPEN:
                return last
            if pattern[-1] == MANY:
                many = given[-1]
                return lambda frame: bool(last(frame) & many(frame))
        if all(kind == ONE for kind in pattern):
            return _holds(where, given)
        if len(pattern) == 2:
            return self._binary(where, pattern, given)
        return _general(where, pattern, given)

    def _last(self, where: Source, given: list[Run]) -> Run:
        """What the last argument can be."""
        if not given:
            if isinstance(where, Changing):
                offset, full, low = where.box.offset, (1 << where.box.size) - 1, where.box.lows[0]
                return lambda frame: (frame[0] >> offset & full) << low
            members = where.last(0, ())
            return lambda frame: members
        if len(given) == 1:
            (first,) = given
            return lambda frame: where.last(frame[0], (first(frame),))
        return lambda frame: where.last(frame[0], tuple([part(frame) for part in given]))

    def _binary(self, where: Source, pattern: tuple[str, ...], given: list[Run]) -> Run:
        """Two arguments, of which not the first alone is given."""
        if pattern == (OPEN, OPEN):
            return lambda frame: where.rows(frame[0])
        if pattern[0] == MANY:
            start, image = given[0], where.image if isinstance(where, Fixed) else None

            def after(frame: Frame) -> Mask:
                if image is not None:
                    return image(start(frame))
                bits, found = frame[0], 0
                for element in bits_of(start(frame)):
                    found |= where.last(bits, (element,))
                return found

            if pattern[1] == OPEN:
                return after
            if pattern[1] == MANY:
                return lambda frame: bool(after(frame) & given[1](frame))
            return lambda frame: bool(after(frame) >> given[1](frame) & 1)
        end = given[0]
        many = pattern[1] == MANY
        if isinstance(where, Changing) and (not many or where.box.widths[1] <= NARROW):
            return _column(where, end if many else lambda frame: 1 << end(frame))
        if isinstance(where, Fixed):
            preimage, columns = where.preimage, rows.getter(where.columns)
            if many:
                return lambda frame: preimage(end(frame))
            return lambda frame: columns(end(frame))

        def before(frame: Frame) -> Mask:
            wanted = end(frame)
            wanted = wanted if many else 1 << wanted
            found = 0
            for element, row in where.rows(frame[0]).items():
                if row & wanted:
                    found |= 1 << element
            return found

        return before


def _column(where: Changing, end: Run) -> Run:
    """The set of `x` with `p(x, y)` for a `y` of a set: some bits of every row."""
    first_arguments, columns = where.first_arguments, where.box.lows[1]
    full = (1 << where.box.widths[1]) - 1
    return lambda frame: first_arguments(frame[0], end(frame) >> columns & full)


def _holds(where: Source, given: list[Run]) -> Run:
    if len(given) == 1:
        (first,) = given
        return lambda frame: where.holds(frame[0], (first(frame),))
    return lambda frame: where.holds(frame[0], tuple([part(frame) for part in given]))


def _general(where: Source, pattern: tuple[str, ...], given: list[Run]) -> Run:
    """Any pattern: by a look at all atoms that are true."""
    places = [place for place, kind in enumerate(pattern) if kind == OPEN]
    tests = [(place, kind) for place, kind in enumerate(pattern) if kind != OPEN]

    def fitting(frame: Frame) -> list[tuple[int, ...]]:
        wanted = [
            (place, part(frame) if kind == MANY else 1 << part(frame))
            for (place, kind), part in zip(tests, given, strict=True)
        ]
        return [
            values
            for values in where.tuples(frame[0])
            if all(mask >> values[place] & 1 for place, mask in wanted)
        ]

    if not places:
        return lambda frame: bool(fitting(frame))
    if len(places) == 1:
        (only,) = places
        return lambda frame: mask_of(values[only] for values in fitting(frame))
    first, second = places
    return lambda frame: rows.of_pairs((values[first], values[second]) for values in fitting(frame))


def _folded(parts: list[Run], both: Callable[[Rows, Rows], Rows]) -> Run:
    def run(frame: Frame) -> Any:
        found = parts[0](frame)
        for part in parts[1:]:
            found = both(found, part(frame))
        return found

    return run


def _has_features(node: Node) -> bool:
    return node.kind == "feature" or any(map(_has_features, node.parts))


_BINARY: dict[str, Callable[[Run, Run], Run]] = {
    "->": lambda a, b: lambda frame: not a(frame) or b(frame),
    "or": lambda a, b: lambda frame: a(frame) or b(frame),
    "and": lambda a, b: lambda frame: a(frame) and b(frame),
    "+": lambda a, b: lambda frame: a(frame) + b(frame),
    "=": lambda a, b: lambda frame: a(frame) == b(frame),
    "<": lambda a, b: lambda frame: a(frame) < b(frame),
    "<=": lambda a, b: lambda frame: a(frame) <= b(frame),
    "in": lambda a, b: lambda frame: bool(b(frame) >> a(frame) & 1),
    "|": lambda a, b: lambda frame: a(frame) | b(frame),
    "&": lambda a, b: lambda frame: a(frame) & b(frame),
    "-": lambda a, b: lambda frame: a(frame) & ~b(frame),
    "same": lambda a, b: lambda frame: a(frame) == b(frame),
    "subset": lambda a, b: lambda frame: not a(frame) & ~b(frame),
}
_MANY: dict[str, Callable[[list[Run]], Run]] = {
    "not": lambda parts: lambda frame: not parts[0](frame),
    "if": lambda parts: lambda frame: parts[1](frame) if parts[0](frame) else parts[2](frame),
    "or": lambda parts: lambda frame: any(part(frame) for part in parts),
    "and": lambda parts: lambda frame: all(part(frame) for part in parts),
    "+": lambda parts: lambda frame: sum([part(frame) for part in parts]),
    "&": lambda parts: _folded(parts, lambda a, b: a & b),  # type: ignore[operator]
}
