"""Typed expressions to closures over a frame.

A frame is a list that lives while one state is evaluated: the state, the value of every
variable, the value of every feature, and the memory of expressions that are needed more
than once. A closure takes the frame and returns its expression's value; which closure that
is was decided when the sketch was compiled.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable
from typing import Any

from sketchlang.checking.typed import BINDERS, QUANTIFIERS, Node
from sketchlang.compile import seam, sets
from sketchlang.compile.quantifiers import quantifier
from sketchlang.compile.seam import Frame, Run
from sketchlang.domain import Domain, Function

STATE = 0


class Layout:
    """Which place of a frame holds what."""

    def __init__(self, features: int, roots: Iterable[Node]) -> None:
        roots = list(roots)
        levels = 1 + max((level for node in _all(roots) for level in _level(node)), default=-1)
        self.first_variable = 1
        self.first_feature = 1 + levels
        self.size = self.first_feature + features
        self.remembered: dict[Node, int] = {}
        places: dict[Hashable, int] = {}
        for node in _worth_remembering(roots):
            self.remembered[node] = places.setdefault(_shape(node), self.size + len(places))
        self.size += len(places)
        self.memories = sorted({self.remembered[node] for node in self.remembered if _key(node)})
        """The places that hold a dictionary from the values of variables to results."""

    def variable(self, level: int) -> int:
        """The place of the variable of a level."""
        return self.first_variable + level

    def feature(self, index: int) -> int:
        """The place of a feature's value."""
        return self.first_feature + index


class Compiler:
    """Makes closures, one for each node. With `careful` they call domain functions twice."""

    def __init__(self, domain: Domain, layout: Layout, careful: bool) -> None:
        self.domain = domain
        self.layout = layout
        self.careful = careful
        self.done: dict[Node, Run] = {}

    def run(self, node: Node) -> Run:
        """The closure of a node."""
        found = self.done.get(node)
        if found is None:
            place = self.layout.remembered.get(node)
            if place is not None and _of_variables(node) and not self.careful:
                found = seam.remembered(self._call(node), place)
            if found is None:
                found = self._compile(node)
                if place is not None:
                    slots = [self.layout.variable(level) for level in _key(node)]
                    found = _remember(found, place, slots)
            self.done[node] = found
        return found

    def _compile(self, node: Node) -> Run:
        kind, value = node.kind, node.value
        if kind == "constant":
            return lambda frame: value
        if kind == "variable":
            assert isinstance(value, int)
            return _at(self.layout.variable(value))
        if kind == "feature":
            assert isinstance(value, int)
            return _at(self.layout.feature(value))
        if kind == "call":
            call = self._call(node)
            return seam.careful(call) if self.careful else seam.compiled(call)
        parts = [self.run(part) for part in node.parts]
        if kind in QUANTIFIERS:
            assert isinstance(value, int)
            unconditional = node.parts[1].kind == "constant" and node.parts[1].value is True
            default = parts[3] if len(parts) == 4 else None
            condition = None if unconditional else parts[1]
            slot = self.layout.variable(value)
            return quantifier(
                kind, slot, parts[0], condition=condition, body=parts[2], default=default
            )
        if kind in sets.KINDS:
            return sets.compiled(node, parts, self.domain, self.layout.variable)
        return _operator(kind, parts)

    def _call(self, node: Node) -> seam.Call:
        function = node.value
        assert isinstance(function, Function)
        slots = tuple(
            self.layout.variable(part.value)
            if part.kind == "variable" and isinstance(part.value, int)
            else None
            for part in node.parts
        )
        arguments = tuple(self.run(part) for part in node.parts)
        return seam.Call(function, arguments, slots, node.text, self.domain)


def _at(slot: int) -> Run:
    return lambda frame: frame[slot]


def _remember(run: Run, place: int, slots: list[int]) -> Run:
    """The closure with a memory: of one value, or of one for every value of its variables."""
    if not slots:

        def closed(frame: Frame) -> Any:
            value = frame[place]
            if value is None:
                value = frame[place] = run(frame)
            return value

        return closed
    if len(slots) == 1:
        slot = slots[0]

        def of_one(frame: Frame) -> Any:
            memory = frame[place]
            key = frame[slot]
            value = memory.get(key)
            if value is None:
                value = memory[key] = run(frame)
            return value

        return of_one

    def of_many(frame: Frame) -> Any:
        memory = frame[place]
        key = tuple([frame[slot] for slot in slots])
        value = memory.get(key)
        if value is None:
            value = memory[key] = run(frame)
        return value

    return of_many


def _operator(kind: str, parts: list[Run]) -> Run:
    if len(parts) == 1:
        only = parts[0]
        return lambda frame: not only(frame)
    if len(parts) == 2:
        return _BINARY[kind](*parts)
    return _MANY[kind](parts)


_BINARY: dict[str, Callable[[Run, Run], Run]] = {
    "->": lambda a, b: lambda frame: not a(frame) or b(frame),
    "or": lambda a, b: lambda frame: a(frame) or b(frame),
    "and": lambda a, b: lambda frame: a(frame) and b(frame),
    "+": lambda a, b: lambda frame: a(frame) + b(frame),
    "=": lambda a, b: lambda frame: a(frame) == b(frame),
    "<": lambda a, b: lambda frame: a(frame) < b(frame),
    "<=": lambda a, b: lambda frame: a(frame) <= b(frame),
    "in": lambda a, b: lambda frame: a(frame) in b(frame),
}
_MANY: dict[str, Callable[[list[Run]], Run]] = {
    "or": lambda parts: lambda frame: any(part(frame) for part in parts),
    "and": lambda parts: lambda frame: all(part(frame) for part in parts),
    "+": lambda parts: lambda frame: sum([part(frame) for part in parts]),
}


# What to remember.


def _all(roots: Iterable[Node]) -> Iterable[Node]:
    """Every node below the roots, once."""
    seen: set[Node] = set()
    todo = list(roots)
    while todo:
        node = todo.pop()
        if node not in seen:
            seen.add(node)
            yield node
            todo.extend(node.parts)


def _level(node: Node) -> Iterable[int]:
    if isinstance(node.value, int) and (node.kind == "variable" or node.kind in BINDERS):
        yield node.value
        if node.kind == "pairs":
            yield node.value + 1


def _of_variables(node: Node) -> bool:
    return node.kind == "call" and all(part.kind == "variable" for part in node.parts)


def _shape(node: Node) -> Hashable:
    """What shares one memory: calls of a function, whichever variables they are of."""
    return node.value if _of_variables(node) else node


def _key(node: Node) -> list[int]:
    """The levels of the variables whose values an entry of the memory belongs to."""
    if _of_variables(node):
        return [level for part in node.parts for level in _level(part)]
    return sorted(node.free)


def _worth_remembering(roots: list[Node]) -> list[Node]:
    """Expressions with calls in them that more than one expression uses, or that a
    quantifier would compute for every element although they do not depend on it."""
    nodes = list(_all(roots))
    uses = Counter(_shape(root) for root in roots)
    for node in nodes:
        uses.update(_shape(part) for part in node.parts)
    costly: set[Node] = set()
    for node in sorted(nodes, key=lambda node: node.height):
        if node.kind in ("call", "image") or any(part in costly for part in node.parts):
            costly.add(node)
    remembered = {node: None for node in nodes if node in costly and uses[_shape(node)] > 1}
    for node in nodes:
        if node.kind not in QUANTIFIERS:
            continue
        seen: set[Node] = set()
        todo = list(node.parts[1:3])
        while todo:
            inner = todo.pop()
            if inner in seen or inner not in costly:
                continue
            seen.add(inner)
            if node.value in inner.free:
                todo.extend(inner.parts)
            else:
                remembered[inner] = None
    return list(remembered)
