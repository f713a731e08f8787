"""What a sketch and the files that it includes declare, with every name once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from sketchlang.checking.report import Report
from sketchlang.diagnostics import Label
from sketchlang.source import Source, Span
from sketchlang.syntax import tree

T = TypeVar("T")
NamedItem = tree.FeatureItem | tree.Define | tree.RuleItem | tree.Broken


@dataclass(frozen=True, slots=True)
class Placed(Generic[T]):
    """An item, the file it stands in, and whether that file is included by another one."""

    item: T
    source: Source
    included: bool

    def label(self, span: Span, text: str = "") -> Label:
        """A place in the item's file."""
        return Label(self.source, span, text)


@dataclass
class Declarations:
    """The items of a sketch by kind, in the order of the text, duplicates left out.

    `broken` are the names that items with a syntax error would declare.
    """

    title: Placed[tree.Title] | None = None
    use: Placed[tree.Use] | None = None
    goal: Placed[tree.Goal] | None = None
    features: dict[str, Placed[tree.FeatureItem]] = field(default_factory=dict)
    defines: dict[str, Placed[tree.Define]] = field(default_factory=dict)
    rules: dict[str, Placed[tree.RuleItem]] = field(default_factory=dict)
    invariants: list[Placed[tree.InvariantItem]] = field(default_factory=list)
    atoms: list[Placed[tree.Atoms]] = field(default_factory=list)
    broken: set[str] = field(default_factory=set)
    broken_items: set[str] = field(default_factory=set)
    incomplete: bool = False


def collect(main: tree.Tree, report: Report) -> Declarations:
    """Gather the items of a tree and of all trees that it includes."""
    found = Declarations()
    for placed in _placed(main, False, {main.source.name}):
        _declare(placed, found, report)
    return found


def _placed(file: tree.Tree, included: bool, seen: set[str]) -> Iterator[Placed[tree.Item]]:
    """All items, those of an included file in the place of the `include`.

    A file that is included on two ways counts once.
    """
    for item in file.items:
        if isinstance(item, tree.Include) and item.tree is not None:
            if item.tree.source.name not in seen:
                seen.add(item.tree.source.name)
                yield from _placed(item.tree, True, seen)
        else:
            yield Placed(item, file.source, included)


def _declare(placed: Placed[tree.Item], found: Declarations, report: Report) -> None:
    item, source, included = placed.item, placed.source, placed.included
    match item:
        case tree.Title() | tree.Use() | tree.Goal():
            _once(placed, found, report)
        case tree.InvariantItem():
            found.invariants.append(Placed(item, source, included))
        case tree.Atoms():
            found.atoms.append(Placed(item, source, included))
        case tree.FeatureItem():
            _name(Placed(item, source, included), found, report)
        case tree.Define():
            _name(Placed(item, source, included), found, report)
        case tree.RuleItem():
            rule = Placed(item, source, included)
            first = found.rules.setdefault(item.name.text, rule)
            if first is not rule:
                what = f"rule `{item.name.text}`"
                _duplicate("duplicate-rule", what, rule, first, report)
        case tree.Include():
            found.incomplete = True
        case tree.Broken():
            found.broken_items.add(item.keyword)
            if item.name is not None:
                found.broken.add(item.name.text)
            elif item.keyword in ("feature", "define", ""):
                found.incomplete = True


def _once(placed: Placed[tree.Item], found: Declarations, report: Report) -> None:
    """Items that a sketch has at most one of."""
    item, source, included = placed.item, placed.source, placed.included
    match item:
        # An included sketch keeps its title to itself.
        case tree.Title() if not included:
            title = Placed(item, source, included)
            if found.title is None:
                found.title = title
            else:
                _twice("duplicate-title", "the title", title, found.title, report)
        case tree.Use():
            use = Placed(item, source, included)
            if found.use is None:
                found.use = use
            elif found.use.item.name.text != item.name.text or found.use.source is source:
                _twice("duplicate-use", "`use`", use, found.use, report)
        case tree.Goal():
            goal = Placed(item, source, included)
            if found.goal is None:
                found.goal = goal
            else:
                _twice("duplicate-goal", "the goal", goal, found.goal, report)


def _name(
    new: Placed[tree.FeatureItem] | Placed[tree.Define], found: Declarations, report: Report
) -> None:
    """Features and definitions share one set of names: expressions use both."""
    name = new.item.name.text
    first = found.features.get(name) or found.defines.get(name)
    if first is not None:
        both_features = isinstance(new.item, tree.FeatureItem) and name in found.features
        code = "duplicate-feature" if both_features else "duplicate-define"
        _duplicate(code, f"`{name}`", new, first, report)
    elif isinstance(new.item, tree.FeatureItem):
        found.features[name] = Placed(new.item, new.source, new.included)
    else:
        found.defines[name] = Placed(new.item, new.source, new.included)


def _duplicate(
    code: str,
    what: str,
    new: Placed[tree.FeatureItem] | Placed[tree.Define] | Placed[tree.RuleItem],
    first: Placed[tree.FeatureItem] | Placed[tree.Define] | Placed[tree.RuleItem],
    report: Report,
) -> None:
    report.add(
        code,
        f"{what} is declared twice",
        new.label(new.item.name.span),
        first.label(first.item.name.span, "first declared here"),
        hint="Rename or remove one of them.",
    )


def _twice(
    code: str,
    what: str,
    new: Placed[tree.Title] | Placed[tree.Use] | Placed[tree.Goal],
    first: Placed[tree.Title] | Placed[tree.Use] | Placed[tree.Goal],
    report: Report,
) -> None:
    report.add(
        code,
        f"{what} is given twice",
        new.label(new.item.span),
        first.label(first.item.span, "first given here"),
        hint="Remove one of them.",
    )
