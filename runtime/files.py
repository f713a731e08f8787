"""Files are written to a temporary name and renamed: a reader never sees half of one."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sketchlang.errors import InputError


def write_text(path: Path, text: str) -> None:
    """Write a file of text under a temporary name and rename it.

    Raises:
        InputError: the file cannot be written.
    """
    write_bytes(path, text.encode())


def write_bytes(path: Path, data: bytes) -> None:
    """The same for bytes."""
    with replacing(path) as temporary:
        temporary.write_bytes(data)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A name to write a file to, which takes its place when the block ends without an error.

    It is in the same folder and has the same suffix. A symbolic link stays a link: its target
    is replaced. What is no regular file (a pipe, a terminal, `/dev/null`) is written to as it
    is, for renaming would put a file in its place.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        if is_special(path):
            yield path
            return
        target = Path(os.path.realpath(path))
        handle, name = tempfile.mkstemp(
            dir=target.parent, prefix=f".{target.stem[:50]}.", suffix=target.suffix
        )
        os.close(handle)
        try:
            yield Path(name)
            os.chmod(name, 0o666 & ~_umask())
            os.replace(name, target)
        except BaseException:
            with suppress(OSError):  # what went wrong first is what has to be told
                os.unlink(name)
            raise
    except OSError as error:
        message = f"cannot be written: {error.strerror or error}"
        raise InputError(message, place=str(path)) from None


def is_special(path: Path) -> bool:
    """Whether there is something of this name that is neither a regular file nor a folder."""
    try:
        mode = path.stat().st_mode
    except OSError:  # nothing is there, or nothing can be known of it
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
