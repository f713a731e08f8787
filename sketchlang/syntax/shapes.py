"""Whole rules and goals that have everything they need, in another shape.

`rule r: n > 0 -> n--`, `if n > 0 then n--` and `goal: n = 0` are put into braces; whether the
result is right, the parser has to say.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

_INSIDE = r"[^{}\[\]()⟨⟩]*?"
_OPEN, _CLOSE = r"\s*[\[({⟨]?", r"[\])}⟩]?\s*"
_ARROW = r"(?:[-−–—=|]{1,3}>|→|↦|⇒|⟹|⟶|⟼|<-+|\bthen\b:?|\bimplies\b|(?<=[\])}⟩]))"
_IF = r"(?:\b(?:if|when|given|from|pre|precondition|conditions?)\b\s*:?)?"
_END = r"\s*[;.]?\s*$"
_NAME = r"[\"'“]?(?!if\b|when\b|rule\b)(?P<name>[\w-]+)[\"'”]?"
_BODIES = rf"{_OPEN}(?P<c>{_INSIDE}){_CLOSE}{_ARROW}{_OPEN}(?P<e>{_INSIDE}){_CLOSE}{_END}"
_RULES = [
    re.compile(rf"(?:rule\b)?\s*:?\s*{_NAME}\s*[:=]?\s*{_IF}{_BODIES}"),
    re.compile(rf"(?:rule\b)?\s*[:=]?\s*{_IF}{_BODIES}"),
    re.compile(rf"(?:rule\b\s*{_NAME}\s*)?:?\s*if\b(?P<c>[^:{{}}]*):(?P<e>{_INSIDE}){_END}"),
]
_SPACE = re.compile(r"\s+")
_GOAL = re.compile(rf"goals?\s*[:=]?{_OPEN}(?P<c>{_INSIDE}){_CLOSE}{_END}")


def rules(text: str) -> Iterator[str]:
    """Rules that a text may be meant for, in the shape of the language."""
    text = _SPACE.sub(_shortened, text)
    for pattern in _RULES:
        match = pattern.match(text)
        if match and match["e"].strip():
            conditions, effects = _literals(match["c"]), _literals(match["e"])
            yield f"rule {_name(match.groupdict().get('name'))} {conditions} -> {effects}"


def goals(text: str) -> Iterator[str]:
    """The same for goals."""
    match = _GOAL.match(_SPACE.sub(_shortened, text))
    if match and match["c"].strip():
        yield f"goal {_literals(match['c'])}"


def _shortened(space: re.Match[str]) -> str:
    # Long runs of space would take the patterns a time with a power of their length.
    return "\n" if "\n" in space[0] else " "


def _literals(text: str) -> str:
    text = re.sub(r"[\"'“”]", "", text)
    text = re.sub(r"(\w) ?: ?(\d)", r"\1 = \2", text)
    parts = re.split(r"[,;\n]|&&?|∧|\band\b", text)
    words = [" ".join(part.replace("==", "=").strip().removeprefix("- ").split()) for part in parts]
    listed = ", ".join(word for word in words if word)
    return "{}" if listed in ("", "true", "True", "⊤", "*") else f"{{ {listed} }}"


def _name(name: str | None) -> str:
    if name is None:
        return "NAME"
    spelled = re.sub(r"\W", "_", name)
    return f"r{spelled}" if spelled[0].isdigit() else spelled
