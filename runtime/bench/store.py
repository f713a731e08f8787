"""Results of benchmarks in a file, one JSON object a line, that survives kills and company.

A line is on the disk before the next one is begun. The file is locked while it is open, so that
two benchmarks with one store take turns. A last line that was cut off by a kill is taken away;
whatever else is not as it should be is said and left alone.
"""

from __future__ import annotations

import errno
import fcntl
import json
import math
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from runtime.bench.job import KEYS, Job, Result, Versions, key
from sketchlang.errors import InputError
from sketchlang.reading import inputs

MOST_BYTES = 256 << 20
BEGINNINGS = (b'{"job": {"sketch": "', b'{"sketch": "')
"""How lines begin: only what looks like a part of one is taken for a line that was cut off."""

STEP = ("calls", "successes", "time_s")


@dataclass
class Store:
    """An open store: the results so far, by job, and a place for more."""

    path: Path
    handle: int
    results: dict[Job, Result] = field(default_factory=dict)

    def append(self, result: Result) -> None:
        """Keep a result; when this returns, it is on the disk.

        Raises:
            InputError: it cannot be written; the file is then as it was before.
        """
        end = os.fstat(self.handle).st_size
        line = json.dumps({"job": result["job"]} | result).encode() + b"\n"
        try:
            while line:
                line = line[os.write(self.handle, line) :]
            os.fsync(self.handle)
        except OSError as error:
            with suppress(OSError):
                os.ftruncate(self.handle, end)
            raise _unwritable(self.path, error) from None
        self.results[key(result)] = result


@contextmanager
def opened(path: Path, waiting: Callable[[], None] = lambda: None) -> Iterator[Store]:
    """Open a store, which is made if it is missing; `waiting` is called if another process has
    it, before its end is waited for.

    Raises:
        InputError: it is no store, or a damaged one, or cannot be opened.
    """
    try:
        handle = _locked(path, waiting)
    except OSError as error:
        raise _unwritable(path, error) from None
    try:
        yield Store(path, handle, _read(path, handle))
    finally:
        os.close(handle)


def read_results(path: Path) -> list[Result]:
    """The results of a file that need not exist; it is not changed.

    Raises:
        InputError: it is no store, or a damaged one.
    """
    from sketchlang.reading import read_bytes

    if not os.path.lexists(path):
        return []
    return list(parsed(path, read_bytes(path, MOST_BYTES))[0].values())


def parsed(path: Path, data: bytes) -> tuple[dict[Job, Result], int]:
    """The results in the bytes of a store, and how many of the bytes hold them.

    Raises:
        InputError: which line is not as it should be, and why.
    """
    results: dict[Job, Result] = {}
    lines, end = data.split(b"\n"), 0
    for number, line in enumerate(lines, 1):
        if line.strip():
            try:
                result = _checked(_decoded(line))
            except _CutOffError as error:
                if number == len(lines) and _is_beginning(line):
                    return results, end  # the process was killed while it wrote
                raise InputError(str(error), place=f"{path}: line {number}") from None
            except ValueError as error:
                raise InputError(str(error), place=f"{path}: line {number}") from None
            if key(result) in results:
                message = "is a second result of the same run"
                raise InputError(message, place=f"{path}: line {number}")
            results[key(result)] = result
        end = min(end + len(line) + 1, len(data))
    return results, end


class _CutOffError(ValueError):
    """What is no JSON may have been before it was cut off."""


def _locked(path: Path, waiting: Callable[[], None]) -> int:
    while True:
        with suppress(FileNotFoundError):
            _refuse_special(os.stat(path))
        flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NONBLOCK
        handle = os.open(path, flags, 0o666)
        try:
            _refuse_special(os.fstat(handle))
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                waiting()
                fcntl.flock(handle, fcntl.LOCK_EX)
            if os.path.samestat(os.fstat(handle), os.stat(path)):
                with suppress(OSError):  # a new name lasts only when its folder is written
                    _sync(path.parent)
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)  # somebody put another file in its place


def _refuse_special(found: os.stat_result) -> None:
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "results are kept in a regular file")


def _sync(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _read(path: Path, handle: int) -> dict[Job, Result]:
    found = os.fstat(handle)
    if inputs().name_of(path) is not None:
        raise InputError(f"--out: {path} would overwrite what is read")
    if found.st_size > MOST_BYTES:
        raise InputError("is larger than any store", place=str(path))
    try:
        with open(os.dup(handle), "rb") as file:
            file.seek(0)
            data = file.read()
        results, end = parsed(path, data)
        if end < len(data):
            os.ftruncate(handle, end)
        elif data and not data.endswith(b"\n"):
            os.write(handle, b"\n")  # the line is complete but for its end
    except OSError as error:
        raise _unwritable(path, error) from None
    return results


def _is_beginning(line: bytes) -> bool:
    return any(line.startswith(begin) or begin.startswith(line) for begin in BEGINNINGS)


def _decoded(line: bytes) -> Any:
    try:
        return json.loads(line.decode("utf-8"), parse_constant=_refuse_constant)
    except UnicodeDecodeError:
        raise _CutOffError("is not a text in UTF-8") from None
    except json.JSONDecodeError:
        raise _CutOffError("is not a line of results") from None
    except RecursionError:
        raise ValueError("is nested too deeply") from None
    except ValueError:  # digits by the thousand, NaN
        raise ValueError("has a number that is none") from None


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(name)


def _checked(result: Any) -> Result:
    """The same value; raises `ValueError` if it is not what tables are made of."""
    if not isinstance(result, dict) or not isinstance(result.get("job"), dict):
        raise ValueError("is not a line of results")
    _check_job(result["job"])
    for name in ("scene", "planner"):
        _require(result, name, isinstance(result.get(name), str))
    _require(result, "solved", isinstance(result.get("solved"), bool))
    _require(result, "valid", isinstance(result.get("valid", False), bool))
    for name in ("planning_time_s", "execution_time_s", "peak_mb"):
        _require(result, name, _is_number(result.get(name)))
    for name in ("seed", "expanded", "subplans", "objects_moved"):
        _require(result, name, _is_count(result.get(name)))
    _require(result, "reason", isinstance(result.get("reason", ""), str))
    findings = result.get("findings", [])
    listed = isinstance(findings, list) and all(isinstance(text, str) for text in findings)
    _require(result, "findings", listed)
    profile = result.get("profile")
    _require(result, "profile", isinstance(profile, dict) and all(map(_is_step, profile.values())))
    return result


def _check_job(job: dict[str, Any]) -> None:
    if job.keys() != set(KEYS):
        raise ValueError("`job` has not the keys of a run, or those of an older version")
    for name in ("sketch", "scene", "planner", "robot", "domain"):
        _require(job, name, isinstance(job[name], str))
    _require(job, "seed", _is_count(job["seed"]))
    _require(job, "k_max", _is_count(job["k_max"]))
    _require(job, "timeout", _is_number(job["timeout"]))
    versions = job["versions"]
    named = isinstance(versions, dict) and versions.keys() == Versions.__dataclass_fields__.keys()
    _require(job, "versions", named and all(isinstance(v, str) for v in versions.values()))


def _require(_owner: dict[str, Any], name: str, holds: bool) -> None:
    if not holds:
        raise ValueError(f"`{name}` is missing or not what it should be")


def _is_step(value: object) -> bool:
    return isinstance(value, dict) and all(_is_number(value.get(name)) for name in STEP)


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 1 << 53


def _is_number(value: object) -> bool:
    is_one = isinstance(value, int | float) and not isinstance(value, bool)
    return is_one and abs(value) < 1e15 and math.isfinite(value) and value >= 0  # type: ignore


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(f"cannot be written: {error.strerror or error}", place=str(path))
