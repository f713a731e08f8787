"""Sets and relations: arguments left open, closures, set expressions."""

from __future__ import annotations

from sketchlang.checking.calls import Binding, Calls, Scope, a
from sketchlang.checking.typed import MANY, ONE, OPEN, Node
from sketchlang.diagnostics import Label
from sketchlang.domain import Function
from sketchlang.syntax import tree
from sketchlang.types import BOOL, NAT, UNKNOWN, Type


class SetTyper(Calls):
    """The part of the typer that knows sets and relations."""

    # Arguments that are left open.

    def is_image(self, expr: tree.Call, function: Function) -> bool:
        """Whether a call is one of a relation: arguments may be left open, or sets."""
        if function.extension is None or not function.parameters:
            return False
        return len(expr.arguments) in (0, len(function.parameters))

    def image(self, expr: tree.Call, function: Function, scope: Scope) -> Node:
        """A relation some of whose arguments are left open, all of them if none is written."""
        name, sides = expr.name.text, function.parameters
        place = scope.label(expr.span)
        if not expr.arguments and len(sides) > 2:
            wild = ", ".join([OPEN] * len(sides))
            self.report.add(
                "wrong-arity",
                f"`{name}` takes {len(sides)} arguments, none given",
                place,
                *self.origin(expr),
                hint=f"Write `{name}({wild})` and fill in all but one or two.",
            )
            return self.unknown(place)
        given = self.sides(expr.arguments, sides, f"`{name}`", place, self.origin(expr), scope)
        if given is None:
            return self.unknown(place)
        pattern, parts, type_ = given
        if set(pattern) == {ONE}:
            return self.store.call(function, parts, place)
        return self.store.node("image", type_, place, parts, (function, pattern))

    def sides(
        self,
        arguments: tuple[tree.Expr, ...],
        sides: tuple[Type, ...],
        what: str,
        place: Label,
        origin: tuple[Label, ...],
        scope: Scope,
    ) -> tuple[tuple[str, ...], tuple[Node, ...], Type] | None:
        """What the arguments of a relation leave: the pattern, the nodes of those that are given,
        and the type of the result; None where something is wrong."""
        pattern: list[str] = []
        parts: list[Node] = []
        if not arguments:
            pattern = [OPEN] * len(sides)
        elif len(arguments) != len(sides):
            for argument in arguments:
                if not _is_open(argument):
                    self.node(argument, scope)
            message = f"{what} takes {len(sides)} arguments, {len(arguments)} given"
            self.report.add("wrong-arity", message, place, *origin)
            return None
        else:
            fits = True
            for number, (argument, side) in enumerate(zip(arguments, sides, strict=True), 1):
                if _is_open(argument):
                    pattern.append(OPEN)
                    continue
                node = self.node(argument, scope)
                fits = self.side(node, side, number, what, argument, origin, scope) and fits
                parts.append(node)
                pattern.append(MANY if node.type.is_set else ONE)
            if not fits:
                return None
        left = [side for side, kind in zip(sides, pattern, strict=True) if kind == OPEN]
        if len(left) > 2:
            self.report.add(
                "too-many-open",
                f"{what} leaves {len(left)} arguments open: one makes a set, two a relation",
                place,
                *origin,
            )
            return None
        if not all(part.sound for part in parts):
            return None
        if not left:
            return tuple(pattern), tuple(parts), BOOL
        if len(left) == 1:
            return tuple(pattern), tuple(parts), Type(left[0].name, is_set=True)
        return tuple(pattern), tuple(parts), Type(left[0].name, to=left[1].name)

    def side(
        self,
        node: Node,
        side: Type,
        number: int,
        what: str,
        argument: tree.Expr,
        origin: tuple[Label, ...],
        scope: Scope,
    ) -> bool:
        """Whether a node fits one side of a relation; reports it if not."""
        if node.type == UNKNOWN or not node.sound:
            return False
        if not node.type.is_relation and self.fits(node.type.element, side):
            return True
        self.report.add(
            "wrong-argument",
            f"argument {number} of {what} must be of type {side}, this is {a(node.type)}",
            scope.label(argument.span),
            *origin,
        )
        return False

    def goal_atom(self, expr: tree.GoalAtom, scope: Scope) -> Node:
        """`goal on(x, y)`: the function of the goal instead of the one of the state."""
        name = expr.call.name.text
        place = scope.label(expr.span)
        function = self.goals.get(name)
        if function is None:
            for argument in expr.call.arguments:
                if not _is_open(argument):
                    self.node(argument, scope)
            if self.domain is not None or self.declarations.use is None:
                self.no_goal(name, scope.label(expr.call.name.span))
            return self.unknown(place)
        return self.function_call(expr.call, function, scope)

    # Closures and what they are applied to.

    def closure(self, expr: tree.Closure, scope: Scope) -> Node:
        """`on+` or `on*`, a relation."""
        place = scope.label(expr.span)
        relation = self._homogeneous(expr, scope)
        if relation is None:
            return self.unknown(place)
        if expr.sign == "*" and (self.domain is None or self.domain.members is None):
            self.report.add(
                "no-universe",
                "what is related to itself by `*` are all elements of a sort, and this domain "
                "cannot list them",
                place,
                hint="Give it arguments, as in `R*(x, _)`, or use `+`.",
            )
            return self.unknown(place)
        return self.store.node(f"closure{expr.sign}", relation.type, place, (relation,))

    def _homogeneous(self, expr: tree.Closure, scope: Scope) -> Node | None:
        relation = self.relation(expr.relation, f"what stands before `{expr.sign}`", scope)
        if relation is None:
            return None
        type_ = relation.type
        assert type_.to is not None
        if not self.fits(type_.inverse.element, type_.element):
            self.report.add(
                "wrong-type",
                f"`{expr.sign}` needs a relation of a sort with itself, this is {a(type_)}",
                scope.label(expr.relation.span),
                *self.origin(expr.relation),
            )
            return None
        return relation

    def apply(self, expr: tree.Apply, scope: Scope) -> Node:
        """`on+(x, y)`, where arguments may be left open."""
        place = scope.label(expr.span)
        relation = self._homogeneous(expr.relation, scope)
        if relation is None:
            for argument in expr.arguments:
                if not _is_open(argument):
                    self.node(argument, scope)
            return self.unknown(place)
        if all(map(_is_open, expr.arguments)) and len(expr.arguments) == 2:
            return self.closure(expr.relation, scope)
        return self.applied(relation, expr.relation.sign, expr.arguments, place, scope)

    def applied(
        self,
        relation: Node,
        sign: str,
        arguments: tuple[tree.Expr, ...],
        place: Label,
        scope: Scope,
    ) -> Node:
        """A relation, or with a sign its closure, with arguments."""
        sides = (relation.type.element, relation.type.inverse.element)
        what = f"`{relation.text}{sign}`"
        given = self.sides(arguments, sides, what, place, (), scope)
        if given is None:
            return self.unknown(place)
        pattern, parts, type_ = given
        if len(parts) == 0:
            return relation
        return self.store.node(f"apply{sign}", type_, place, (relation, *parts), pattern)

    # Set expressions.

    def relation(self, expr: tree.Expr, what: str, scope: Scope) -> Node | None:
        """The node of an expression that has to be a relation."""
        node = self.node(expr, scope)
        if node.type.is_relation and node.sound:
            return node
        if node.type != UNKNOWN and node.sound:
            self.report.add(
                "not-a-relation",
                f"{what} must be a relation, this is {a(node.type)}",
                scope.label(expr.span),
                *self.origin(expr),
            )
        return None

    def elements(self, expr: tree.Expr, what: str, scope: Scope) -> Node | None:
        """The node of a set; an element counts as the set of itself."""
        node = self.node(expr, scope)
        if node.type == UNKNOWN or not node.sound:
            return None
        if node.type.is_set:
            return node
        if node.type.is_element:
            return self.store.node("list", Type(node.type.name, True), node.place, (node,))
        self.report.add(
            "not-a-set",
            f"{what} must be a set, this is {a(node.type)}",
            scope.label(expr.span),
            *self.origin(expr),
        )
        return None

    def set_operation(self, expr: tree.Operation, scope: Scope) -> Node:
        """`|`, `-` or `&` of sets or of relations."""
        place = scope.label(expr.span)
        parts = [self.node(part, scope) for part in expr.operands]
        if any(part.type == UNKNOWN or not part.sound for part in parts):
            return self.unknown(place)
        for part, written in zip(parts, expr.operands, strict=True):
            if not (part.type.is_set or part.type.is_relation):
                given, hint = a(part.type), None
                if part.type == NAT and expr.sign == "-":
                    hint = (
                        "There is no subtraction: values are never negative. Compare instead, as "
                        "in `a > b`, or write a function of the domain."
                    )
                elif part.type == BOOL:
                    hint = {"&": "Write `and`.", "|": "Write `or`."}.get(expr.sign)
                self.report.add(
                    "wrong-type",
                    f"an operand of `{expr.sign}` must be a set or relation, this is {given}",
                    scope.label(written.span),
                    *self.origin(written),
                    hint=hint,
                )
                return self.unknown(place)
        type_: Type | None = parts[0].type
        for part in parts[1:]:
            assert type_ is not None
            type_ = self._combined(expr.sign, type_, part.type)
            if type_ is None:
                self.report.add(
                    "mixed-comparison",
                    f"`{expr.sign}` cannot put {a(parts[0].type)} and {a(part.type)} together",
                    place,
                )
                return self.unknown(place)
        assert type_ is not None
        return self.store.node(expr.sign, type_, place, tuple(parts))

    def _combined(self, sign: str, first: Type, second: Type) -> Type | None:
        if first.is_relation != second.is_relation:
            return None
        if sign == "|":
            return self.joined(first, second)
        if not self.fits(first.element, second.element):
            return None
        if first.is_relation and not self.fits(first.inverse.element, second.inverse.element):
            return None
        return first

    def listing(self, expr: tree.Listing, scope: Scope) -> Node:
        """`{ a, b }`"""
        place = scope.label(expr.span)
        parts = [self.node(part, scope) for part in expr.elements]
        type_: Type | None = None
        for part, written in zip(parts, expr.elements, strict=True):
            if part.type == UNKNOWN or not part.sound:
                return self.unknown(place)
            joined = part.type if type_ is None else self.joined(type_, part.type)
            if not part.type.is_element or joined is None:
                self.report.add(
                    "wrong-type",
                    f"a set is made of elements of one sort, this is {a(part.type)}",
                    scope.label(written.span),
                    *self.origin(written),
                    hint="Braces make sets: conditions are put into parentheses.",
                )
                return self.unknown(place)
            type_ = joined
        assert type_ is not None
        return self.store.node("list", Type(type_.name, True), place, tuple(parts))

    def comprehension(self, expr: tree.Comprehension, scope: Scope) -> Node:
        """`{ x in A where condition }` or, with two variables, a relation."""
        place = scope.label(expr.span)
        before = len(self.report.diagnostics)
        domains, bindings, inner = [], [], scope
        for binder in expr.binders:
            over = self.elements(binder.domain, "what a variable ranges over", inner)
            self.hiding(binder.variable, inner)
            where = scope.label(binder.variable.span)
            element = over.type.element if over is not None else UNKNOWN
            binding = Binding(self.store.variable(inner.level, element, where), where)
            inner = inner.bind(binder.variable.text, binding)
            domains.append(over)
            bindings.append((binder.variable.text, binding))
        condition = self.store.constant(True, place)
        if expr.condition is not None:
            condition = self.expect(expr.condition, BOOL, "the condition after `where`", inner)
            for name, binding in bindings:
                if not binding.used and len(self.report.diagnostics) == before:
                    message = f"variable `{name}` is never used"
                    self.report.add("unused-variable", message, binding.place)
        parts = [over for over in domains if over is not None]
        if len(parts) < len(domains) or not condition.sound:
            return self.unknown(place)
        names = [over.type.name for over in parts]
        if len(names) == 1:
            type_, kind = Type(names[0], True), "set"
        else:
            type_, kind = Type(names[0], to=names[1]), "pairs"
        return self.store.node(kind, type_, place, (*parts, condition), scope.level)

    def conditional(self, expr: tree.Conditional, scope: Scope) -> Node:
        """`if condition then first else second`"""
        place = scope.label(expr.span)
        condition = self.expect(expr.condition, BOOL, "the condition after `if`", scope)
        first, second = self.node(expr.first, scope), self.node(expr.second, scope)
        if not (condition.sound and first.sound and second.sound):
            return self.unknown(place)
        type_ = self.joined(first.type, second.type)
        if type_ is None:
            self.report.add(
                "mixed-comparison",
                f"both cases must be of one type, these are {a(first.type)} and {a(second.type)}",
                place,
            )
            return self.unknown(place)
        return self.store.node("if", type_, place, (condition, first, second))


def _is_open(expr: tree.Expr) -> bool:
    return isinstance(expr, tree.Call) and expr.name.text == OPEN and not expr.arguments
