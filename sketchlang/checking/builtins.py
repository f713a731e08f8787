"""Functions of the language itself: `inverse`, `compose`, `restrict`, `identity`, `distance`."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from sketchlang.checking.calls import Scope, a
from sketchlang.checking.sets import SetTyper
from sketchlang.checking.typed import Node
from sketchlang.syntax import tree
from sketchlang.types import NAT, Type


class BuiltinTyper(SetTyper):
    """The part of the typer that knows these functions."""

    def builtin(self, expr: tree.Call, scope: Scope) -> Node | None:
        """A call of `inverse`, `compose`, `restrict`, `identity` or `distance`; None for others."""
        found = _BUILTINS.get(expr.name.text)
        if found is None:
            return None
        form, least, most, make = found
        place = scope.label(expr.span)
        if not least <= len(expr.arguments) <= most:
            for argument in expr.arguments:
                self.node(argument, scope)
            self.report.add(
                "wrong-arity",
                f"`{expr.name.text}` takes {_number(least, most)}, {len(expr.arguments)} given",
                place,
                hint=f"It is `{form}`.",
            )
            return self.unknown(place)
        made = make(self, expr, scope)
        return made if made is not None else self.unknown(place)

    def _inverse(self, expr: tree.Call, scope: Scope) -> Node | None:
        relation = self.relation(expr.arguments[0], "the argument of `inverse`", scope)
        if relation is None:
            return None
        place = scope.label(expr.span)
        return self.store.node("inverse", relation.type.inverse, place, (relation,))

    def _compose(self, expr: tree.Call, scope: Scope) -> Node | None:
        parts = [self.relation(part, "an argument of `compose`", scope) for part in expr.arguments]
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            return None
        for first, second in pairwise(known):
            if not self.fits(first.type.inverse.element, second.type.element):
                self.report.add(
                    "mixed-comparison",
                    f"what {a(first.type)} leads to, {a(second.type)} does not start from",
                    scope.label(expr.span),
                )
                return None
        type_ = Type(known[0].type.name, to=known[-1].type.to)
        return self.store.node("compose", type_, scope.label(expr.span), tuple(known))

    def _restrict(self, expr: tree.Call, scope: Scope) -> Node | None:
        relation = self.relation(expr.arguments[0], "the first argument of `restrict`", scope)
        what = "an argument of `restrict`"
        sets = [self.elements(part, what, scope) for part in expr.arguments[1:]]
        known = [part for part in sets if part is not None]
        if relation is None or len(known) < len(sets):
            return None
        sides = (relation.type.element, relation.type.inverse.element)
        for part, side, written in zip(known, sides, expr.arguments[1:], strict=False):
            if not self.side(part, side, 2, "`restrict`", written, (), scope):
                return None
        place = scope.label(expr.span)
        return self.store.node("restrict", relation.type, place, (relation, *known))

    def _identity(self, expr: tree.Call, scope: Scope) -> Node | None:
        elements = self.elements(expr.arguments[0], "the argument of `identity`", scope)
        if elements is None:
            return None
        type_ = Type(elements.type.name, to=elements.type.name)
        return self.store.node("identity", type_, scope.label(expr.span), (elements,))

    def _distance(self, expr: tree.Call, scope: Scope) -> Node | None:
        first, second, third = expr.arguments
        start = self.elements(first, "where `distance` starts", scope)
        relation = self.relation(second, "the second argument of `distance`", scope)
        end = self.elements(third, "where `distance` ends", scope)
        if start is None or relation is None or end is None:
            return None
        sides = (relation.type.element, relation.type.inverse.element)
        for number, (part, side, written) in enumerate(
            ((start, sides[0], first), (end, sides[1], third)), 1
        ):
            if not self.side(part, side, 2 * number - 1, "`distance`", written, (), scope):
                return None
        place = scope.label(expr.span)
        return self.store.node("distance", NAT, place, (start, relation, end))


_Make = Callable[[BuiltinTyper, tree.Call, Scope], Node | None]
_BUILTINS: dict[str, tuple[str, int, int, _Make]] = {
    "inverse": ("inverse(RELATION)", 1, 1, BuiltinTyper._inverse),
    "compose": ("compose(RELATION, RELATION)", 2, 9, BuiltinTyper._compose),
    "restrict": ("restrict(RELATION, FROM, TO)", 2, 3, BuiltinTyper._restrict),
    "identity": ("identity(SET)", 1, 1, BuiltinTyper._identity),
    "distance": ("distance(FROM, RELATION, TO)", 3, 3, BuiltinTyper._distance),
}
BUILTINS = frozenset(_BUILTINS)
"""Functions of the language: a domain's function of the same name takes their place."""


def _number(least: int, most: int) -> str:
    if least == most:
        return "1 argument" if least == 1 else f"{least} arguments"
    return f"{least} to {most} arguments" if most < 9 else f"{least} or more arguments"
