"""What the names in a sketch stand for, and where each of them stands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from sketchlang.source import Source, Span
from sketchlang.syntax import tree


@dataclass(frozen=True, slots=True)
class Target:
    """What a name stands for. `kind` is one of `feature define rule variable parameter function
    sort domain atoms sketch include`; `place` tells local names of the same spelling apart."""

    kind: str
    name: str
    place: tuple[str, int] | None = None


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A name in a file: its place, what it stands for, and whether it is declared there.

    `item` is the item that it stands in, `set` what a variable ranges over.
    """

    source: Source
    span: Span
    target: Target
    declares: bool
    item: tree.Item
    over: tree.Expr | None = None


Scope = Mapping[str, tuple[Target, tree.Expr | None]]


def occurrences(main: tree.Tree) -> list[Occurrence]:
    """All names of a sketch and of the files that it includes."""
    files = list(_files(main, set()))
    declared = dict(entry for file in files for entry in _declared(file))
    return [one for file in files for one in _in_file(file, declared)]


def at(found: list[Occurrence], file: str, offset: int) -> Occurrence | None:
    """The name at a place in a file, or just before it."""
    here = [one for one in found if one.source.name == file]
    for one in here:
        if one.span.start <= offset <= one.span.end:
            return one
    return None


def _files(main: tree.Tree, seen: set[str]) -> Iterator[tree.Tree]:
    if main.source.name in seen:
        return
    seen.add(main.source.name)
    yield main
    for item in main.items:
        if isinstance(item, tree.Include) and item.tree is not None:
            yield from _files(item.tree, seen)


def _declared(file: tree.Tree) -> Iterator[tuple[str, Target]]:
    for item in file.items:
        match item:
            case tree.FeatureItem(name):
                yield name.text, Target("feature", name.text)
            case tree.Define(name):
                yield name.text, Target("define", name.text)
            case tree.Broken(keyword, tree.Name(text)) if keyword in ("feature", "define"):
                yield text, Target(keyword, text)


def _in_file(file: tree.Tree, declared: Mapping[str, Target]) -> Iterator[Occurrence]:
    walk = _Walk(file.source, declared)
    for item in file.items:
        yield from walk.item(item)


@dataclass(frozen=True, slots=True)
class _Walk:
    source: Source
    declared: Mapping[str, Target]

    def item(self, item: tree.Item) -> Iterator[Occurrence]:
        match item:
            case tree.Title(name):
                yield self._one(name, Target("sketch", name.text), item, True)
            case tree.Use(name):
                yield self._one(name, Target("domain", name.text), item)
            case tree.Include(target, _, place):
                yield Occurrence(self.source, place, Target("include", target), False, item)
            case tree.FeatureItem(name):
                yield self._one(name, Target("feature", name.text), item, True)
                if item.definition is not None:
                    yield from self._expr(item.definition, {}, item)
            case tree.Define():
                yield from self._define(item)
            case tree.InvariantItem(formula):
                yield from self._expr(formula, {}, item)
            case tree.Atoms(names):
                for name in names:
                    yield self._one(name, Target("atoms", name.text), item)
            case tree.Goal(block):
                yield from self._block(block, item)
            case tree.RuleItem(name, conditions, effects):
                yield self._one(name, Target("rule", name.text), item, True)
                yield from self._block(conditions, item)
                yield from self._block(effects, item)

    def _one(
        self, name: tree.Name, target: Target, item: tree.Item, declares: bool = False
    ) -> Occurrence:
        return Occurrence(self.source, name.span, target, declares, item)

    def _block(self, block: tree.Block, item: tree.Item) -> Iterator[Occurrence]:
        for literal in block.literals:
            name = literal.name
            target = self.declared.get(name.text, Target("feature", name.text))
            yield self._one(name, target, item)

    def _define(self, item: tree.Define) -> Iterator[Occurrence]:
        yield self._one(item.name, Target("define", item.name.text), item, True)
        scope: dict[str, tuple[Target, tree.Expr | None]] = {}
        for parameter in item.parameters:
            name = parameter.name
            target = Target("parameter", name.text, (self.source.name, name.span.start))
            scope[name.text] = target, None
            yield self._one(name, target, item, True)
            if parameter.type.text not in ("bool", "nat"):
                sort = Target("sort", parameter.type.text)
                yield self._one(parameter.type, sort, item)
        yield from self._expr(item.body, scope, item)

    def _expr(self, expr: tree.Expr, scope: Scope, item: tree.Item) -> Iterator[Occurrence]:
        if isinstance(expr, tree.Call):
            name = expr.name
            local = scope.get(name.text)
            target, over = local if local is not None else (self._global(name.text), None)
            yield Occurrence(self.source, name.span, target, False, item, over)
        variable = getattr(expr, "variable", None)
        if not isinstance(variable, tree.Name):
            for part in tree.operands(expr):
                yield from self._expr(part, scope, item)
            return
        over = getattr(expr, "domain", None)
        target = Target("variable", variable.text, (self.source.name, variable.span.start))
        yield Occurrence(self.source, variable.span, target, True, item, over)
        inner = {**scope, variable.text: (target, over)}
        outside = (over, getattr(expr, "default", None))
        for part in tree.operands(expr):
            yield from self._expr(part, scope if part in outside else inner, item)

    def _global(self, name: str) -> Target:
        return self.declared.get(name, Target("function", name))
