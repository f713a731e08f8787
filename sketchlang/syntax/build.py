"""Lark's tree of an item to a node: one method a rule of `grammars/sketch.lark`."""

from __future__ import annotations

from typing import Any, cast

from lark import Token, Tree
from lark.exceptions import VisitError
from lark.tree import Meta
from lark.visitors import Transformer_NonRecursive, v_args

from sketchlang.source import Span
from sketchlang.syntax import tree
from sketchlang.syntax.lexer import span
from sketchlang.syntax.rejected import RejectedError
from sketchlang.syntax.signs import SIGNS

MAX_NUMBER = 10**9


def build(parsed: Tree[Token]) -> tree.Item:
    """The node of an item that Lark has parsed. Raises `RejectedError`."""
    try:
        return cast(tree.Item, _BUILDER.transform(parsed))
    except VisitError as error:
        # Lark wraps what a method raises.
        raise error.orig_exc from None


def _name(token: Token) -> tree.Name:
    return tree.Name(str(token), span(token))


def _sign(token: Token) -> str:
    return SIGNS.get(token, str(token))


def _number(token: Token) -> int:
    # Counting digits first: Python refuses to convert very long ones.
    if len(token.lstrip("0")) > 10 or int(token) > MAX_NUMBER:
        raise RejectedError("number-too-large", "this number is above 1000000000", span(token))
    return int(token)


def _whole(meta: Meta) -> Span:
    return Span(meta.start_pos, meta.end_pos)


class _Default(tuple[tree.Expr]):
    """`default EXPRESSION`, which a quantifier has to tell from its body."""


@v_args(inline=True, meta=True)
class _Builder(Transformer_NonRecursive[Token, Any]):
    """Every method gets the place of its rule and the children that the grammar keeps."""

    def sketch(self, meta: Meta, name: Token) -> tree.Title:
        return tree.Title(_name(name), _whole(meta))

    def use(self, meta: Meta, target: Token) -> tree.Use:
        quoted = target.type == "STRING"
        text = target[1:-1] if quoted else str(target)
        return tree.Use(tree.Name(text, span(target)), _whole(meta), quoted)

    def include(self, meta: Meta, target: Token) -> tree.Include:
        quoted = target.type == "STRING"
        text = target[1:-1] if quoted else str(target)
        return tree.Include(text, quoted, span(target), _whole(meta))

    def feature(self, meta: Meta, *children: Any) -> tree.FeatureItem:
        bounded = children[0].type == "BOUNDED"
        name, kind, *rest = children[bounded:]
        definition = rest[1] if rest else None
        return tree.FeatureItem(_name(name), str(kind), bounded, definition, _whole(meta))

    def define(self, meta: Meta, name: Token, *rest: Any) -> tree.Define:
        parameters = rest[0] if len(rest) == 3 else ()
        return tree.Define(_name(name), parameters, rest[-1], _whole(meta))

    def parameters(self, _meta: Meta, *found: tree.Parameter) -> tuple[tree.Parameter, ...]:
        return found

    def parameter(self, meta: Meta, name: Token, kind: Token) -> tree.Parameter:
        return tree.Parameter(_name(name), _name(kind), _whole(meta))

    def invariant(self, meta: Meta, formula: tree.Expr) -> tree.InvariantItem:
        return tree.InvariantItem(formula, _whole(meta))

    def atoms(self, meta: Meta, *names: Token) -> tree.Atoms:
        return tree.Atoms(tuple(map(_name, names)), _whole(meta))

    def goal(self, meta: Meta, block: tree.Block) -> tree.Goal:
        return tree.Goal(block, _whole(meta))

    def rule(
        self, meta: Meta, name: Token, conditions: tree.Block, effects: tree.Block
    ) -> tree.RuleItem:
        return tree.RuleItem(_name(name), conditions, effects, _whole(meta))

    def block(self, meta: Meta, *literals: tree.Literal) -> tree.Block:
        return tree.Block(literals, _whole(meta))

    def literal(self, meta: Meta, *children: Token) -> tree.Literal:
        negated = children[0].type == "NOT"
        name, *rest = children[negated:]
        sign = _sign(rest[0]) if rest else ""
        number = _number(rest[1]) if len(rest) == 2 else None
        return tree.Literal(_name(name), negated, sign, number, _whole(meta))

    def implies(self, meta: Meta, *operands: tree.Expr) -> tree.Operation:
        return tree.Operation("->", operands, _whole(meta))

    def or_(self, meta: Meta, *operands: tree.Expr) -> tree.Operation:
        return tree.Operation("or", operands, _whole(meta))

    def and_(self, meta: Meta, *operands: tree.Expr) -> tree.Operation:
        return tree.Operation("and", operands, _whole(meta))

    def not_(self, meta: Meta, _sign: Token, operand: tree.Expr) -> tree.Operation:
        return tree.Operation("not", (operand,), _whole(meta))

    def add(self, meta: Meta, *operands: tree.Expr) -> tree.Operation:
        return tree.Operation("+", operands, _whole(meta))

    def combine(self, meta: Meta, left: tree.Expr, sign: Token, right: tree.Expr) -> tree.Operation:
        return tree.Operation(_sign(sign), (left, right), _whole(meta))

    def intersect(self, meta: Meta, *operands: tree.Expr) -> tree.Operation:
        return tree.Operation("&", operands, _whole(meta))

    def goal_atom(self, meta: Meta, call: tree.Call) -> tree.GoalAtom:
        return tree.GoalAtom(call, _whole(meta))

    def closure(self, meta: Meta, relation: tree.Expr, sign: Token) -> tree.Closure:
        return tree.Closure(relation, str(sign), _whole(meta))

    def apply(
        self, meta: Meta, relation: tree.Closure, arguments: tuple[tree.Expr, ...]
    ) -> tree.Expr:
        if relation.sign == "+" and len(arguments) == 1:
            # `a+(b)` is a sum that was written without spaces.
            return tree.Operation("+", (relation.relation, arguments[0]), _whole(meta))
        return tree.Apply(relation, arguments, _whole(meta))

    def binder(self, meta: Meta, variable: Token, _in: Token, domain: tree.Expr) -> tree.Binder:
        return tree.Binder(_name(variable), domain, _whole(meta))

    def comprehension(self, meta: Meta, *children: Any) -> tree.Comprehension:
        binders = tuple(child for child in children if isinstance(child, tree.Binder))
        condition = children[len(binders)] if len(children) > len(binders) else None
        return tree.Comprehension(binders, condition, _whole(meta))

    def listing(self, meta: Meta, elements: tuple[tree.Expr, ...]) -> tree.Listing:
        return tree.Listing(elements, _whole(meta))

    def conditional(
        self, meta: Meta, condition: tree.Expr, first: tree.Expr, second: tree.Expr
    ) -> tree.Conditional:
        return tree.Conditional(condition, first, second, _whole(meta))

    def compare(
        self, meta: Meta, left: tree.Expr, sign: Token, right: tree.Expr, *more: Any
    ) -> tree.Comparison:
        if more:
            raise RejectedError(
                "chained-comparison",
                "comparisons cannot be chained",
                span(more[0]),
                "Write `a < b and b < c`, or put one comparison in parentheses.",
            )
        return tree.Comparison(left, _sign(sign), right, _whole(meta))

    def truth(self, meta: Meta, word: Token) -> tree.Truth:
        return tree.Truth(word == "true", _whole(meta))

    def number(self, meta: Meta, digits: Token) -> tree.Number:
        return tree.Number(_number(digits), _whole(meta))

    def group(self, _meta: Meta, inner: tree.Expr) -> tree.Expr:
        return inner

    def call(self, meta: Meta, name: Token, arguments: tuple[tree.Expr, ...] = ()) -> tree.Call:
        return tree.Call(_name(name), arguments, _whole(meta))

    def arguments(self, _meta: Meta, *found: tree.Expr) -> tuple[tree.Expr, ...]:
        return found

    def quantifier(
        self, meta: Meta, kind: Token, variable: Token, _in: Token, domain: tree.Expr, *rest: Any
    ) -> tree.Quantifier:
        *parts, last = rest
        default = last[0] if isinstance(last, _Default) else None
        *where, body = parts if default is not None else rest
        condition = where[0] if where else None
        return tree.Quantifier(
            _sign(kind), _name(variable), domain, condition, body, default, _whole(meta)
        )

    def default(self, _meta: Meta, otherwise: tree.Expr) -> _Default:
        return _Default((otherwise,))


_BUILDER = _Builder(visit_tokens=False)
