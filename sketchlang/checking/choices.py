"""What a writer could have meant: functions of the domain, and those of other languages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sketchlang.checking.typed import Node
from sketchlang.domain import Function

MAX_LISTED = 8
"""Functions that one hint names."""

_COUNTING = {"len", "length", "size", "card", "cardinality", "number", "n_count", "numel"}
_TESTING = {"any", "exists", "some_of", "b_nonempty", "nonempty", "exist", "contains"}
_EMPTY = {"b_empty", "empty", "is_empty", "isempty", "none"}
_WORDS = {"True": "true", "TRUE": "true", "False": "false", "FALSE": "false"}
_ARITHMETIC = {"abs", "floor", "ceil", "round", "sqrt", "avg", "mean", "average", "pow", "mod"}


def foreign_function(name: str) -> str | None:
    """A hint for a function that other languages have."""
    if name in _COUNTING:
        return "Elements are counted by `count x in SET: true`, or with a condition for `true`."
    if name in _TESTING:
        return "Write `some x in SET: CONDITION`."
    if name in _EMPTY:
        return "Write `all x in SET: false`, or `not (some x in SET: CONDITION)`."
    if name in _WORDS:
        return f"Did you mean `{_WORDS[name]}`?"
    if name in _ARITHMETIC:
        return "There is no arithmetic but `+`: write a function of the domain for it."
    return None


def offered(domain: str, functions: Mapping[str, Function], sets: bool) -> str | None:
    """The functions of a domain that could stand in a place: sets, or all others."""
    ordered = sorted(functions.items())
    fitting = [one for _, one in ordered if one.result.is_set is sets]
    if not fitting:
        return None
    listed = ", ".join(f"`{one}`" for one in fitting[:MAX_LISTED])
    more = ", ..." if len(fitting) > MAX_LISTED else "."
    what = "Sets" if sets else "Functions"
    return f"{what} of {domain}: {listed}{more}"


def signature(function: Function, functions: Mapping[str, Function], given: Sequence[Node]) -> str:
    """What a function takes, and how an element comes to it that was left out."""
    name = function.name
    hint = f"It is `{function}`."
    if given or len(function.parameters) != 1:
        return hint
    sort = function.parameters[0]
    over = [
        one.name
        for one in functions.values()
        if not one.parameters and one.result.is_set and one.result.element == sort
    ]
    return f"{hint} Write for example `some x in {over[0]}: {name}(x)`." if over else hint
