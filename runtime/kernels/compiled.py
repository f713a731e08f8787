"""Kernels: functions that are compiled for the kinds of their arguments.

A kernel looks for its machine code among what was kept (`runtime.kernels.kept`). Only where there
is none for a fingerprint and kinds of arguments is the compiler imported, and what it makes is
kept for the next time.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cached_property, update_wrapper
from types import FunctionType
from typing import Any

from runtime.kernels import kept
from runtime.kernels.fingerprint import UnstableError, fingerprint
from runtime.kernels.kinds import UNKNOWN, kind_of, numbers_of
from runtime.kernels.native import UnavailableError, linker


class Kernel:
    """A compiled function. Inside of other kernels, it is what Numba makes of it."""

    def __init__(self, function: FunctionType, options: dict[str, Any], cache: bool) -> None:
        update_wrapper(self, function)
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.py_func = function
        self.targetoptions = options
        self._cache = cache
        self._functions: dict[tuple[int, ...], Callable[..., Any]] = {}

    def __call__(self, *arguments: Any) -> Any:
        """What the function has for arguments."""
        numbers = numbers_of(arguments)
        function = self._functions.get(numbers)
        if function is None:
            function = self._functions[numbers] = self._kept(numbers)
        return function(*arguments)

    @cached_property
    def fingerprint(self) -> str | None:
        """What machine code of the kernel is kept under; None for one that is not kept: it is not
        the same whenever it is imported."""
        if not self._cache or self.py_func.__closure__ is not None:
            return None
        self.__dict__["fingerprint"] = "itself"  # for a kernel that calls itself
        try:
            return fingerprint(self.py_func, self.targetoptions, _of_kernel)
        except UnstableError:
            return None

    def _kept(self, numbers: tuple[int, ...]) -> Callable[..., Any]:
        """What to call for arguments of some kinds."""
        if self.fingerprint is None or UNKNOWN in numbers:
            return self._compiled
        key = kept.Key(self.name, self.fingerprint, tuple(kind_of(each) for each in numbers))
        try:
            found = kept.machine_code(key)
            if found is not None:
                return linker().function(found)
        except UnavailableError:
            return self._compiled

        def first(*arguments: Any) -> Any:
            result = self._compiled(*arguments)
            self._functions[numbers] = self._compiled
            from runtime.kernels.compiler import machine_code

            kept.keep(key, machine_code(self.dispatcher, arguments))
            return result

        return first

    def _compiled(self, *arguments: Any) -> Any:
        return self.dispatcher(*arguments)

    @cached_property
    def dispatcher(self) -> Any:
        """Numba's own form of the kernel."""
        from runtime.kernels.compiler import dispatcher

        folder = None
        if self.fingerprint is not None:
            folder = kept.folder_of(self.name, self.fingerprint)
        return dispatcher(self.py_func, self.targetoptions, folder)

    @property
    def _numba_type_(self) -> Any:
        """How Numba is told what to make of an object that it does not know."""
        return self.dispatcher._numba_type_


def njit(
    *, cache: bool = True, inline: str = "never"
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A function as a kernel, kept unless there is to be no `cache`; options as Numba's."""
    options = {"inline": inline}

    def made(function: Callable[..., Any]) -> Callable[..., Any]:
        assert isinstance(function, FunctionType), "something defined by def"
        if os.environ.get("NUMBA_DISABLE_JIT") == "1":
            return function
        return Kernel(function, options, cache)

    return made


def _of_kernel(value: object) -> str | None:
    if not isinstance(value, Kernel):
        return None
    if value.fingerprint is None:
        raise UnstableError(value.name)
    return value.fingerprint
