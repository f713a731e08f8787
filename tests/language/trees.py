"""Random syntax trees, and trees without their places."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from hypothesis import strategies as st

from sketchlang.source import Source, Span
from sketchlang.syntax import tree
from sketchlang.syntax.grammar import words

HERE = Span(0, 0)

spelled = st.from_regex(r"[a-zA-Z_][a-z0-9_]{0,6}", fullmatch=True).filter(
    lambda word: word not in words()
)
names = spelled.map(lambda word: tree.Name(word, HERE))
numbers = st.integers(0, 10**9)


def _calls(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[tree.Call]:
    return st.builds(tree.Call, names, st.lists(inner, max_size=3).map(tuple), st.just(HERE))


def _operations(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[tree.Operation]:
    many = st.builds(
        tree.Operation,
        st.sampled_from(["or", "and", "+"]),
        st.lists(inner, min_size=2, max_size=4).map(tuple),
        st.just(HERE),
    )
    two = st.builds(
        lambda a, b: tree.Operation("->", (a, b), HERE),
        inner,
        inner,
    )
    sets = st.builds(
        lambda sign, a, b: tree.Operation(sign, (a, b), HERE),
        st.sampled_from(["|", "-", "&"]),
        inner,
        inner,
    )
    return many | two | sets | inner.map(lambda a: tree.Operation("not", (a,), HERE))


def _extend(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    comparisons = st.builds(
        tree.Comparison,
        inner,
        st.sampled_from(["=", "!=", "<", "<=", ">", ">=", "in"]),
        inner,
        st.just(HERE),
    )
    quantifiers = st.builds(
        tree.Quantifier,
        st.sampled_from(["some", "all", "count", "sum", "min", "max"]),
        names,
        inner,
        st.none() | inner,
        inner,
        st.none() | inner,
        st.just(HERE),
    )
    return _calls(inner) | _operations(inner) | comparisons | quantifiers | _sets(inner)


def _sets(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    goals = st.builds(tree.GoalAtom, _calls(inner), st.just(HERE))
    closures = st.builds(tree.Closure, inner, st.sampled_from("+*"), st.just(HERE))
    applied = st.builds(
        tree.Apply, closures, st.lists(inner, min_size=2, max_size=2).map(tuple), st.just(HERE)
    )
    binders = st.builds(tree.Binder, names, inner, st.just(HERE))
    comprehensions = st.builds(
        tree.Comprehension,
        st.lists(binders, min_size=1, max_size=2).map(tuple),
        st.none() | inner,
        st.just(HERE),
    )
    listings = st.builds(
        tree.Listing, st.lists(inner, min_size=1, max_size=3).map(tuple), st.just(HERE)
    )
    conditionals = st.builds(tree.Conditional, inner, inner, inner, st.just(HERE))
    return goals | closures | applied | comprehensions | listings | conditionals


expressions: st.SearchStrategy[tree.Expr] = st.recursive(
    st.builds(tree.Number, numbers, st.just(HERE))
    | st.builds(tree.Truth, st.booleans(), st.just(HERE))
    | st.builds(tree.Call, names, st.just(()), st.just(HERE)),
    _extend,
    max_leaves=25,
)


@st.composite
def literals(draw: st.DrawFn) -> tree.Literal:
    """A literal with any sign."""
    sign = draw(st.sampled_from(["", "--", "++", "?", "=", "!=", "<", "<=", ">", ">="]))
    number = draw(numbers) if sign and sign[0] in "=!<>" else None
    return tree.Literal(draw(names), draw(st.booleans()), sign, number, HERE)


blocks = st.builds(tree.Block, st.lists(literals(), max_size=12).map(tuple), st.just(HERE))
parameters = st.builds(
    tree.Parameter,
    names,
    names | st.sampled_from(["bool", "nat"]).map(lambda word: tree.Name(word, HERE)),
    st.just(HERE),
)
items: st.SearchStrategy[tree.Item] = st.one_of(
    st.builds(tree.Title, names, st.just(HERE)),
    st.builds(tree.Use, names, st.just(HERE)),
    st.builds(
        lambda text: tree.Include(text, True, HERE, HERE),
        st.text(
            # What cannot be seen is an error of its own.
            alphabet=st.characters(
                codec="utf-8",
                exclude_characters='"',
                exclude_categories=["Cc", "Cf", "Zs", "Zl", "Zp"],
            ),
            max_size=9,
        ),
    ),
    st.builds(lambda name: tree.Include(name, False, HERE, HERE), spelled),
    st.builds(
        tree.FeatureItem,
        names,
        st.sampled_from(["bool", "nat"]),
        st.booleans(),
        st.none() | expressions,
        st.just(HERE),
    ),
    st.builds(
        tree.Define, names, st.lists(parameters, max_size=3).map(tuple), expressions, st.just(HERE)
    ),
    st.builds(tree.InvariantItem, expressions, st.just(HERE)),
    st.builds(tree.Atoms, st.lists(names, min_size=1, max_size=20).map(tuple), st.just(HERE)),
    st.builds(tree.Goal, blocks, st.just(HERE)),
    st.builds(tree.RuleItem, names, blocks, blocks, st.just(HERE)),
)


def bare(node: Any) -> Any:
    """A node as nested tuples, without spans: equal for trees that mean the same."""
    if isinstance(node, Span | Source):
        return None
    if isinstance(node, tuple | list):
        return tuple(map(bare, node))
    if is_dataclass(node) and not isinstance(node, type):
        parts = [bare(getattr(node, field.name)) for field in fields(node)]
        return (type(node).__name__, *parts)
    return node
