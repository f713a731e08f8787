"""Types of feature definitions: tree to typed nodes, with every mistake on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sketchlang.check.declarations import Declarations, Placed
from sketchlang.check.report import Report
from sketchlang.check.typed import Node, Store
from sketchlang.diagnostics import Label
from sketchlang.domain import Domain, Function
from sketchlang.source import Source, Span
from sketchlang.suggest import did_you_mean
from sketchlang.syntax import tree
from sketchlang.syntax.mistakes import FOREIGN
from sketchlang.types import BOOL, NAT, UNKNOWN, Type

MAX_HEIGHT = 150
"""Longest way down an expression with its definitions unfolded: evaluators are nested calls."""

_BODY = {"some": BOOL, "all": BOOL, "count": BOOL, "sum": NAT, "min": NAT, "max": NAT}
_RESULT = {"some": BOOL, "all": BOOL, "count": NAT, "sum": NAT, "min": NAT, "max": NAT}
_OPERATION = {"->": BOOL, "or": BOOL, "and": BOOL, "not": BOOL, "+": NAT}
_MIRROR = {">": "<", ">=": "<="}


@dataclass
class Binding:
    """A local name: a quantifier's variable or a definition's parameter."""

    node: Node
    place: Label
    used: bool = False


@dataclass(frozen=True)
class Scope:
    """The local names at one place and the number of quantifiers around it."""

    source: Source
    names: Mapping[str, Binding] = field(default_factory=dict)
    level: int = 0

    def label(self, span: Span, text: str = "") -> Label:
        """A place in the file of this scope."""
        return Label(self.source, span, text)

    def bind(self, name: str, binding: Binding) -> Scope:
        """The scope inside a quantifier."""
        return Scope(self.source, {**self.names, name: binding}, self.level + 1)


@dataclass
class Typer:
    """Turns expressions into nodes.

    `features` maps features to their index. `sound` are the definitions without mistakes of
    their own. `bodies` has the result of unfolding a definition for some arguments, so that
    definitions that use others many times cost no more than they are long.
    """

    declarations: Declarations
    domain: Domain | None
    functions: Mapping[str, Function]
    report: Report
    features: Mapping[str, int]
    store: Store = field(default_factory=Store)
    used: set[str] = field(default_factory=set)
    circular: set[str] = field(default_factory=set)
    sound: set[str] = field(default_factory=set)
    bodies: dict[tuple[str, tuple[int, ...], int], Node] = field(default_factory=dict)

    def expect(self, expr: tree.Expr, wanted: Type, what: str, scope: Scope) -> Node:
        """The node of an expression that has to be of a given type."""
        node = self.node(expr, scope)
        if node.kind == "unknown" or UNKNOWN in (node.type, wanted) or node.type == wanted:
            return node
        self.report.add(
            "wrong-type",
            f"{what} must be of type {wanted}, this is {_a(node.type)}",
            scope.label(expr.span),
            *self._origin(expr),
            hint=_conversion(node.type, wanted),
        )
        return self._unknown(scope.label(expr.span))

    def node(self, expr: tree.Expr, scope: Scope) -> Node:
        """The node of an expression; of type UNKNOWN where a mistake was reported."""
        place = scope.label(expr.span)
        match expr:
            case tree.Number(value):
                return self.store.constant(value, place)
            case tree.Truth(value):
                return self.store.constant(value, place)
            case tree.Call():
                made = self._call(expr, scope)
            case tree.Operation():
                made = self._operation(expr, scope)
            case tree.Comparison():
                made = self._comparison(expr, scope)
            case tree.Quantifier():
                made = self._quantifier(expr, scope)
        if made.height > MAX_HEIGHT:
            self._too_deep(place)
            return self._unknown(place)
        return made

    def _too_deep(self, place: Label) -> None:
        self.report.add(
            "nested-too-deeply",
            "with its definitions unfolded, this is nested too deeply",
            place,
            hint="Make parts of it features of their own.",
        )

    def _unknown(self, place: Label) -> Node:
        return self.store.node("unknown", UNKNOWN, place)

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
        if sign in ("=", "!="):
            if left.type.is_set or right.type.is_set:
                culprit = expr.left if left.type.is_set else expr.right
                self._set_as_value(scope.label(culprit.span), left if left.type.is_set else right)
                return self._unknown(place)
            if UNKNOWN not in (left.type, right.type) and left.type != right.type:
                self.report.add(
                    "mixed-comparison",
                    f"{_a(left.type)} cannot equal {_a(right.type)}",
                    place,
                    *self._origin(expr.left),
                    *self._origin(expr.right),
                )
                return self._unknown(place)
            equal = self.store.node("=", BOOL, place, (left, right))
            return equal if sign == "=" else self.store.node("not", BOOL, place, (equal,))
        for part, node in ((expr.left, left), (expr.right, right)):
            if node.type not in (NAT, UNKNOWN):
                self.report.add(
                    "wrong-type",
                    f"an operand of `{sign}` must be of type nat, this is {_a(node.type)}",
                    scope.label(part.span),
                    *self._origin(part),
                    hint=_conversion(node.type, NAT),
                )
                return self._unknown(place)
        self._constant_comparison(expr, place)
        if sign in _MIRROR:
            sign, left, right = _MIRROR[sign], right, left
        return self.store.node(sign, BOOL, place, (left, right))

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
            return self._unknown(place)
        if not right.type.is_set:
            self._no_set(expr.right, right, "what stands after `in`", scope)
            return self._unknown(place)
        if left.type != right.type.element:
            self.report.add(
                "mixed-comparison",
                f"{_a(left.type)} cannot be in a {right.type}",
                place,
                *self._origin(expr.left),
                *self._origin(expr.right),
            )
            return self._unknown(place)
        return self.store.node("in", BOOL, place, (left, right))

    def _no_set(self, expr: tree.Expr, node: Node, what: str, scope: Scope) -> None:
        sets = sorted(name for name, function in self.functions.items() if function.result.is_set)
        hint = None
        if sets:
            hint = "Sets of this domain: " + ", ".join(f"`{name}`" for name in sets[:8]) + "."
        self.report.add(
            "not-a-set",
            f"{what} must be a set, this is {_a(node.type)}",
            scope.label(expr.span),
            *self._origin(expr),
            hint=hint,
        )

    def _set_as_value(self, place: Label, node: Node) -> None:
        self.report.add(
            "wrong-type",
            f"sets cannot be compared, this is a {node.type}",
            place,
            hint="Quantify over it: `some x in SET: ...`, `count x in SET: ...`.",
        )

    # Quantifiers.

    def _quantifier(self, expr: tree.Quantifier, scope: Scope) -> Node:
        place = scope.label(expr.span)
        name = expr.variable
        over = self.node(expr.domain, scope)
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

    def hiding(self, name: tree.Name, scope: Scope) -> None:
        """Report a local name that hides another one."""
        text = name.text
        outer = scope.names.get(text)
        if outer is not None:
            other: tuple[Label, ...] = (_with_text(outer.place, "the other one"),)
        elif text in self.declarations.features or text in self.declarations.defines:
            other = (self.declaration(text),)
        elif text in self.functions:
            other = ()
        else:
            return
        self.report.add(
            "shadowing",
            f"`{text}` hides another `{text}`",
            scope.label(name.span),
            *other,
            hint="Choose another name.",
        )

    def declaration(self, name: str) -> Label:
        """Where a feature or definition is declared."""
        declared: Placed[tree.FeatureItem] | Placed[tree.Define]
        declared = self.declarations.features.get(name) or self.declarations.defines[name]
        return declared.label(declared.item.name.span, "declared here")

    # Names and calls.

    def _call(self, expr: tree.Call, scope: Scope) -> Node:
        name = expr.name.text
        place = scope.label(expr.span)
        binding = scope.names.get(name)
        if binding is not None:
            binding.used = True
            if self._takes_nothing(expr, f"variable `{name}`", scope):
                return binding.node
            return self._unknown(place)
        if name in self.declarations.features:
            return self._feature(expr, scope)
        if name in self.declarations.defines:
            return self._define(expr, scope)
        function = self.functions.get(name)
        if function is not None:
            wanted = function.parameters
            arguments = self._arguments(expr, wanted, None, f"`{name}`", scope)
            if arguments is None:
                return self.store.node("unknown", function.result, place)
            return self.store.call(function, arguments, place)
        for argument in expr.arguments:
            self.node(argument, scope)
        self._undefined(expr.name, scope)
        return self._unknown(place)

    def _undefined(self, name: tree.Name, scope: Scope) -> None:
        text, declarations = name.text, self.declarations
        if text in declarations.broken or declarations.incomplete:
            return
        if declarations.use is None and "use" in declarations.broken_items:
            return
        if declarations.use is not None and self.domain is None:
            return
        known = {*scope.names, *declarations.features, *declarations.defines, *self.functions}
        hint = did_you_mean(text, known)
        if hint is None and text in FOREIGN:
            hint = f"Did you mean `{FOREIGN[text]}`?"
        if hint is None and self.domain is None:
            hint = "The sketch names no domain: `use DOMAIN` brings in its functions."
        if text in self.domain_sorts():
            hint = f"`{text}` is a sort: quantify over a set of them."
        where = f" in domain {self.domain.name}" if self.domain is not None else ""
        message = f"`{text}` is neither declared here nor a function{where}"
        self.report.add("undefined-name", message, scope.label(name.span), hint=hint)

    def domain_sorts(self) -> frozenset[str]:
        """Names of the domain's sorts."""
        return frozenset(self.domain.sorts) if self.domain is not None else frozenset()

    def _takes_nothing(self, expr: tree.Call, what: str, scope: Scope) -> bool:
        if not expr.arguments:
            return True
        for argument in expr.arguments:
            self.node(argument, scope)
        span = expr.arguments[0].span.to(expr.arguments[-1].span)
        message = f"{what} takes no arguments"
        self.report.add(
            "wrong-arity", message, scope.label(span), hint=f"Write `{expr.name.text}`."
        )
        return False

    def _feature(self, expr: tree.Call, scope: Scope) -> Node:
        name = expr.name.text
        self.used.add(name)
        kind = BOOL if self.declarations.features[name].item.kind == "bool" else NAT
        place = scope.label(expr.span)
        if not self._takes_nothing(expr, f"feature `{name}`", scope):
            return self.store.node("unknown", kind, place)
        return self.store.node("feature", kind, place, (), self.features[name])

    def _define(self, expr: tree.Call, scope: Scope) -> Node:
        name = expr.name.text
        self.used.add(name)
        place = scope.label(expr.span)
        declared = self.declarations.defines[name]
        wanted = tuple(self.parameter_type(p) for p in declared.item.parameters)
        label = declared.label(declared.item.name.span, "defined here")
        arguments = self._arguments(expr, wanted, label, f"`{name}`", scope)
        if arguments is None or name in self.circular:
            return self._unknown(place)
        unfolded = self.unfold(name, arguments, scope.level)
        if not unfolded.sound and name in self.sound and all(a.sound for a in arguments):
            self._too_deep(place)
        return unfolded

    def _arguments(
        self,
        expr: tree.Call,
        wanted: tuple[Type, ...],
        declared: Label | None,
        what: str,
        scope: Scope,
    ) -> tuple[Node, ...] | None:
        """The nodes of a call's arguments, or None if they do not fit."""
        given = [self.node(argument, scope) for argument in expr.arguments]
        origin = (declared,) if declared is not None else self._origin(expr)
        if len(given) != len(wanted):
            takes = f"takes {_count(len(wanted))}, "
            self.report.add(
                "wrong-arity",
                f"{what} {takes}{len(given) or 'none'} given",
                scope.label(expr.span),
                *origin,
                hint=None if declared else f"It is `{self.functions[expr.name.text]}`.",
            )
            return None
        fits = True
        for number, (node, type_) in enumerate(zip(given, wanted, strict=True), 1):
            if UNKNOWN not in (node.type, type_) and node.type != type_:
                self.report.add(
                    "wrong-argument",
                    f"argument {number} of {what} must be of type {type_}, this is {_a(node.type)}",
                    scope.label(expr.arguments[number - 1].span),
                    *origin,
                )
                fits = False
        return tuple(given) if fits else None

    def _origin(self, expr: tree.Expr) -> tuple[Label, ...]:
        """Where the type of a name or call was declared."""
        if not isinstance(expr, tree.Call):
            return ()
        name = expr.name.text
        if name in self.declarations.features or name in self.declarations.defines:
            return (self.declaration(name),)
        function = self.functions.get(name)
        place = function.place() if function is not None else None
        return (place,) if place is not None else ()

    # Definitions.

    def parameter_type(self, parameter: tree.Parameter) -> Type:
        """The type that a parameter is declared with; UNKNOWN if there is none of the name."""
        name = parameter.type.text
        if name in ("bool", "nat"):
            return Type(name)
        return Type(name) if name in self.domain_sorts() else UNKNOWN

    def unfold(self, name: str, arguments: tuple[Node, ...], level: int) -> Node:
        """A definition's body with its parameters replaced by arguments."""
        key = (name, tuple(map(id, arguments)), level)
        found = self.bodies.get(key)
        if found is None:
            declared = self.declarations.defines[name]
            names = {
                parameter.name.text: Binding(node, declared.label(parameter.span))
                for parameter, node in zip(declared.item.parameters, arguments, strict=True)
            }
            # The mistakes in the body were reported where it is defined.
            self.report.muted += 1
            found = self.node(declared.item.body, Scope(declared.source, names, level))
            self.report.muted -= 1
            self.bodies[key] = found
        return found


def _with_text(label: Label, text: str) -> Label:
    return Label(label.source, label.span, text)


def _a(type_: Type) -> str:
    if type_ == BOOL:
        return "a Boolean"
    if type_ == NAT:
        return "a number"
    if type_.is_set:
        return f"a {type_}"
    article = "an" if type_.name[0] in "AEIOU" else "a"
    return f"{article} {type_.name}"


def _count(number: int) -> str:
    return {0: "no arguments", 1: "1 argument"}.get(number, f"{number} arguments")


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
