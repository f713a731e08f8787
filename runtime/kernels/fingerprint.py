"""Fingerprints of kernels: two kernels with the same one are the same machine code.

That of a kernel is taken from what Python compiled, not from its text: a comment or another line
number changes nothing, a kernel that it calls, or a constant that it reads, does.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

LENGTH = 24
"""Hexadecimal digits of a fingerprint."""

OUTSIDE = frozenset({"math", "numpy", "builtins"})
"""Modules that the versions of libraries stand for."""


class UnstableError(Exception):
    """What has no fingerprint: it may be another thing in another process."""


def fingerprint(
    function: FunctionType, options: dict[str, Any], of_kernel: Callable[[object], str | None]
) -> str:
    """The fingerprint of a function that is compiled with some options; `of_kernel` has that of a
    kernel, and None for what is no kernel.

    Raises:
        UnstableError: it uses what has no fingerprint.
    """
    said = hashlib.sha256(repr(sorted(options.items())).encode())
    said.update(repr(function.__defaults__).encode())
    for code in _codes(function.__code__):
        said.update(_text(code, function.__doc__).encode())
        for name in code.co_names:
            if name in function.__globals__:
                value = function.__globals__[name]
                said.update(f"{name} = {_said_of(value, code, of_kernel)}\n".encode())
    return said.hexdigest()[:LENGTH]


def _codes(code: CodeType) -> Iterator[CodeType]:
    """A code and those within it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _text(code: CodeType, documentation: str | None) -> str:
    constants = [
        repr(sorted(each, key=repr)) if isinstance(each, frozenset) else repr(each)
        for each in code.co_consts
        if not isinstance(each, CodeType) and each != documentation
    ]
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    return f"{code.co_code.hex()} {constants} {names} {code.co_argcount} {code.co_flags}\n"


def _said_of(value: object, code: CodeType, of_kernel: Callable[[object], str | None]) -> str:
    kernel = of_kernel(value)
    if kernel is not None:
        return kernel
    if isinstance(value, ModuleType):
        return value.__name__ + "".join(
            f" {name} = {_said_of(inner, code, of_kernel)}"
            for name, inner in sorted(vars(value).items())
            if name in code.co_names and value.__name__ not in OUTSIDE
        )
    if hasattr(value, "py_func"):
        raise UnstableError("compiled by others")
    if isinstance(value, np.ndarray):
        return f"{value.dtype.str} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
    if isinstance(value, type) or callable(value):
        name = f"{value.__module__}:{getattr(value, '__qualname__', value)}"
        return f"{name} {getattr(value, '_fields', '')}"
    if not isinstance(value, bool | int | float | str | tuple | None):
        raise UnstableError(f"a {type(value).__name__}")
    return repr(value)
