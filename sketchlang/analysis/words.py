"""Names and valuations as the language writes them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from sketchlang.analysis.bits import members
from sketchlang.model import Effect, Kind, Rule, SketchModel
from sketchlang.source import Span

Position = Callable[[Rule, Span | None], str]
"""Says where a rule, or a part of it, was written: `file:line:column`."""

_SIGNS = {
    Effect.SET: "{}",
    Effect.CLEAR: "!{}",
    Effect.DEC: "{}--",
    Effect.INC: "{}++",
    Effect.NOT_INC: "!{}++",
    Effect.NOT_DEC: "!{}--",
    Effect.ANY: "{}?",
}


def literal(model: SketchModel, feature: int, positive: bool) -> str:
    """`p`, `!p`, `n > 0` or `n = 0`."""
    declared = model.features[feature]
    if declared.kind is Kind.BOOL:
        return declared.name if positive else f"!{declared.name}"
    return f"{declared.name} > 0" if positive else f"{declared.name} = 0"


def cube(model: SketchModel, known: int, bits: int) -> str:
    """The valuations that agree with `bits` in the features of the mask `known`."""
    literals = ", ".join(literal(model, f, bool(bits >> f & 1)) for f in members(known))
    return f"{{{literals}}}"


def effect(model: SketchModel, feature: int, kind: Effect) -> str:
    """`n--`, `!p`, ... as an effect is written."""
    return _SIGNS[kind].format(model.features[feature].name)


def rule_names(model: SketchModel, rules: Iterable[int]) -> list[str]:
    return [model.rules[rule].name for rule in rules]


def listed(words: Sequence[str], last: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"


def counted(number: int, noun: str, plural: str | None = None) -> str:
    """A number and its noun, in the plural where that is due."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"
