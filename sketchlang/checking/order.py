"""Which definitions use which: an order to work in, and circles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from sketchlang.syntax import tree


def names_in(expr: tree.Expr, bound: frozenset[str]) -> Iterator[str]:
    """The names that an expression uses, its own variables and `bound` left out."""
    if isinstance(expr, tree.Call) and expr.name.text not in bound:
        yield expr.name.text
    if isinstance(expr, tree.Quantifier):
        yield from names_in(expr.domain, bound)
        if expr.default is not None:
            yield from names_in(expr.default, bound)
        inner = bound | {expr.variable.text}
        if expr.condition is not None:
            yield from names_in(expr.condition, inner)
        yield from names_in(expr.body, inner)
    elif isinstance(expr, tree.Comprehension):
        inner = bound
        for binder in expr.binders:
            yield from names_in(binder.domain, inner)
            inner = inner | {binder.variable.text}
        if expr.condition is not None:
            yield from names_in(expr.condition, inner)
    else:
        for part in tree.operands(expr):
            yield from names_in(part, bound)


def order(uses: Mapping[str, list[str]]) -> tuple[list[str], list[list[str]]]:
    """Names with the used before their users, and the circles found on the way.

    Every circle is listed from the name that was met first. No recursion: a file may have
    thousands of definitions in one chain.
    """
    done: dict[str, bool] = {}
    ordered: list[str] = []
    circles: list[list[str]] = []
    for start in uses:
        if start in done:
            continue
        path = [start]
        done[start] = False
        todo = [iter(uses[start])]
        while todo:
            for name in todo[-1]:
                if name not in uses:
                    continue
                if name not in done:
                    path.append(name)
                    done[name] = False
                    todo.append(iter(uses[name]))
                    break
                if not done[name]:
                    circles.append(path[path.index(name) :])
            else:
                done[path[-1]] = True
                ordered.append(path.pop())
                todo.pop()
    return ordered, circles
