"""The syntax tree: what was written, and where. Names are not resolved, types not known."""

from __future__ import annotations

from dataclasses import dataclass

from sketchlang.source import Source, Span
from sketchlang.syntax.lexer import Comment


@dataclass(frozen=True, slots=True)
class Name:
    """A name where it is declared or used."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Number:
    value: int
    span: Span


@dataclass(frozen=True, slots=True)
class Truth:
    """`true` or `false`."""

    value: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Call:
    """A variable, a feature, a definition, or a function of the domain with its arguments."""

    name: Name
    arguments: tuple[Expr, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Operation:
    """`->`, `or`, `and`, `not`, `+`, `|`, `-` or `&` and its operands: two or more; one for
    `not`; two for `|` and `-`."""

    sign: str
    operands: tuple[Expr, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Comparison:
    """`left sign right`; the sign is one of `= != < <= > >= in`."""

    left: Expr
    sign: str
    right: Expr
    span: Span


@dataclass(frozen=True, slots=True)
class Quantifier:
    """`kind variable in domain where condition: body default otherwise`.

    `kind` is one of `some all count sum min max`.
    """

    kind: str
    variable: Name
    domain: Expr
    condition: Expr | None
    body: Expr
    default: Expr | None
    span: Span


@dataclass(frozen=True, slots=True)
class GoalAtom:
    """`goal on(x, y)`: what the goal of the scene says of a function."""

    call: Call
    span: Span


@dataclass(frozen=True, slots=True)
class Closure:
    """`on+` or `on*`; the sign is `+` or `*`."""

    relation: Expr
    sign: str
    span: Span


@dataclass(frozen=True, slots=True)
class Apply:
    """`on+(x, y)`: a closure with its arguments."""

    relation: Closure
    arguments: tuple[Expr, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Binder:
    """`variable in domain`"""

    variable: Name
    domain: Expr
    span: Span


@dataclass(frozen=True, slots=True)
class Comprehension:
    """`{ x in A where condition }`, or `{ x in A, y in B where condition }` for pairs."""

    binders: tuple[Binder, ...]
    condition: Expr | None
    span: Span


@dataclass(frozen=True, slots=True)
class Listing:
    """`{ a, b }`: a set of a few elements."""

    elements: tuple[Expr, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Conditional:
    """`if condition then first else second`"""

    condition: Expr
    first: Expr
    second: Expr
    span: Span


Expr = (
    Number
    | Truth
    | Call
    | Operation
    | Comparison
    | Quantifier
    | GoalAtom
    | Closure
    | Apply
    | Comprehension
    | Listing
    | Conditional
)


@dataclass(frozen=True, slots=True)
class Literal:
    """What a rule or goal says of one feature.

    `sign` is `""` for the bare name; an effect's `--`, `++` or `?`; or a comparison sign,
    and then `number` is what the feature is compared with.
    """

    name: Name
    negated: bool
    sign: str
    number: int | None
    span: Span


@dataclass(frozen=True, slots=True)
class Block:
    """A list of literals in braces."""

    literals: tuple[Literal, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Title:
    """`sketch NAME`"""

    name: Name
    span: Span


@dataclass(frozen=True, slots=True)
class Use:
    """`use DOMAIN`, or `use "FILE.pddl"` with the path as `name`."""

    name: Name
    span: Span
    quoted: bool = False


@dataclass(frozen=True, slots=True)
class Include:
    """`include "FILE"` or `include BUILTIN`; `tree` is the other file's once it was read."""

    target: str
    quoted: bool
    place: Span
    span: Span
    tree: Tree | None = None


@dataclass(frozen=True, slots=True)
class FeatureItem:
    """`bounded feature NAME : KIND = DEFINITION`; `kind` is `bool` or `nat`."""

    name: Name
    kind: str
    bounded: bool
    definition: Expr | None
    span: Span


@dataclass(frozen=True, slots=True)
class Parameter:
    """`NAME : TYPE`; the type is `bool`, `nat` or the name of a sort."""

    name: Name
    type: Name
    span: Span


@dataclass(frozen=True, slots=True)
class Define:
    """`define NAME(PARAMETERS) = BODY`"""

    name: Name
    parameters: tuple[Parameter, ...]
    body: Expr
    span: Span


@dataclass(frozen=True, slots=True)
class InvariantItem:
    """`invariant FORMULA`"""

    formula: Expr
    span: Span


@dataclass(frozen=True, slots=True)
class Atoms:
    """`atoms NAME, NAME`"""

    names: tuple[Name, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Goal:
    """`goal { CONDITIONS }`"""

    block: Block
    span: Span


@dataclass(frozen=True, slots=True)
class RuleItem:
    """`rule NAME { CONDITIONS } -> { EFFECTS }`"""

    name: Name
    conditions: Block
    effects: Block
    span: Span


@dataclass(frozen=True, slots=True)
class Broken:
    """An item that does not parse. The name it would declare, if that much can be told,
    is kept so that its uses are not reported as well."""

    keyword: str
    name: Name | None
    span: Span


Item = (
    Title | Use | Include | FeatureItem | Define | InvariantItem | Atoms | Goal | RuleItem | Broken
)


@dataclass(frozen=True, slots=True)
class Tree:
    """One file: its items and comments in the order of the text."""

    source: Source
    items: tuple[Item, ...]
    comments: tuple[Comment, ...] = ()


def operands(expr: Expr) -> tuple[Expr, ...]:
    """The expressions directly inside an expression."""
    match expr:
        case Number() | Truth():
            return ()
        case Call():
            return expr.arguments
        case Operation():
            return expr.operands
        case Comparison():
            return (expr.left, expr.right)
        case Quantifier():
            parts = (expr.domain, expr.condition, expr.body, expr.default)
            return tuple(part for part in parts if part is not None)
        case GoalAtom(call):
            return (call,)
        case Closure(relation):
            return (relation,)
        case Apply(relation, arguments):
            return (relation, *arguments)
        case Comprehension(binders, condition):
            domains = tuple(binder.domain for binder in binders)
            return domains if condition is None else (*domains, condition)
        case Listing(elements):
            return elements
        case Conditional(test, first, second):
            return (test, first, second)
