"""Files are written to a temporary name and renamed: a reader never sees half of one."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from runtime.errors import InputError


def write_text(path: Path, text: str) -> None:
    """Write a file of text under a temporary name and rename it.

    Raises:
        InputError: the file cannot be written.
    """
    write_bytes(path, text.encode())


def write_bytes(path: Path, data: bytes) -> None:
    """The same for bytes."""
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent or Path(), prefix=f".{path.name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", place=str(path)) from None
