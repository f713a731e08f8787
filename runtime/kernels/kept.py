"""The file in which machine code of kernels is kept, and what is in it.

    name, digest and length of the index | index | machine code, one piece after another

One file holds what is compiled with the same versions of everything, for the same processor. It is
read once, piece by piece as kernels are called, and each piece has a digest: what is spoiled is
compiled again. A new file is written beside the old one, tried in a process of its own that has no
compiler, and renamed: whoever reads meanwhile has one or the other.
"""

from __future__ import annotations

import atexit
import fcntl
import hashlib
import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import astuple
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np

from runtime.kernels.cache import FOLDER, folder
from runtime.kernels.kinds import Kind
from runtime.kernels.native import Linker, MachineCode, UnavailableError
from sketchlang.errors import InputError
from sketchlang.files import replacing

NAME = b"sketchlang kernels 1\n"
SIZE = 32
"""Bytes of a digest."""

PATIENCE = 60.0
"""Seconds in which a new file has to be tried."""

SETTINGS = "NUMBA_"
"""Beginning of the environment variables that say how Numba compiles, but for these two."""

OTHER_SETTINGS = (FOLDER, "NUMBA_NUM_THREADS")


class Key(NamedTuple):
    """What machine code is for."""

    name: str
    fingerprint: str
    kinds: tuple[Kind, ...]


Piece = tuple[int, bytes]
"""Where a piece begins, after the index, and its digest."""


class Kept:
    """The machine code in a file, or in none, and what is new since it was read. A file that is
    not what was written counts as none."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.new: dict[Key, MachineCode] = {}
        self._index: dict[Key, tuple[int, int, bytes]] = {}
        self._pieces = memoryview(b"")
        if path is not None:
            with suppress(OSError):
                self._read(path.read_bytes())

    def _read(self, data: bytes) -> None:
        start = len(NAME) + SIZE + 8
        length = int.from_bytes(data[start - 8 : start], "big")
        index = data[start : start + length]
        if data[: start - 8] == NAME + _digest(index):
            self._index = {Key(*key): place for key, place in pickle.loads(index).items()}
            self._pieces = memoryview(data)[start + length :]

    def __iter__(self) -> Iterator[Key]:
        return iter(self._index)

    def __getitem__(self, key: Key) -> MachineCode | None:
        """What is kept for a key; None where there is nothing, or nothing sound."""
        place = self._index.get(key)
        if place is None:
            return self.new.get(key)
        first, length, digest = place
        piece = self._pieces[first : first + length]
        if _digest(piece) != digest:
            return None
        return MachineCode(*pickle.loads(piece))

    def write(self) -> None:
        """Put what is new beside what others have written since; nothing is kept where that is
        impossible."""
        if self.path is None or not self.new:
            return
        impossible = suppress(OSError, InputError, RuntimeError, subprocess.SubprocessError)
        with impossible, _alone(self.path.parent), replacing(self.path) as temporary:
            temporary.write_bytes(_packed(self._merged(self.path)))
            _try(temporary)
        for key in self.new:
            _forget_others(key)
        self.new.clear()

    def _merged(self, path: Path) -> dict[Key, MachineCode]:
        """What is new and what is in the file now."""
        pieces = dict(self.new)
        others = Kept(path)
        current = {key.name: key.fingerprint for key in self.new}
        for key in others:
            found = others[key]
            if found is not None and current.get(key.name, key.fingerprint) == key.fingerprint:
                pieces.setdefault(key, found)
        return pieces


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Nobody else writes in a folder: of two who read, add and write at once, one would be lost."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _packed(pieces: dict[Key, MachineCode]) -> bytes:
    index: dict[tuple[object, ...], tuple[int, int, bytes]] = {}
    packed = []
    first = 0
    for key, machine_code in sorted(pieces.items(), key=repr):
        piece = pickle.dumps(astuple(machine_code))
        index[tuple(key)] = (first, len(piece), _digest(piece))
        packed.append(piece)
        first += len(piece)
    head = pickle.dumps(index)
    return b"".join((NAME, _digest(head), len(head).to_bytes(8, "big"), head, *packed))


def _digest(data: bytes | memoryview) -> bytes:
    return hashlib.sha256(data).digest()


def _try(path: Path) -> None:
    """Link all that is in a file, in a process that may die of it."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-m", "runtime.kernels.kept", str(path)]
    subprocess.run(command, env=environment, capture_output=True, check=True, timeout=PATIENCE)


def link_all(path: Path) -> None:
    """Link all that is in a file.

    Raises:
        UnavailableError: it cannot be linked.
    """
    kept = Kept(path)
    linker = Linker()
    for key in kept:
        found = kept[key]
        if found is None:
            raise UnavailableError(f"{key.name} is not what was written")
        linker.function(found)


@cache
def _kept() -> Kept:
    """What is kept for this process; nothing, for good or until it is written again, where that
    is not to be had."""
    path = None
    with suppress(UnavailableError):
        versions = _versions()
        within = folder(Path(__file__).parent)
        path = None if within is None else within / f"kernels-{versions}.bin"
    atexit.register(write)
    return Kept(path)


def _versions() -> str:
    """What has to be the same where machine code is used again."""
    try:
        import llvmlite
        from llvmlite import binding as llvm
    except ImportError as error:
        raise UnavailableError(str(error)) from error
    numba = find_spec("numba")
    if numba is None or numba.origin is None:
        raise UnavailableError("there is no numba")
    said = hashlib.sha256()
    settings = {
        name: value
        for name, value in os.environ.items()
        if name.startswith(SETTINGS) and name not in OTHER_SETTINGS
    }
    for each in (
        sys.version,
        np.__version__,
        llvmlite.__version__,
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        sorted(settings.items()),
    ):
        said.update(repr(each).encode())
    for path in (Path(numba.origin).with_name("_version.py"), Path(".numba_config.yaml")):
        with suppress(FileNotFoundError):
            said.update(path.read_bytes())
    return said.hexdigest()[:16]


def machine_code(key: Key) -> MachineCode | None:
    """What is kept for a key."""
    return _kept()[key]


def keep(key: Key, machine_code: MachineCode | None) -> None:
    """Machine code that was compiled, for the next process."""
    if machine_code is not None:
        _kept().new[key] = machine_code


def write() -> None:
    """Write what was compiled since the last time."""
    _kept().write()


def folder_of(name: str, fingerprint: str) -> Path | None:
    """Where Numba keeps what it compiles of one kernel."""
    within = folder(Path(__file__).parent)
    return None if within is None else within / f"{name}-{fingerprint}"


def _forget_others(key: Key) -> None:
    """Remove what Numba kept of a kernel when it was another one."""
    own = folder_of(key.name, key.fingerprint)
    if own is not None:
        for other in own.parent.glob(f"{key.name}-*"):
            if other != own:
                shutil.rmtree(other, ignore_errors=True)


if __name__ == "__main__":
    link_all(Path(sys.argv[1]))
