"""Feature values straight from the syntax tree: slow, short, and the reference.

Shares nothing with `sketchlang.checking` and `sketchlang.compile`: names are looked up while the
expression is evaluated, and nothing is remembered.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Any

from sketchlang.domain import Domain
from sketchlang.syntax import tree

_COMPARE: dict[str, Callable[[Any, Any], bool]] = {
    "=": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "in": lambda a, b: a in b,
}


class Interpreter:
    """Evaluates the features of one file in one state."""

    def __init__(self, parsed: tree.Tree, domain: Domain, state: object) -> None:
        self.features = {i.name.text: i for i in parsed.items if isinstance(i, tree.FeatureItem)}
        self.defines = {i.name.text: i for i in parsed.items if isinstance(i, tree.Define)}
        self.domain = domain
        self.state = state

    def values(self) -> tuple[int, ...]:
        """One value a feature."""
        return tuple(int(self.feature(name)) for name in self.features)

    def values_of(self, state: object) -> tuple[int, ...]:
        """The values in another state."""
        self.state = state
        return self.values()

    def feature(self, name: str) -> Any:
        definition = self.features[name].definition
        assert definition is not None
        return self.value(definition, {})

    def value(self, expr: tree.Expr, names: Mapping[str, Any]) -> Any:
        match expr:
            case tree.Number(value) | tree.Truth(value):
                return value
            case tree.Call(name, arguments):
                return self.call(name.text, [self.value(a, names) for a in arguments], names)
            case tree.Operation(sign, operands):
                values = [self.value(operand, names) for operand in operands]
                match sign:
                    case "not":
                        return not values[0]
                    case "and":
                        return all(values)
                    case "or":
                        return any(values)
                    case "->":
                        return not values[0] or values[1]
                    case _:
                        return sum(values)
            case tree.Comparison(left, sign, right):
                return _COMPARE[sign](self.value(left, names), self.value(right, names))
            case tree.Quantifier():
                return self.quantifier(expr, names)

    def call(self, name: str, arguments: list[Any], names: Mapping[str, Any]) -> Any:
        if name in names:
            return names[name]
        if name in self.features:
            return self.feature(name)
        if name in self.defines:
            define = self.defines[name]
            inner = [parameter.name.text for parameter in define.parameters]
            return self.value(define.body, dict(zip(inner, arguments, strict=True)))
        return self.domain.functions[name].call(self.state, *arguments)

    def quantifier(self, expr: tree.Quantifier, names: Mapping[str, Any]) -> Any:
        values = []
        for element in self.value(expr.domain, names):
            inner = {**names, expr.variable.text: element}
            if expr.condition is None or self.value(expr.condition, inner):
                values.append(self.value(expr.body, inner))
        match expr.kind:
            case "some":
                return any(values)
            case "all":
                return all(values)
            case "count" | "sum":
                return sum(values)
            case _:
                if not values:
                    return 0 if expr.default is None else self.value(expr.default, names)
                return min(values) if expr.kind == "min" else max(values)
