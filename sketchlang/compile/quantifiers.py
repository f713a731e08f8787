"""The loops: one closure for each quantifier, with and without `where`.

Every loop puts its variable's former value back: a definition that is used inside a
quantifier may have a variable of the same level.
"""

# ruff: noqa: B020 (`for frame[slot] in ...` assigns to a place in the list, not to its name)
from __future__ import annotations

from typing import Any

from sketchlang.compile.seam import Frame, Run


def quantifier(
    kind: str, slot: int, over: Run, *, condition: Run | None, body: Run, default: Run | None
) -> Run:
    """The closure of `kind x in over where condition: body default default`."""
    match kind:
        case "some":
            return _search(slot, over, condition, body, True)
        case "all":
            return _search(slot, over, condition, body, False)
        case "count":
            return _count(slot, over, condition, body)
        case "sum":
            return _sum(slot, over, condition, body)
        case "min":
            return _least(slot, over, condition, body, default)
        case _:
            values = _values(slot, over, condition, body)
            return _greatest(slot, values, default)


def _search(slot: int, over: Run, condition: Run | None, body: Run, wanted: bool) -> Run:
    """Is there an element for which the body is `wanted`?  `all` looks for a false one."""
    other = not wanted

    if condition is None:

        def run(frame: Frame) -> Any:
            outer = frame[slot]
            for frame[slot] in over(frame):
                if body(frame) == wanted:
                    frame[slot] = outer
                    return wanted
            frame[slot] = outer
            return other

    else:

        def run(frame: Frame) -> Any:
            outer = frame[slot]
            for frame[slot] in over(frame):
                if condition(frame) and body(frame) == wanted:
                    frame[slot] = outer
                    return wanted
            frame[slot] = outer
            return other

    return run


def _count(slot: int, over: Run, condition: Run | None, body: Run) -> Run:
    if condition is None:

        def run(frame: Frame) -> Any:
            outer = frame[slot]
            number = 0
            for frame[slot] in over(frame):
                if body(frame):
                    number += 1
            frame[slot] = outer
            return number

    else:

        def run(frame: Frame) -> Any:
            outer = frame[slot]
            number = 0
            for frame[slot] in over(frame):
                if condition(frame) and body(frame):
                    number += 1
            frame[slot] = outer
            return number

    return run


def _sum(slot: int, over: Run, condition: Run | None, body: Run) -> Run:
    if condition is None:

        def run(frame: Frame) -> Any:
            outer = frame[slot]
            total = 0
            for frame[slot] in over(frame):
                total += body(frame)
            frame[slot] = outer
            return total

    else:

        def run(frame: Frame) -> Any:
            outer = frame[slot]
            total = 0
            for frame[slot] in over(frame):
                if condition(frame):
                    total += body(frame)
            frame[slot] = outer
            return total

    return run


def _values(slot: int, over: Run, condition: Run | None, body: Run) -> Run:
    """The list of the body's values."""
    if condition is None:

        def run(frame: Frame) -> Any:
            found = []
            for frame[slot] in over(frame):
                found.append(body(frame))
            return found

    else:

        def run(frame: Frame) -> Any:
            found = []
            for frame[slot] in over(frame):
                if condition(frame):
                    found.append(body(frame))
            return found

    return run


def _least(slot: int, over: Run, condition: Run | None, body: Run, default: Run | None) -> Run:
    """Minimum; over no elements the default, and 0 without one.

    No value is less than 0, so the first 0 ends the loop: values can be costly.
    """
    holds = condition or (lambda _: True)

    def run(frame: Frame) -> Any:
        outer = frame[slot]
        least = None
        for frame[slot] in over(frame):
            if holds(frame):
                value = body(frame)
                if least is None or value < least:
                    least = value
                    if least == 0:
                        break
        frame[slot] = outer
        if least is not None:
            return least
        return default(frame) if default is not None else 0

    return run


def _greatest(slot: int, values: Run, default: Run | None) -> Run:
    """Maximum; over no elements the default, and 0 without one."""

    def run(frame: Frame) -> Any:
        outer = frame[slot]
        found = values(frame)
        frame[slot] = outer
        if found:
            return max(found)
        return default(frame) if default is not None else 0

    return run
