"""Kept machine code made into functions again, without the compiler.

What Numba compiles is an object file with a function of Python's own calling convention in it.
To call that, LLVM has to link it, and three small extension modules of Numba have to be there:
they look after memory and errors. The compiler, which is fifty times as much, does not: it is a
quarter of a second to import, and half a second until it has read its own cache.
"""

from __future__ import annotations

import builtins
import ctypes
import importlib.util
import os
import pickle
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.machinery import PathFinder
from types import ModuleType
from typing import Any

import numpy as np

HELPERS, FUNCTIONS, MEMORY = (
    "numba._helperlib",
    "numba._dynfunc",
    "numba.core.runtime._nrt_python",
)
"""The extension modules."""


@dataclass(frozen=True)
class MachineCode:
    """A kernel, compiled for arguments of some kinds.

    `environments` are the constants that the code asks for, by the names under which it does:
    types of array elements.
    """

    name: str
    code: bytes
    entry: str
    environment: str
    environments: dict[str, tuple[str, ...]]


class UnavailableError(Exception):
    """Kept machine code cannot be used here."""


@cache
def linker() -> Linker:
    """The one linker of this process.

    Raises:
        UnavailableError: Numba or LLVM is not there, or not as it is known.
    """
    return Linker()


class Linker:
    """Makes functions of machine code. What it has linked stays."""

    def __init__(self) -> None:
        try:
            import llvmlite.binding as llvm

            helpers, self._functions, memory = map(_extension, (HELPERS, FUNCTIONS, MEMORY))
            memory.memsys_use_cpython_allocator()
            self._llvm = llvm
            self._tell_addresses(helpers, memory)
            llvm.initialize_native_target()
            llvm.initialize_native_asmprinter()
            target = llvm.Target.from_triple(llvm.get_process_triple())
            self._engine = llvm.create_mcjit_compiler(
                llvm.parse_assembly(""), target.create_target_machine()
            )
        except (ImportError, AttributeError, RuntimeError, OSError) as error:
            raise UnavailableError(str(error)) from error
        self._environments: list[Any] = []

    def _tell_addresses(self, helpers: ModuleType, memory: ModuleType) -> None:
        """Where everything is that machine code calls by name."""
        add = self._llvm.add_symbol
        add("_Py_NoneStruct", id(None))
        for table in (helpers.c_helpers, self._functions.c_helpers):
            for name, address in table.items():
                add(f"numba_{name}", address)
        for name, address in memory.c_helpers.items():
            add(name if name.startswith("_") else f"NRT_{name}", address)
        for error in vars(builtins).values():
            if isinstance(error, type) and issubclass(error, BaseException):
                add(f"PyExc_{error.__name__}", id(error))
        if "numba" not in sys.modules:  # else it has its own, and need not be imported for it
            add("numba_unpickle", ctypes.cast(_unpickle, ctypes.c_void_p).value)

    def function(self, machine_code: MachineCode) -> Callable[..., Any]:
        """What to call.

        Raises:
            UnavailableError: the machine code does not hold what it should.
        """
        engine = self._engine
        try:
            engine.add_object_file(self._llvm.ObjectFileRef.from_data(machine_code.code))
            engine.finalize_object()
            address = engine.get_function_address(machine_code.entry)
        except RuntimeError as error:
            raise UnavailableError(str(error)) from error
        if not address:
            raise UnavailableError(f"no {machine_code.entry}")
        made = {name: self._environment(*each) for name, each in machine_code.environments.items()}
        for name, environment in made.items():
            place = engine.get_global_value_address(name)
            if place:
                ctypes.c_void_p.from_address(place).value = id(environment)
        self._environments += made.values()
        module = sys.modules[__name__]
        own = made[machine_code.environment]
        function: Callable[..., Any] = self._functions.make_function(
            module, machine_code.name, "a kernel", address, own, (engine,)
        )
        return function

    def _environment(self, *dtypes: str) -> Any:
        environment = self._functions.Environment({})
        environment.consts[:] = [np.dtype(each) for each in dtypes]
        return environment


def _extension(name: str) -> ModuleType:
    """An extension module of Numba, imported without the packages around it; they find it later."""
    if name in sys.modules:
        return sys.modules[name]
    package = importlib.util.find_spec("numba")
    if package is None or package.origin is None:
        raise ImportError("there is no numba")
    _, *folders, module = name.split(".")
    found = PathFinder.find_spec(module, [os.path.join(os.path.dirname(package.origin), *folders)])
    if found is None or found.origin is None:
        raise ImportError(f"there is no {name}")
    spec = importlib.util.spec_from_file_location(name, found.origin)
    assert spec is not None, "a file that was found"
    assert spec.loader is not None, "a file that was found"
    made = importlib.util.module_from_spec(spec)
    sys.modules[name] = made
    try:
        spec.loader.exec_module(made)
    except BaseException:
        del sys.modules[name]
        raise
    return made


_objects: dict[int, Any] = {}


@ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)  # type: ignore[untyped-decorator]
def _unpickle(address: int, length: int, _digest: int) -> Any:
    """The object that machine code holds pickled: the class of arrays, or an error to raise."""
    # Machine code stays where it is as long as the process lives: so does what is at an address.
    if address not in _objects:
        _objects[address] = pickle.loads(ctypes.string_at(address, length))
    return _objects[address]
