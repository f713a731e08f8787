"""The compiler, Numba: imported only where something has to be compiled.

No kernel uses linear algebra from a library or functions of C. Numba would still import all of
SciPy's linear algebra and a parser of C, a fifth of a second, when its first function is loaded:
here it is told that there are none, and only while it asks.
"""

from __future__ import annotations

import importlib
import logging
import sys
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np

from runtime.kernels.kinds import PLAIN
from runtime.kernels.native import MachineCode

ASKS = {
    "numba.np.arraymath": ("scipy", "scipy.linalg"),
    "numba.core.typing.cffi_utils": ("cffi",),
}
"""Modules of Numba, and what each would like to have: the first that is not there yet is hidden."""


class _Compiled:
    """Whether this process had to compile a kernel."""

    some = False


def has_compiled() -> bool:
    """Whether this process had to compile a kernel: those that it has not asked for yet may not
    be kept anywhere either."""
    return _Compiled.some


def dispatcher(function: FunctionType, options: dict[str, Any], folder: Path | None) -> Any:
    """Numba's own form of a kernel, which compiles it for the types of its arguments and keeps
    that in `folder`."""
    numba = _numba()
    made = numba.njit(**options)(function)
    if folder is not None:
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = str(folder)
        try:
            made.enable_caching()
        finally:
            numba.config.CACHE_DIR = before
    return made


def machine_code(dispatcher: Any, arguments: tuple[object, ...]) -> MachineCode | None:
    """What was compiled for arguments, as it can be kept; None where it cannot."""
    types = tuple(dispatcher.typeof_pyval(argument) for argument in arguments)
    compiled = dispatcher.overloads.get(types)
    if compiled is None or compiled.objectmode or compiled.lifted or compiled.reload_init:
        return None
    if compiled.library.has_dynamic_globals:
        return None
    others = compiled.referenced_envs or compiled._find_referenced_environments()
    environments = {each.env_name: each.consts for each in (compiled.environment, *others)}
    constants = [constant for each in environments.values() for constant in each]
    if not all(isinstance(each, np.dtype) and each.kind in PLAIN for each in constants):
        return None
    try:
        code = _object_file(dispatcher, compiled)
    except (AttributeError, IndexError, KeyError, OSError, RuntimeError, TypeError, ValueError):
        return None  # a Numba that keeps it elsewhere
    return MachineCode(
        name=compiled.fndesc.qualname,
        code=code,
        entry=compiled.fndesc.llvm_cpython_wrapper_name,
        environment=compiled.environment.env_name,
        environments={
            name: tuple(each.str for each in consts) for name, consts in environments.items()
        },
    )


def _object_file(dispatcher: Any, compiled: Any) -> bytes:
    if compiled.metadata is not None:  # compiled in this process
        code: bytes = compiled.library._get_compiled_object()
        return code
    # What came from Numba's cache is forgotten once it is linked.
    kept = dispatcher._cache
    key = kept._index_key(compiled.signature.args, compiled.library.codegen)
    (_name, _form, (code, _bitcode)), *_ = kept._cache_file.load(key)
    return code


@cache
def _numba() -> Any:
    """Numba, imported without what no kernel needs."""
    numba = importlib.import_module("numba")
    for module, libraries in ASKS.items():
        library = next((each for each in libraries if each not in sys.modules), None)
        if module in sys.modules or library is None:
            continue
        sys.modules[library] = None  # type: ignore[assignment]
        try:
            importlib.import_module(module)
        finally:
            del sys.modules[library]
    _announce()
    return numba


def _announce() -> None:
    """Say once, when the first kernel is compiled, that this takes its time."""
    from numba.core import event

    class Once(event.Listener):  # type: ignore[misc]
        def on_start(self, event: object) -> None:
            if not _Compiled.some:
                _Compiled.some = True
                logging.getLogger("sketchlang").warning(
                    "compiling kernels, once: this takes half a minute or more"
                )

        def on_end(self, event: object) -> None:
            pass

    event.register("numba:compile", Once())
