"""From typed expressions and a state to witnesses.

The values are those of the compiler's own closures (`sketchlang.compile.closures`), asked part by
part: what decided is looked up where the closure would only go on. So a witness cannot differ from
the value that it explains, and a new kind of expression has a witness without further ado: its
value.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, cast

from sketchlang.checking.checker import CheckedSketch
from sketchlang.checking.typed import QUANTIFIERS, Node
from sketchlang.compile.closures import Compiler, Layout
from sketchlang.compile.errors import BrokenPromiseError, EvaluationError, shown
from sketchlang.compile.seam import Frame
from sketchlang.domain import Domain, Function
from sketchlang.inspection.witness import Element, FeatureWitness, Witness

SHORT_CIRCUITS = {"and": False, "or": True}
"""The value of an operand that decides alone."""

COMPARISONS = frozenset({"=", "<", "<=", "in", "+"})
"""Kinds all of whose operands count."""

DEPTH = 8
"""Steps down that a witness goes: an expression may be shared so often that all of it is told in
no time at all by its values, and never by its text."""

_NAMED_SET = re.compile(r"\w+ \w+ in (\w+) ?(?:where\b|:)")

MIRRORED = {"<": ">", "<=": ">="}


class Explainer:
    """Makes witnesses for the features of a sketch that has a domain, definitions for all its
    features, and no errors."""

    def __init__(self, checked: CheckedSketch) -> None:
        definitions = [node for node in checked.definitions if node is not None]
        if checked.domain is None or len(definitions) != len(checked.definitions):
            raise ValueError("only sketches that can be run have witnesses")
        self.checked = checked
        self.definitions = definitions
        self.domain: Domain = checked.domain
        self.layout = Layout(len(definitions), definitions)
        self.compiler = Compiler(checked.domain, self.layout, careful=False)

    def features(self, state: Any) -> tuple[FeatureWitness, ...]:
        """A witness for every feature in a state.

        Raises:
            EvaluationError: a function of the domain breaks its promise.
        """
        frame: Frame = [None] * self.layout.size
        frame[0] = state
        for place in self.layout.memories:
            frame[place] = {}
        found: dict[int, FeatureWitness] = {}
        for index in self.checked.order:
            feature, node = self.checked.model.features[index], self.definitions[index]
            try:
                value = int(self.compiler.run(node)(frame))
                frame[self.layout.feature(index)] = value
                because = _State(self, frame).witness(node)
            except BrokenPromiseError as error:
                raise EvaluationError(
                    error.reason,
                    feature=feature.name,
                    expression=error.expression,
                    function=error.function,
                    position=error.position,
                    state=state,
                ) from error
            found[index] = FeatureWitness(
                feature.name, feature.kind.value, value, node.text, because
            )
        return tuple(found[index] for index in range(len(self.definitions)))


class _State:
    """Explains expressions in one state: a frame that holds it, and variables in it."""

    def __init__(self, explainer: Explainer, frame: Frame) -> None:
        self.explainer = explainer
        self.frame = frame

    def value(self, node: Node) -> Any:
        return self.explainer.compiler.run(node)(self.frame)

    def called(self, element: Any) -> str:
        return self.explainer.domain.called(self.frame[0], element)

    def witness(self, node: Node, depth: int = DEPTH) -> Witness:
        """The witness of an expression, with the variables that the frame has now, so many steps
        down."""
        value = self.value(node)
        if not depth:
            return Witness("deep", self.text(node), self.shown(node, value))
        if node.kind in QUANTIFIERS:
            return self._quantifier(node, value, depth - 1)
        if node.kind in SHORT_CIRCUITS:
            return self._operands(node, value, depth - 1)
        if node.kind == "->":
            return self._implication(node, value, depth - 1)
        if node.kind == "if":
            branch = node.parts[1] if self.value(node.parts[0]) else node.parts[2]
            both = (self.witness(node.parts[0], depth - 1), self.witness(branch, depth - 1))
            return Witness("if", self.text(node), self.shown(node, value), both)
        if node.kind in COMPARISONS or node.kind == "not":
            parts = tuple(self.witness(part, depth - 1) for part in node.parts)
            return Witness(node.kind, self.text(node), self.shown(node, value), parts)
        if node.kind in ("same", "subset"):
            return self._sets(node, value)
        return Witness(node.kind, self.text(node), self.shown(node, value))

    def shown(self, node: Node, value: Any) -> Any:
        """A value as witnesses hold it."""
        if node.type.is_set or node.type.is_relation:
            return tuple(self.names(value))
        return self.called(value) if node.type.is_element else value

    def names(self, elements: Iterable[Any]) -> list[str]:
        """What elements, or pairs of elements, are called, in the order of their names."""
        return sorted(
            f"({', '.join(map(self.called, element))})"
            if type(element) is tuple
            else self.called(element)
            for element in elements
        )

    def _operands(self, node: Node, value: Any, depth: int) -> Witness:
        """`and` and `or`: the first operand that decides, or all."""
        decisive, parts = SHORT_CIRCUITS[node.kind], []
        for part in node.parts:
            parts.append(self.witness(part, depth))
            if bool(self.value(part)) is decisive:
                parts = parts[-1:]
                break
        return Witness(node.kind, self.text(node), bool(value), tuple(parts))

    def _implication(self, node: Node, value: Any, depth: int) -> Witness:
        premise, conclusion = node.parts
        parts = [self.witness(premise, depth)]
        if self.value(premise):
            parts.append(self.witness(conclusion, depth))
            if value:
                parts = parts[1:]
        return Witness("->", self.text(node), bool(value), tuple(parts))

    def _sets(self, node: Node, value: Any) -> Witness:
        """Comparisons of sets: where they fail, what is in one and not in the other."""
        left, right = (frozenset(self.value(part)) for part in node.parts)
        parts = [Witness("set", self.text(p), self.shown(p, self.value(p))) for p in node.parts]
        if not value:
            more = [(0, 1, left - right)]
            if node.kind == "same":
                more.append((1, 0, right - left))
            parts = [
                Witness(
                    "-",
                    f"{self.text(node.parts[a])} without {self.text(node.parts[b])}",
                    tuple(self.names(rest)),
                )
                for a, b, rest in more
                if rest
            ]
        return Witness(node.kind, self.text(node), value, tuple(parts))

    def _quantifier(self, node: Node, value: Any, depth: int) -> Witness:
        over, condition, body = node.parts[:3]
        assert isinstance(node.value, int)
        slot = self.explainer.layout.variable(node.value)
        members = self.value(over)
        everything = list(members)
        if not isinstance(members, tuple | list):
            everything.sort(key=self.called)
        outer = self.frame[slot]
        elements, considered = [], 0
        for element in everything:
            self.frame[slot] = element
            if not self.value(condition):
                continue
            considered += 1
            result = self.value(body)
            if _counts(node.kind, result):
                because = self.witness(body, depth)
                elements.append(Element(self.called(element), result, because))
            if _decides(node.kind, result):
                break
        self.frame[slot] = outer
        if node.kind in ("min", "max"):
            # The first that has the value comes first, the others in their order.
            elements.sort(key=lambda element: element.value != value)
        unconditional = condition.kind == "constant" and condition.value is True
        return Witness(
            node.kind,
            node.text,
            bool(value) if node.type.name == "bool" else value,
            elements=tuple(elements),
            members=len(everything),
            considered=considered,
            over=_over(node),
            where=None if unconditional else condition.text,
            default=node.kind in ("min", "max") and not considered,
        )

    def text(self, node: Node) -> str:
        """An expression with what its variables stand for."""
        if node.height > DEPTH:
            return node.text
        if node.kind == "variable" or (node.kind == "call" and node.type.is_element):
            return self.called(self.value(node))
        if node.kind == "constant":
            return words(node.value)
        if node.kind == "feature":
            return self.explainer.checked.model.features[cast(int, node.value)].name
        if node.kind == "call":
            function = cast(Function, node.value)
            if not node.parts:
                return function.name
            return f"{function.name}({', '.join(map(self.text, node.parts))})"
        if node.kind == "not":
            inner = node.parts[0]
            if inner.kind == "=":
                return " != ".join(map(self._inner, inner.parts))
            return f"not {self._inner(inner)}"
        if node.kind in ("<", "<=") and node.parts[0].kind == "constant":
            # `n > 0` is checked as `0 < n`.
            return f" {MIRRORED[node.kind]} ".join(map(self._inner, reversed(node.parts)))
        if node.kind in COMPARISONS or node.kind in ("and", "or", "->"):
            return f" {node.kind} ".join(map(self._inner, node.parts))
        return node.text

    def _inner(self, node: Node) -> str:
        """The same as an operand of another expression."""
        text = self.text(node)
        plain = node.kind in ("variable", "constant", "feature", "call") or " " not in text
        return text if plain else f"({text})"


def _counts(kind: str, result: Any) -> bool:
    """Whether an element with this value belongs to the witness."""
    if kind in ("some", "count"):
        return bool(result)
    if kind == "all":
        return not result
    return kind in ("min", "max") or bool(result > 0)


def _decides(kind: str, result: Any) -> bool:
    """Whether no further element can change the value of the quantifier."""
    if kind == "some":
        return bool(result)
    if kind == "all":
        return not result
    return kind == "min" and bool(result == 0)


def _over(node: Node) -> str:
    """The set of a quantifier as its author wrote it: a name that was unfolded, by that name."""
    named = _NAMED_SET.match(node.text)
    return named[1] if named else node.parts[0].text


def words(value: object) -> str:
    """A value as the language writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value) if isinstance(value, int | str) else shown(value)
