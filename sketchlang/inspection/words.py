"""Witnesses as lines of text, and as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from sketchlang.analysis.words import listed
from sketchlang.inspection.witness import Element, FeatureWitness, Witness

NAMED = 8
"""Elements of a set that one line names; the others are counted."""

DEEP = 4
"""So many steps down a witness is told; the rest is in its data."""

INDENT = "    "


def value_text(value: Any) -> str:
    """A value as people read it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "{" + some_of(value) + "}" if value else "{}"
    return str(value)


def some_of(names: Sequence[str], shown: int = NAMED) -> str:
    """`a, b, c`, or the first of many and how many more there are."""
    if len(names) <= shown + 1:
        return ", ".join(names)
    return f"{', '.join(names[:shown])} and {len(names) - shown} more"


def feature_lines(feature: FeatureWitness) -> list[str]:
    """A feature, its value, its definition and why it has that value."""
    value = bool(feature.value) if feature.kind == "bool" else feature.value
    head = f"{feature.name} = {value_text(value)}"
    return [f"{head}   {feature.definition}", *_indented(_reasons(feature.because, DEEP))]


def _indented(lines: Iterator[str]) -> Iterator[str]:
    return (INDENT + line for line in lines)


def _reasons(witness: Witness, depth: int) -> Iterator[str]:
    """What is to be said below an expression whose text and value have been said."""
    if witness.kind in _QUANTIFIED:
        yield _QUANTIFIED[witness.kind](witness)
        for element in _worth_telling(witness):
            if depth > 1 and _is_compound(element.because):
                yield from _indented(_told(element.because, depth - 1))
        return
    for part in witness.parts:
        yield from _told(part, depth)


def _told(witness: Witness, depth: int) -> Iterator[str]:
    """An expression with its value, and why."""
    if witness.kind == "constant":
        return
    if witness.kind in _QUANTIFIED:
        yield f"{witness.text} is {value_text(witness.value)}"
        if depth > 1:
            yield from _indented(_reasons(witness, depth - 1))
        return
    yield _equation(witness)
    if depth > 1:
        for part in witness.parts:
            if _is_compound(part):
                yield from _indented(_told(part, depth - 1))


def _equation(witness: Witness) -> str:
    """`obstructions(bs4) + disturbances(bs4) = 0 + 1 = 1`, `distance(a) > 3 is true (distance(a)
    is 5)`."""
    value = value_text(witness.value)
    if witness.kind == "+":
        summands = " + ".join(value_text(part.value) for part in witness.parts)
        return f"{witness.text} = {summands} = {value}"
    operands = [p for p in witness.parts if p.kind not in ("constant", "variable")]
    if witness.kind == "=" and witness.value is True and len(operands) == 1:
        return f"{witness.text} is true"
    if witness.kind in ("=", "<", "<=", "in") and operands:
        told = [(operand.text, value_text(operand.value)) for operand in operands]
        known = [f"{text} is {shown}" for text, shown in told if text != shown]
        return f"{witness.text} is {value}" + (f" ({listed(known)})" if known else "")
    return f"{witness.text} is {value}"


def _is_compound(witness: Witness) -> bool:
    """Whether there is more to say than the value."""
    return bool(witness.parts or witness.kind in _QUANTIFIED)


def _worth_telling(witness: Witness) -> Sequence[Element]:
    """The elements whose own witnesses are told: the one that decides."""
    if witness.kind in ("some", "all", "min", "max"):
        return witness.elements[:1]
    return ()


def _those(witness: Witness, several: str) -> str:
    """What a quantifier looked at: `none of the 7 in objects`, where `several` begins so; where it
    is one element, `the only one in objects`."""
    where = "" if witness.where is None else f" where {witness.where}"
    if witness.considered == 1:
        return f"the only one in {witness.over}{where}"
    return f"{several} {witness.considered} in {witness.over}{where}"


def _nothing(witness: Witness) -> str | None:
    """What is said where a quantifier has nothing to look at."""
    if not witness.members:
        return f"there is nothing in {witness.over}"
    if witness.where is None or witness.considered:
        return None
    if witness.members == 1:
        return f"{witness.where} does not hold for the only one in {witness.over}"
    return f"{witness.where} holds for none of the {witness.members} in {witness.over}"


def _some(witness: Witness) -> str:
    if witness.elements:
        return f"it holds for {witness.elements[0].name}"
    verb = "does not hold" if witness.considered == 1 else "holds"
    return _nothing(witness) or f"it {verb} for {_those(witness, 'none of the')}"


def _all(witness: Witness) -> str:
    if witness.elements:
        return f"it fails for {witness.elements[0].name}"
    return _nothing(witness) or f"it holds for {_those(witness, 'all')}"


def _count(witness: Witness) -> str:
    if witness.elements:
        return f"counted: {some_of([element.name for element in witness.elements])}"
    nothing = "not " if witness.considered == 1 else ""
    return _nothing(witness) or nothing + _those(witness, "none of the")


def _sum(witness: Witness) -> str:
    if not witness.elements:
        return _nothing(witness) or f"0 for {_those(witness, 'each of the')}"
    parts = some_of([f"{element.name} {element.value}" for element in witness.elements])
    rest = witness.considered - len(witness.elements)
    return f"made of: {parts}" + (f"; 0 for {rest} more" if rest else "")


def _extreme(witness: Witness) -> str:
    word = "least" if witness.kind == "min" else "greatest"
    if witness.default:
        return f"{_nothing(witness)}, so it is {witness.value}"
    first, *others = witness.elements
    rest = some_of([f"{element.name} {element.value}" for element in others])
    return f"{word} for {first.name}" + (f"; others: {rest}" if rest else "")


_QUANTIFIED = {
    "some": _some,
    "all": _all,
    "count": _count,
    "sum": _sum,
    "min": _extreme,
    "max": _extreme,
}
"""The line about the elements of a quantifier."""


def as_data(witness: Witness) -> dict[str, Any]:
    """A witness as plain data: `expression`, `value`; `parts` and `elements` where it has them."""
    data: dict[str, Any] = {"expression": witness.text, "value": witness.value}
    if isinstance(witness.value, tuple):
        data["value"] = list(witness.value)
    if witness.kind in _QUANTIFIED:
        data |= {
            "quantifier": witness.kind,
            "members": witness.members,
            "considered": witness.considered,
            "elements": [
                {"element": e.name, "value": e.value, "because": as_data(e.because)}
                for e in witness.elements
            ],
        }
    if witness.parts:
        data["parts"] = [as_data(part) for part in witness.parts]
    return data
