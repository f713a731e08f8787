"""Typed expressions: names resolved, definitions unfolded, equal parts shared.

Nodes are made by a `Store`, which returns the same object for the same expression. So
`obstructions(o)` in two features is one node, and the compiled sketch computes it once.
A variable is known by its level, the number of quantifiers around the one that binds it.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

from sketchlang.diagnostics import Label
from sketchlang.domain import Function
from sketchlang.types import BOOL, NAT, Type


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """An expression. `kind` tells what the other fields mean:

    | kind | parts | value |
    |---|---|---|
    | `unknown` | | |
    | `constant` | | the number or truth value |
    | `variable` | | its level |
    | `feature` | | its index |
    | `call` | arguments | the `Function` |
    | `-> or and not + = != < <= in` | operands | |
    | `some all count sum min max` | set, condition, body, default or not | level of its variable |
    | `image` | the arguments that are given | the `Function` and a pattern |
    | `apply apply+ apply*` | relation, the arguments that are given | a pattern |
    | `closure+ closure* inverse identity` | relation or set | |
    | `compose restrict` | relations; relation and one or two sets | |
    | `list` | elements | |
    | `set` | set, condition | level of its variable |
    | `pairs` | two sets, condition | level of its first variable |
    | <code>&#124; - &</code> `same subset` | sets or relations | |
    | `distance` | set, relation, set | |
    | `if` | condition, two values | |

    A pattern has a word for every argument: `_` for one that is left open, `one` for an element,
    `many` for a set of which one has to fit.

    `free` are the levels of the variables it needs. `height` counts the nodes on the
    longest way down. `sound` tells that there is no part `unknown`, which stands for what was
    reported as wrong. `place` is where it was first written.
    """

    kind: str
    type: Type
    parts: tuple[Node, ...]
    value: object
    free: frozenset[int]
    height: int
    sound: bool
    place: Label

    @property
    def text(self) -> str:
        """The expression as its author wrote it."""
        span = self.place.span
        return " ".join(self.place.source.text[span.start : span.end].split())


OPEN = "_"
"""Stands for an argument that is left open: `on(x, _)` is the set of what `x` is on."""

ONE, MANY = "one", "many"
"""What is given for an argument: an element, or a set of which one has to fit."""

QUANTIFIERS = frozenset({"some", "all", "count", "sum", "min", "max"})
BINDERS = QUANTIFIERS | {"set", "pairs"}
"""The kinds that have a variable of their own, or two."""
_NO_LEVELS: frozenset[int] = frozenset()


@dataclass
class Store:
    """Makes nodes, each of them once."""

    _nodes: dict[Hashable, Node] = field(default_factory=dict)

    def node(
        self,
        kind: str,
        type_: Type,
        place: Label,
        parts: tuple[Node, ...] = (),
        value: Hashable = None,
    ) -> Node:
        """The node with these parts; `place` counts only if it is new."""
        key = (kind, type_, tuple(map(id, parts)), value)
        found = self._nodes.get(key)
        if found is not None:
            return found
        free = _NO_LEVELS.union(*(part.free for part in parts))
        if kind == "variable":
            assert isinstance(value, int)
            free |= {value}
        elif kind in BINDERS:
            assert isinstance(value, int)
            free -= {value, value + 1} if kind == "pairs" else {value}
        height = 1 + max((part.height for part in parts), default=0)
        sound = kind != "unknown" and all(part.sound for part in parts)
        made = Node(kind, type_, parts, value, free, height, sound, place)
        self._nodes[key] = made
        return made

    def constant(self, value: int | bool, place: Label) -> Node:
        """A number or a truth value."""
        # `True == 1` for dictionaries, but the types differ.
        return self.node("constant", BOOL if isinstance(value, bool) else NAT, place, (), value)

    def variable(self, level: int, type_: Type, place: Label) -> Node:
        """A quantifier's variable."""
        return self.node("variable", type_, place, (), level)

    def call(self, function: Function, arguments: tuple[Node, ...], place: Label) -> Node:
        """A call of a domain function."""
        return self.node("call", function.result, place, arguments, function)
