"""Changes of a sketch as edits of its text: only what changes is touched."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from sketchlang.analysis.changes import (
    Assume,
    Bound,
    Change,
    LeaveOut,
    Require,
    Tighten,
    invariant_text,
)
from sketchlang.analysis.words import effect, literal
from sketchlang.model import SketchModel
from sketchlang.source import Source, Span
from sketchlang.syntax import tree


class Edit(NamedTuple):
    """Text to put in place of a span of a source."""

    source: Source
    span: Span
    text: str


def edits(parsed: tree.Tree, model: SketchModel, changes: Iterable[Change]) -> list[Edit]:
    """The edits that make changes, wherever the rule or feature is declared."""
    items = list(_items(parsed))
    rules = {item.name.text: (s, item) for s, item in items if isinstance(item, tree.RuleItem)}
    features = {
        item.name.text: (s, item) for s, item in items if isinstance(item, tree.FeatureItem)
    }
    result: list[Edit] = []
    dropped: dict[str, list[int]] = {}
    added: dict[str, list[str]] = {}
    for change in changes:
        match change:
            case Bound(feature):
                source, declared = features[model.features[feature].name]
                result.append(_before(source, declared.span, "bounded "))
            case Assume():
                result.append(_invariant(parsed, invariant_text(model, change)))
            case LeaveOut(rule):
                source, item = rules[model.rules[rule].name]
                result.append(Edit(source, _whole_lines(source, item.span), ""))
            case Require(rule, feature, positive):
                added.setdefault(model.rules[rule].name, []).append(
                    literal(model, feature, positive)
                )
            case Tighten(rule, feature, None):
                dropped.setdefault(model.rules[rule].name, []).append(feature)
            case Tighten(rule, feature, instead):
                assert instead is not None
                source, item = rules[model.rules[rule].name]
                old = _literal(item.effects, model.features[feature].name)
                result.append(Edit(source, old.span, effect(model, feature, instead)))
    for name, literals in added.items():
        source, item = rules[name]
        result.append(_more(source, item.conditions, literals))
    for name, gone in dropped.items():
        source, item = rules[name]
        names = {model.features[feature].name for feature in gone}
        result += _fewer(source, item.effects, names)
    return result


def applied(changes: Sequence[Edit]) -> Mapping[str, tuple[Source, str]]:
    """By name of the source: the source, and its text with the edits made."""
    texts: dict[str, tuple[Source, str]] = {}
    for edit in sorted(changes, key=lambda e: (e.span.start, e.span.end), reverse=True):
        source, text = texts.get(edit.source.name, (edit.source, edit.source.text))
        text = text[: edit.span.start] + edit.text + text[edit.span.end :]
        texts[edit.source.name] = (source, text)
    return texts


def _items(parsed: tree.Tree) -> Iterator[tuple[Source, object]]:
    for item in parsed.items:
        if isinstance(item, tree.Include) and item.tree is not None:
            yield from _items(item.tree)
        else:
            yield parsed.source, item


def _before(source: Source, span: Span, text: str) -> Edit:
    return Edit(source, Span(span.start, span.start), text)


def _literal(block: tree.Block, name: str) -> tree.Literal:
    return next(literal for literal in block.literals if literal.name.text == name)


def _more(source: Source, block: tree.Block, literals: Sequence[str]) -> Edit:
    """Literals behind those that a block has."""
    text = ", ".join(literals)
    if block.literals:
        end = block.literals[-1].span.end
        return Edit(source, Span(end, end), f", {text}")
    return Edit(source, block.span, f"{{ {text} }}")


def _fewer(source: Source, block: tree.Block, names: set[str]) -> list[Edit]:
    """A block without the literals of some features, each with the comma next to it."""
    kept = [literal for literal in block.literals if literal.name.text not in names]
    if not kept:
        return [Edit(source, block.span, "{ }")]
    result = []
    for number, one in enumerate(block.literals):
        if one.name.text not in names:
            continue
        if any(earlier in kept for earlier in block.literals[:number]):
            span = Span(block.literals[number - 1].span.end, one.span.end)
        else:
            span = Span(one.span.start, block.literals[number + 1].span.start)
        result.append(Edit(source, span, ""))
    return result


def _invariant(parsed: tree.Tree, formula: str) -> Edit:
    """A line behind the last invariant, or before the first rule, or at the end."""
    source = parsed.source
    invariants = [item for item in parsed.items if isinstance(item, tree.InvariantItem)]
    rules = [item for item in parsed.items if isinstance(item, tree.RuleItem)]
    if invariants:
        end = invariants[-1].span.end
        return Edit(source, Span(end, end), f"\ninvariant {formula}")
    if rules:
        return _before(source, rules[0].span, f"invariant {formula}\n\n")
    end = len(source.text)
    return Edit(source, Span(end, end), f"\ninvariant {formula}\n")


def _whole_lines(source: Source, span: Span) -> Span:
    """The span with the rest of its lines, if nothing else stands there."""
    text = source.text
    start = text.rfind("\n", 0, span.start) + 1
    end = text.find("\n", span.end)
    end = len(text) if end < 0 else end + 1
    alone = not text[start : span.start].strip() and not text[span.end : end].strip()
    return Span(start, end) if alone else span
