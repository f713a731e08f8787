"""Types of feature definitions: tree to typed nodes, with every mistake on the way."""

from __future__ import annotations

from sketchlang.checking.builtins import BuiltinTyper
from sketchlang.checking.calls import Binding, Scope, a
from sketchlang.checking.typed import Node
from sketchlang.diagnostics import Label
from sketchlang.source import Span
from sketchlang.syntax import tree
from sketchlang.types import BOOL, NAT, UNKNOWN, Type

MAX_HEIGHT = 150
"""Longest way down an expression with its definitions unfolded: evaluators are nested calls,
and so is this check."""

_BODY = {"some": BOOL, "all": BOOL, "count": BOOL, "sum": NAT, "min": NAT, "max": NAT}
_RESULT = {"some": BOOL, "all": BOOL, "count": NAT, "sum": NAT, "min": NAT, "max": NAT}
_OPERATION = {"->": BOOL, "or": BOOL, "and": BOOL, "not": BOOL, "+": NAT}
_MIRROR = {">": "<", ">=": "<="}


class Typer(BuiltinTyper):
    """Turns expressions into nodes."""

    def expect(self, expr: tree.Expr, wanted: Type, what: str, scope: Scope) -> Node:
        """The node of an expression that has to be of a given type."""
        node = self.node(expr, scope)
        if node.kind == "unknown" or self.fits(node.type, wanted):
            return node
        self.report.add(
            "wrong-type",
            f"{what} must be of type {wanted}, this is {a(node.type)}",
            scope.label(expr.span),
            *self.origin(expr),
            hint=_conversion(node.type, wanted),
        )
        return self.unknown(scope.label(expr.span))

    def node(self, expr: tree.Expr, scope: Scope) -> Node:
        """The node of an expression; of type UNKNOWN where a mistake was reported."""
        place = scope.label(expr.span)
        if self.depth >= MAX_HEIGHT:
            self.too_deep(place)
            return self.unknown(place)
        self.depth += 1
        made = self._made(expr, scope)
        self.depth -= 1
        if made.height > MAX_HEIGHT:
            self.too_deep(place)
            return self.unknown(place)
        return made

    def _made(self, expr: tree.Expr, scope: Scope) -> Node:
        match expr:
            case tree.Number(value) | tree.Truth(value):
                return self.store.constant(value, scope.label(expr.span))
            case tree.Call():
                return self.call(expr, scope)
            case tree.Operation("|" | "-" | "&"):
                return self.set_operation(expr, scope)
            case tree.Operation():
                return self._operation(expr, scope)
            case tree.Comparison():
                return self._comparison(expr, scope)
            case tree.Quantifier():
                return self._quantifier(expr, scope)
            case tree.GoalAtom():
                return self.goal_atom(expr, scope)
            case tree.Closure():
                return self.closure(expr, scope)
            case tree.Apply():
                return self.apply(expr, scope)
            case tree.Comprehension():
                return self.comprehension(expr, scope)
            case tree.Listing():
                return self.listing(expr, scope)
            case tree.Conditional():
                return self.conditional(expr, scope)

    # Operators and comparisons.

    def _operation(self, expr: tree.Operation, scope: Scope) -> Node:
        type_ = _OPERATION[expr.sign]
        what = f"an operand of `{expr.sign}`"
        parts = tuple(self.expect(part, type_, what, scope) for part in expr.operands)
        return self.store.node(expr.sign, type_, scope.label(expr.span), parts)

    def _comparison(self, expr: tree.Comparison, scope: Scope) -> Node:
        place = scope.label(expr.span)
        left, right = self.node(expr.left, scope), self.node(expr.right, scope)
        sign = expr.sign
        if sign == "in":
            return self._membership(expr, left, right, scope)
        if UNKNOWN not in (left.type, right.type):
            both = [node.type.is_set or node.type.is_relation for node in (left, right)]
            if all(both):
                return self._sets(expr, left, right, scope)
            if sign in ("=", "!=") and any(both):
                self._mixed(expr, left, right, place)
                return self.unknown(place)
        if sign in ("=", "!="):
            if not self.fits(left.type, right.type):
                self._mixed(expr, left, right, place)
                return self.unknown(place)
            equal = self.store.node("=", BOOL, place, (left, right))
            return equal if sign == "=" else self.store.node("not", BOOL, place, (equal,))
        for part, node in ((expr.left, left), (expr.right, right)):
            if node.type not in (NAT, UNKNOWN):
                self.report.add(
                    "wrong-type",
                    f"an operand of `{sign}` must be of type nat, this is {a(node.type)}",
                    scope.label(part.span),
                    *self.origin(part),
                    hint=_conversion(node.type, NAT),
                )
                return self.unknown(place)
        self._constant_comparison(expr, place)
        if sign in _MIRROR:
            sign, left, right = _MIRROR[sign], right, left
        return self.store.node(sign, BOOL, place, (left, right))

    def _mixed(self, expr: tree.Comparison, left: Node, right: Node, place: Label) -> None:
        self.report.add(
            "mixed-comparison",
            f"{a(left.type)} cannot equal {a(right.type)}",
            place,
            *self.origin(expr.left),
            *self.origin(expr.right),
            hint=_truth_of(expr, left, right),
        )

    def _sets(self, expr: tree.Comparison, left: Node, right: Node, scope: Scope) -> Node:
        """Equality and inclusion of sets or relations."""
        place, sign = scope.label(expr.span), expr.sign
        if sign in ("<", ">"):
            self.report.add(
                "wrong-type",
                f"sets cannot be compared by `{sign}`",
                place,
                hint="Write `<=` for a subset, or compare how many elements there are.",
            )
            return self.unknown(place)
        if self.joined(left.type, right.type) is None:
            self._mixed(expr, left, right, place)
            return self.unknown(place)
        if sign == ">=":
            left, right = right, left
        if sign in ("<=", ">="):
            return self.store.node("subset", BOOL, place, (left, right))
        same = self.store.node("same", BOOL, place, (left, right))
        return same if sign == "=" else self.store.node("not", BOOL, place, (same,))

    def _constant_comparison(self, expr: tree.Comparison, place: Label) -> None:
        zero_left = isinstance(expr.left, tree.Number) and expr.left.value == 0
        zero_right = isinstance(expr.right, tree.Number) and expr.right.value == 0
        sign = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}[expr.sign] if zero_left else expr.sign
        if not (zero_left or zero_right):
            return
        if sign == ">=":
            self.report.add("always-true", "this always holds: values are never negative", place)
        elif sign == "<":
            self.report.add("always-false", "this never holds: values are never negative", place)

    def _membership(self, expr: tree.Comparison, left: Node, right: Node, scope: Scope) -> Node:
        place = scope.label(expr.span)
        if UNKNOWN in (left.type, right.type):
            return self.unknown(place)
        if not right.type.is_set:
            self._no_set(expr.right, right, "what stands after `in`", scope)
            return self.unknown(place)
        if not self.fits(left.type, right.type.element):
            self.report.add(
                "mixed-comparison",
                f"{a(left.type)} cannot be in a {right.type}",
                place,
                *self.origin(expr.left),
                *self.origin(expr.right),
            )
            return self.unknown(place)
        return self.store.node("in", BOOL, place, (left, right))

    def _no_set(self, expr: tree.Expr, node: Node, what: str, scope: Scope) -> None:
        sets = sorted(name for name, function in self.functions.items() if function.result.is_set)
        hint = None
        if sets:
            hint = "Sets of this domain: " + ", ".join(f"`{name}`" for name in sets[:8]) + "."
        self.report.add(
            "not-a-set",
            f"{what} must be a set, this is {a(node.type)}",
            scope.label(expr.span),
            *self.origin(expr),
            hint=hint,
        )

    # Quantifiers.

    def _quantifier(self, expr: tree.Quantifier, scope: Scope) -> Node:
        place = scope.label(expr.span)
        name = expr.variable
        over = self.node(expr.domain, scope.for_set())
        if over.type.is_set:
            element = over.type.element
        else:
            element = UNKNOWN
            if over.type != UNKNOWN:
                self._no_set(expr.domain, over, f"what `{expr.kind}` ranges over", scope)
        self.hiding(name, scope)
        where = scope.label(name.span)
        binding = Binding(self.store.variable(scope.level, element, where), where)
        before = len(self.report.diagnostics)
        inner = scope.bind(name.text, binding)
        condition = self.store.constant(True, where)
        if expr.condition is not None:
            condition = self.expect(expr.condition, BOOL, "the condition after `where`", inner)
        wanted = _BODY[expr.kind]
        body = self.expect(expr.body, wanted, f"the body of `{expr.kind}`", inner)
        # `count x in s: true` is how elements are counted. And where something is wrong, the
        # use may be in a part that was left out.
        counts_all = body.kind == "constant" and expr.condition is None
        if not (binding.used or counts_all) and len(self.report.diagnostics) == before:
            self.report.add(
                "unused-variable",
                f"variable `{name.text}` is never used",
                where,
                hint=None if expr.kind in ("count", "sum") else "Every element counts alike.",
            )
        parts = [over, condition, body]
        if expr.default is not None:
            if expr.kind not in ("min", "max"):
                self.report.add(
                    "default-without-min",
                    f"`{expr.kind}` takes no `default`: over no elements it is "
                    + {"some": "false", "all": "true"}.get(expr.kind, "0"),
                    scope.label(expr.default.span),
                    scope.label(Span(expr.span.start, expr.domain.span.end), "it belongs to this"),
                    hint="Put an inner quantifier in parentheses to end it before `default`.",
                )
            parts.append(self.expect(expr.default, NAT, "a default", scope))
        if over.type == UNKNOWN or not over.type.is_set:
            return self.store.node("unknown", _RESULT[expr.kind], place)
        return self.store.node(expr.kind, _RESULT[expr.kind], place, tuple(parts), scope.level)


def _truth_of(expr: tree.Comparison, left: Node, right: Node) -> str | None:
    """What to write for `held(x) = 1`."""
    for truth, node, other in ((left, right, expr.right), (right, left, expr.left)):
        if truth.type == BOOL and isinstance(other, tree.Number) and other.value in (0, 1):
            positive = (other.value == 1) == (expr.sign == "=")
            return f"Write `{'' if positive else 'not '}{truth.text}`."
        if truth.type == BOOL and node.type == NAT:
            return "Compare numbers with numbers, as in `... > 0`, and Booleans with Booleans."
    return None


def _conversion(given: Type, wanted: Type) -> str | None:
    if (given, wanted) == (NAT, BOOL):
        return "Compare it: `... > 0`."
    if given.is_set and wanted == NAT:
        return "Count its elements: `count x in SET: true`."
    if given.is_set and wanted == BOOL:
        return "Ask for an element: `some x in SET: ...`."
    if (given, wanted) == (BOOL, NAT):
        return "Numbers come from `count`, `sum`, `min`, `max` and functions of type nat."
    return None
