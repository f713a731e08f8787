"""The seam between a sketch and its domain: calls whose results are looked at."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from typing import Any

from sketchlang.compile.errors import BrokenPromiseError, shown
from sketchlang.domain import Domain, Function
from sketchlang.types import BOOL, NAT

Frame = list[Any]
Run = Callable[[Frame], Any]


@dataclass(frozen=True, slots=True)
class Call:
    """A call of a domain function. `slots[i]` is where argument i lies in the frame if it is
    a variable; `text` is the call as its author wrote it."""

    function: Function
    arguments: tuple[Run, ...]
    slots: tuple[int | None, ...]
    text: str
    domain: Domain

    def broken(self, frame: Frame, reason: str | None) -> BrokenPromiseError:
        """What to raise for a result that cannot be used."""
        name = self.function.name
        given = ", ".join(shown(argument(frame)) for argument in self.arguments)
        called = f"{name}({given})" if given else name
        return BrokenPromiseError(f"{called} {reason}", self.text, name, self.function.position)

    def raised(self, frame: Frame, error: Exception) -> BrokenPromiseError:
        """What to raise for an exception."""
        words = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        return self.broken(frame, f"raised {words}")


def compiled(call: Call) -> Run:
    """The closure for a call. The shapes that features are full of, a truth value or a number
    of one variable, have closures of their own: what is written out there need not be decided
    again in every state."""
    result = call.function.result
    if len(call.slots) == 1 and call.slots[0] is not None and result in (BOOL, NAT):
        return _unary(call, call.slots[0], result == BOOL)
    return _general(call)


def _unary(call: Call, slot: int, truth: bool) -> Run:
    target, broken, raised = call.function.call, call.broken, call.raised

    if truth:

        def run(frame: Frame) -> Any:
            try:
                value = target(frame[0], frame[slot])
            except Exception as error:
                raise raised(frame, error) from error
            if value is True or value is False:
                return value
            raise broken(frame, _check_bool(value))

    else:

        def run(frame: Frame) -> Any:
            try:
                value = target(frame[0], frame[slot])
            except Exception as error:
                raise raised(frame, error) from error
            if type(value) is int and value >= 0:
                return value
            raise broken(frame, _check_nat(value))

    return run


def remembered(call: Call, place: int) -> Run | None:
    """The closure of a truth value or number of one variable with the memory built in, which
    is a dictionary at `place`; None for other calls."""
    result = call.function.result
    if len(call.slots) != 1 or call.slots[0] is None or result not in (BOOL, NAT):
        return None
    slot = call.slots[0]
    target, broken, raised = call.function.call, call.broken, call.raised
    truth = result == BOOL

    def run(frame: Frame) -> Any:
        key = frame[slot]
        value = frame[place].get(key)
        if value is None:
            try:
                value = target(frame[0], key)
            except Exception as error:
                raise raised(frame, error) from error
            if truth:
                if value is not True and value is not False:
                    raise broken(frame, _check_bool(value))
            elif type(value) is not int or value < 0:
                raise broken(frame, _check_nat(value))
            frame[place][key] = value
        return value

    return run


def _general(call: Call) -> Run:
    target, broken, raised = call.function.call, call.broken, call.raised
    arguments, check = call.arguments, check_for(call.function, call.domain)

    def run(frame: Frame) -> Any:
        given = [argument(frame) for argument in arguments]
        try:
            value = target(frame[0], *given)
        except Exception as error:
            raise raised(frame, error) from error
        wrong = check(value)
        if wrong:
            raise broken(frame, wrong)
        return value

    return run


def careful(call: Call) -> Run:
    """The closure that makes a call twice and expects equal results.

    This finds functions whose result does not follow from state and arguments. It is done
    for some states only.
    """
    target, arguments = call.function.call, call.arguments
    check, many = check_for(call.function, call.domain), call.function.result.is_set

    def run(frame: Frame) -> Any:
        given = [argument(frame) for argument in arguments]
        results = []
        for _ in range(2):
            try:
                results.append(target(frame[0], *given))
            except Exception as error:
                raise call.raised(frame, error) from error
            wrong = check(results[-1])
            if wrong:
                raise call.broken(frame, wrong)
        first, second = results
        if (frozenset(first) != frozenset(second)) if many else (first != second):
            reason = f"returned {shown(first)}, then {shown(second)} for the same state"
            raise call.broken(frame, reason)
        return first

    return run


def check_for(function: Function, domain: Domain) -> Callable[[Any], str | None]:
    """What is wrong with a result of this function: a sentence without subject, or None."""
    result = function.result
    if result == BOOL:
        return _check_bool
    if result == NAT:
        return _check_nat
    cls = domain.sorts[result.name]
    if result.is_set:
        return _set_check(result.name, cls)

    def check(value: Any) -> str | None:
        if isinstance(value, cls):
            return None
        return f"returned {shown(value)}, expected an instance of sort {result.name}"

    return check


def _kind(value: object) -> str:
    cls = type(value)
    module = "" if cls.__module__ == "builtins" else f"{cls.__module__}."
    return module + cls.__qualname__


def _check_bool(value: Any) -> str | None:
    if value is True or value is False:
        return None
    return f"returned {shown(value)} of type {_kind(value)}, expected True or False (see bool())"


def _check_nat(value: Any) -> str | None:
    if type(value) is int:
        return None if value >= 0 else f"returned {value}, expected a number from 0 on"
    return f"returned {shown(value)} of type {_kind(value)}, expected an integer (see int())"


def _set_check(sort: str, cls: type) -> Callable[[Any], str | None]:
    last: Any = None

    def check(value: Any) -> str | None:
        nonlocal last
        # Most domains return the same tuple again and again; it cannot change.
        if value is last and last is not None:
            return None
        if isinstance(value, str) or not isinstance(value, Collection):
            hint = " (an iterator can be read only once)" if isinstance(value, Iterator) else ""
            return f"returned {shown(value)}, expected a set of {sort}{hint}"
        for element in value:
            if not isinstance(element, cls):
                return f"returned a set with {shown(element)} in it, expected a set of {sort}"
        if not isinstance(value, frozenset | set) and len(frozenset(value)) != len(value):
            return f"returned {shown(value)}, which has an element twice"
        if isinstance(value, tuple | frozenset):
            last = value
        return None

    return check
