"""The one way in: every file that a user names is read by these functions.

They read regular files only (a pipe would wait for ever, a device need not end), no more than a
limit, and say in one line what is wrong. What is read is also remembered while a command runs
(`recording`), so that nothing is written over it (`sketchlang.files`).
"""

from __future__ import annotations

import json
import os
import re
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sketchlang.errors import InputError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

MEGABYTE = 1 << 20
JSON_LIMIT = 128 * MEGABYTE
"""Plans and traces of hundreds of objects are some 20 MB."""
TOML_LIMIT = MEGABYTE
"""Scenes of hundreds of objects are some 50 KB; `tomllib` reads about 1 MB a second."""
CODE_LIMIT = 4 * MEGABYTE
"""Python files and robot descriptions."""
KEY_PARTS = 50
"""Parts of a dotted key. `tomllib` takes time and memory with the square of their number."""

_KEY = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_KEY}(?:[ \t]*+\.[ \t]*+{_KEY}){{{KEY_PARTS}}}")

_KINDS = (
    (stat.S_ISDIR, "is a directory"),
    (stat.S_ISFIFO, "is a pipe, not a file"),
    (stat.S_ISSOCK, "is a socket, not a file"),
    (stat.S_ISCHR, "is a device, not a file"),
    (stat.S_ISBLK, "is a device, not a file"),
)


@dataclass
class Inputs:
    """The files that were read, by device and number: a file has many names."""

    names: dict[tuple[int, int], str] = field(default_factory=dict)

    def note(self, path: str | Path) -> None:
        """Remember a file that is or will be read; what is no file is left out."""
        try:
            found = os.stat(path)
        except (OSError, ValueError):
            return
        self.add(found, str(path))

    def add(self, found: os.stat_result, name: str) -> None:
        """Remember a file by what the system says of it."""
        if stat.S_ISREG(found.st_mode):
            self.names.setdefault((found.st_dev, found.st_ino), name)

    def name_of(self, path: str | Path) -> str | None:
        """The name under which a file was read, None if it was not."""
        try:
            found = os.stat(path)
        except (OSError, ValueError):
            return None
        return self.names.get((found.st_dev, found.st_ino))


_INPUTS: ContextVar[Inputs | None] = ContextVar("inputs", default=None)


@contextmanager
def recording() -> Iterator[Inputs]:
    """Remembers all files that are read inside, and keeps them from being written over."""
    inputs = Inputs()
    token = _INPUTS.set(inputs)
    try:
        yield inputs
    finally:
        _INPUTS.reset(token)


def inputs() -> Inputs:
    """What was read so far by the command that runs; nothing where none does."""
    return _INPUTS.get() or Inputs()


def read_bytes(path: str | Path, limit: int = JSON_LIMIT) -> bytes:
    """All bytes of a regular file.

    Raises:
        InputError: it is not there, not a regular file, not readable, or larger than `limit`.
    """
    try:
        _refuse_special(os.stat(path), path)
        # Not to wait for a writer, should it have become a pipe meanwhile.
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        with open(os.open(path, flags), "rb") as file:
            found = os.fstat(file.fileno())
            _refuse_special(found, path)
            if found.st_size > limit:
                raise _too_large(str(path), limit)
            data = file.read(limit + 1)
    except FileNotFoundError:
        raise InputError("no such file", place=str(path)) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", place=str(path)) from None
    except ValueError:  # a NUL in the name
        raise InputError("is no name of a file", place=str(path)) from None
    if len(data) > limit:  # files of /proc say that they are empty
        raise _too_large(str(path), limit)
    inputs().add(found, str(path))
    return data


def read_text(path: str | Path, limit: int = JSON_LIMIT) -> str:
    """All text of a regular file in UTF-8. Raises `InputError` as `read_bytes` does."""
    return decoded(read_bytes(path, limit), str(path))


def read_standard_input(limit: int) -> bytes:
    """All that standard input has.

    Raises:
        InputError: it is closed, cannot be read, or holds more than `limit` bytes.
    """
    name = "<stdin>"
    # Python has none where the descriptor was closed when it started.
    if getattr(sys, "stdin", None) is None:
        raise InputError("standard input is closed", place=name)
    try:
        data = sys.stdin.buffer.read(limit + 1)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", place=name) from None
    if len(data) > limit:
        raise _too_large(name, limit)
    return data


def decoded(data: bytes, name: str) -> str:
    """Bytes of a file as text. Raises `InputError` where they are not UTF-8."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        message = f"is not a text in UTF-8 (byte {error.start + 1})"
        raise InputError(message, place=name) from None


def read_toml(path: str | Path) -> dict[str, Any]:
    """The data of a TOML file. Raises `InputError` with what is wrong with it."""
    import tomllib  # here, for most commands read none

    text = read_text(path, TOML_LIMIT)
    if _LONG_KEY.search(text):
        raise InputError(f"has a key of more than {KEY_PARTS} parts", place=str(path))
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError("is nested too deeply", place=str(path)) from None
    except ValueError as error:  # numbers of thousands of digits are no TOMLDecodeError
        raise InputError(f"is not valid TOML: {error}", place=str(path)) from None


def read_json(path: str | Path, limit: int = JSON_LIMIT) -> Any:
    """The data of a JSON file. Raises `InputError` with what is wrong with it."""
    text = read_text(path, limit)
    try:
        return json.loads(text, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        raise InputError(
            f"is not valid JSON: {error.msg} at line {error.lineno}, column {error.colno}",
            place=str(path),
            hint=None if text.rstrip().endswith("}") else "the file seems to be cut off",
        ) from None
    except (RecursionError, ValueError) as error:  # brackets or digits by the thousand
        raise InputError(f"cannot be read as JSON: {error}", place=str(path)) from None


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object; of two values for one key, one would count for nothing."""
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        raise ValueError(f"the key {twice!r} stands twice in one object")
    return found


def read_xml(path: str | Path, limit: int = CODE_LIMIT) -> Element:
    """The root element of an XML file. Tags keep the prefix that they are written with: URDFs
    are full of prefixes that nobody declares, and no reader of theirs minds.

    Raises:
        InputError: the file cannot be read, or what is wrong with it.
    """
    from xml.etree.ElementTree import TreeBuilder
    from xml.parsers import expat

    text = read_text(path, limit)
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        # A few entities made of each other become gigabytes.
        raise InputError("has a document type or entities, which are not read", place=str(path))
    builder = TreeBuilder()
    parser = expat.ParserCreate("utf-8")
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(text.encode(), True)
        return builder.close()
    except (expat.ExpatError, LookupError, ValueError) as error:
        raise InputError(f"is not well-formed XML: {error}", place=str(path)) from None


def _refuse_special(found: os.stat_result, path: str | Path) -> None:
    for is_kind, message in _KINDS:
        if is_kind(found.st_mode):
            raise InputError(message, place=str(path))


def _too_large(name: str, limit: int) -> InputError:
    size = f"{limit / MEGABYTE:.0f} MB" if limit >= MEGABYTE else f"{limit / 1024:.0f} KB"
    return InputError(f"is larger than {size}", place=name)
