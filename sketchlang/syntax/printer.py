"""Items and expressions in their one canonical spelling, broken into lines where too long."""

from __future__ import annotations

from collections.abc import Sequence

from sketchlang.syntax import tree

WIDTH = 100
INDENT = 4

# How tightly an expression binds; the operands of an operator must bind more tightly.
_IMPLIES, _OR, _AND, _NOT, _COMPARE, _ADD, _UNION, _INTERSECT, _PRIMARY = range(1, 10)
_LEVEL = {
    "->": _IMPLIES,
    "or": _OR,
    "and": _AND,
    "not": _NOT,
    "+": _ADD,
    "|": _UNION,
    "-": _UNION,
    "&": _INTERSECT,
}


def item(node: tree.Item) -> list[str]:
    """The lines of an item."""
    match node:
        case tree.Title(name):
            return [f"sketch {name.text}"]
        case tree.Use(name, quoted=quoted):
            return [f'use "{name.text}"' if quoted else f"use {name.text}"]
        case tree.Include(target, quoted):
            return [f'include "{target}"' if quoted else f"include {target}"]
        case tree.FeatureItem():
            head = f"{'bounded ' if node.bounded else ''}feature {node.name.text} : {node.kind}"
            return [head] if node.definition is None else _assigned(head + " =", node.definition)
        case tree.Define():
            listed = ", ".join(f"{p.name.text} : {p.type.text}" for p in node.parameters)
            head = f"define {node.name.text}" + (f"({listed})" if listed else "")
            return _assigned(head + " =", node.body)
        case tree.InvariantItem(formula):
            return _assigned("invariant", formula)
        case tree.Atoms(names):
            return _filled("atoms ", [name.text for name in names], "")
        case tree.Goal(block):
            return _block("goal ", block)
        case tree.RuleItem():
            return _rule(node)
        case tree.Broken():
            raise ValueError("an item with a syntax error has no canonical spelling")


def _rule(node: tree.RuleItem) -> list[str]:
    head = f"rule {node.name.text}"
    line = f"{head} {_inline(node.conditions)} -> {_inline(node.effects)}"
    if len(line) <= WIDTH:
        return [line]
    indent = " " * INDENT
    return [head, *_block(indent, node.conditions), *_block(f"{indent}-> ", node.effects)]


def _inline(block: tree.Block) -> str:
    return "{ " + ", ".join(map(literal, block.literals)) + " }" if block.literals else "{}"


def _block(head: str, block: tree.Block) -> list[str]:
    line = head + _inline(block)
    return (
        [line]
        if len(line) <= WIDTH
        else _filled(head + "{ ", list(map(literal, block.literals)), " }")
    )


def _filled(head: str, words: Sequence[str], end: str) -> list[str]:
    """Words with commas, as many on a line as fit; further lines begin below the first word."""
    lines = []
    line = head
    for number, word in enumerate(words):
        last = number == len(words) - 1
        piece = word + (end if last else ",")
        if line != head and line.strip() and len(line) + len(piece) > WIDTH:
            lines.append(line.rstrip())
            line = " " * len(head)
        line += piece if last else piece + " "
    return [*lines, line.rstrip()]


def literal(node: tree.Literal) -> str:
    """A condition or effect."""
    text = ("!" if node.negated else "") + node.name.text
    if node.number is not None:
        return f"{text} {node.sign} {node.number}"
    return text + node.sign


def _assigned(head: str, expr: tree.Expr) -> list[str]:
    """A definition: on one line, or on its own lines below the head."""
    line = f"{head} {expression(expr)}"
    if len(line) <= WIDTH:
        return [line]
    return [head, *_broken(expr, INDENT, "")]


def expression(  # noqa: PLR0912 (a case for every kind of expression)
    expr: tree.Expr, level: int = _IMPLIES, last: bool = True
) -> str:
    """An expression on one line, in parentheses if it binds less tightly than `level`.

    `last` tells that nothing follows that a quantifier's body could take for its own.
    """
    match expr:
        case tree.Number(value):
            return str(value)
        case tree.Truth(value):
            return "true" if value else "false"
        case tree.Call(name, arguments):
            listed = ", ".join(map(expression, arguments))
            return f"{name.text}({listed})" if arguments else name.text
        case tree.GoalAtom(call):
            return f"goal {expression(call)}"
        case tree.Closure(relation, sign):
            inner = expression(relation)
            simple = isinstance(relation, tree.Call | tree.GoalAtom)
            return f"{inner}{sign}" if simple else f"({inner}){sign}"
        case tree.Apply(closure, arguments):
            return f"{expression(closure)}({', '.join(map(expression, arguments))})"
        case tree.Listing(elements):
            # `{ (x in A) }` would be read as `x` of `A` without the parentheses.
            return f"{{ {', '.join(expression(element, _ADD) for element in elements)} }}"
        case tree.Comprehension(binders, condition):
            where = f" where {expression(condition)}" if condition is not None else ""
            return f"{{ {_bound(binders)}{where} }}"
    if _needs_parentheses(expr, level, last):
        return f"({expression(expr)})"
    match expr:
        case tree.Operation("not", (operand,)):
            return f"not {expression(operand, _NOT, last)}"
        case tree.Operation():
            return f" {expr.sign} ".join(_operands(expr, last))
        case tree.Comparison(left, sign, right):
            return f"{expression(left, _ADD, False)} {sign} {expression(right, _ADD, last)}"
        case tree.Quantifier():
            return " ".join([_header(expr), *_tail(expr, last)])
        case tree.Conditional(condition, first, second):
            texts = expression(condition), expression(first), expression(second, _IMPLIES, last)
            return "if {} then {} else {}".format(*texts)
    raise AssertionError(expr)


def _bound(binders: tuple[tree.Binder, ...]) -> str:
    """`x in A, y in B`"""
    return ", ".join(f"{b.variable.text} in {expression(b.domain, _UNION, False)}" for b in binders)


def _needs_parentheses(expr: tree.Expr, level: int, last: bool) -> bool:
    match expr:
        case tree.Operation():
            return level > _LEVEL[expr.sign]
        case tree.Comparison():
            return level > _COMPARE
        case tree.Quantifier() | tree.Conditional():
            return not last
    return False


def _operands(expr: tree.Operation, last: bool) -> list[str]:
    """The operands of an operator, with parentheses where they need them."""
    level = _LEVEL[expr.sign]
    final = len(expr.operands) - 1
    return [
        expression(
            operand,
            level if _same_level(expr.sign, number, final) else level + 1,
            last and number == final,
        )
        for number, operand in enumerate(expr.operands)
    ]


def _same_level(sign: str, number: int, final: int) -> bool:
    """Whether an operand may be of the same operator without parentheses: `a -> b -> c` is
    `a -> (b -> c)`, and `A - B | C` is `(A - B) | C`; everything else is a list of operands."""
    return number == final if sign == "->" else sign in ("|", "-") and number == 0


def _header(expr: tree.Quantifier) -> str:
    where = f" where {expression(expr.condition)}" if expr.condition is not None else ""
    return f"{expr.kind} {expr.variable.text} in {expression(expr.domain, _UNION, False)}{where}:"


def _tail(expr: tree.Quantifier, last: bool) -> list[str]:
    """Body and default. A quantifier in the body would take the default."""
    body = expression(expr.body, _IMPLIES, last and expr.default is None)
    if expr.default is None:
        return [body]
    return [body, f"default {expression(expr.default, _IMPLIES, last)}"]


def _broken(expr: tree.Expr, indent: int, start: str) -> list[str]:
    """An expression on lines of its own: quantifiers are broken before their body, operators
    before each operand. `start` is an operator that the first line begins with."""
    margin = " " * indent + start
    line = margin + expression(expr)
    if len(line) <= WIDTH:
        return [line]
    match expr:
        case tree.Quantifier(default=None):
            return [margin + _header(expr), *_broken(expr.body, indent + INDENT, "")]
        case tree.Quantifier():
            inner = " " * (indent + INDENT)
            return [margin + _header(expr), *(inner + part for part in _tail(expr, True))]
        case tree.Comprehension(binders, tree.Operation() | tree.Quantifier() as condition):
            head = f"{margin}{{ {_bound(binders)} where"
            return [head, *_broken(condition, indent + INDENT, ""), " " * indent + "}"]
        case tree.Operation() if len(expr.operands) > 1:
            parts = _operands(expr, True)
            below = " " * indent
            return [margin + parts[0], *(f"{below}{expr.sign} {part}" for part in parts[1:])]
    return [line]
