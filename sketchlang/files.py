"""The one way out: every file is written by these functions, as a whole or not at all.

A file gets a temporary name, its bytes reach the disk, and then it takes the place of the old
one: whenever the process or the machine stops, there is the old text or the new text. Nothing is
written over a file that the running command reads, by whatever name.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from sketchlang.errors import InputError
from sketchlang.reading import inputs


def write_text(path: Path, text: str, *, over_input: bool = False) -> None:
    """Write a file of text in UTF-8. `over_input` is for those whose work is to change a file.

    Raises:
        InputError: the file cannot be written, or is one that the command reads.
    """
    write_bytes(path, text.encode(), over_input=over_input)


def write_bytes(path: Path, data: bytes, *, over_input: bool = False) -> None:
    """The same for bytes. A pipe, a terminal or `/dev/null` is written to as it is."""
    if is_special(path):
        _pour(path, data)
        return
    with replacing(path, over_input=over_input) as temporary:
        temporary.write_bytes(data)


@contextmanager
def replacing(path: Path, *, over_input: bool = False) -> Iterator[Path]:
    """A name to write a file to, which takes its place when the block ends without an error.

    It is in the same folder and has the same suffix. A symbolic link stays a link: its target
    is replaced. A file that was there keeps its permissions.

    Raises:
        InputError: the file cannot be written, or is one that the command reads.
    """
    if not over_input:
        refuse_input(path)
    try:
        old = _status(path)
        if old is not None and not stat.S_ISREG(old.st_mode):
            raise OSError(errno.EISDIR if stat.S_ISDIR(old.st_mode) else errno.EINVAL, "no file")
        if old is not None and not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        target = Path(os.path.realpath(path))
        temporary = _new_beside(target)
        try:
            yield temporary
            if old is not None:
                os.chmod(temporary, stat.S_IMODE(old.st_mode))
            _sync(temporary)
            os.replace(temporary, target)
        except BaseException:
            with suppress(OSError):  # what went wrong first is what has to be told
                os.unlink(temporary)
            raise
        with suppress(OSError):  # not every file system can do that for folders
            _sync(target.parent)
    except OSError as error:
        raise _unwritable(path, error) from None


@contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """A name at which to make a folder, which gets its place when the block ends without an error.

    It is the folder's own name in a temporary folder beside. Folders above that are missing
    are made.

    Raises:
        InputError: there is something of this name, or the folder cannot be written.
    """
    try:
        if os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, "exists already")
        path.parent.mkdir(parents=True, exist_ok=True)
        around = path.with_name(f".{path.stem[:50]}.{os.urandom(6).hex()}")
        around.mkdir(0o700)
        try:
            yield around / path.name
            os.rename(around / path.name, path)
        finally:
            _remove(around)
    except OSError as error:
        raise _unwritable(path, error) from None


def refuse_input(path: Path, option: str | None = None) -> None:
    """Raises `InputError` if a file is one that the running command reads: by path, symbolic
    link or hard link."""
    name = inputs().name_of(path)
    if name is not None:
        also = "" if name == str(path) else f" ({name})"
        message = f"{path} would overwrite what is read{also}"
        raise InputError(f"{option}: {message}" if option else message)


def check_output(path: Path, *, folder: bool = False, option: str | None = None) -> None:
    """Find out before the work whether a file, or a new folder, can be written.

    Raises:
        InputError: it cannot, or would overwrite what the command reads.
    """
    refuse_input(path, option)
    try:
        old = _status(path)
        if old is not None and folder and not stat.S_ISDIR(old.st_mode):
            raise InputError("is not a folder", place=str(path))
        if old is not None and not folder and stat.S_ISDIR(old.st_mode):
            raise InputError("is a directory", place=str(path))
        if is_special(path):
            return  # not opened: who reads from a pipe would take that for all
        target = os.path.realpath(path)
        within = target if folder and os.path.isdir(target) else os.path.dirname(target)
        if not os.path.isdir(within):
            raise InputError(f"there is no folder {str(path.parent)!r}", place=str(path))
        if old is not None and not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        # Tried, not asked: permissions alone do not tell of file systems that are read-only.
        os.unlink(_new_beside(Path(within) / "test"))
    except OSError as error:
        raise _unwritable(path, error) from None
    except ValueError:  # a NUL in the name
        raise InputError("is no name of a file", place=str(path)) from None


def check_outputs(outputs: Mapping[str, Path | None], folders: tuple[str, ...] = ()) -> None:
    """`check_output` for every output, by its option, and that no two are the same file.

    Raises:
        InputError: one cannot be written, or would overwrite an input or another output.
    """
    taken: dict[str, str] = {}
    for option, path in outputs.items():
        if path is None:
            continue
        check_output(path, folder=option in folders, option=option)
        real = os.path.realpath(path)
        if real in taken and not is_special(path):
            raise InputError(f"{option}: {path} would overwrite what {taken[real]} writes")
        taken[real] = option


def cache_folder() -> Path:
    """The user's folder for what can be computed anew; one that cannot be made where there is no
    home."""
    base = os.environ.get("XDG_CACHE_HOME")
    try:
        return (Path(base) if base else Path.home() / ".cache") / "sketchlang"
    except RuntimeError:  # no home
        return Path(os.devnull) / "sketchlang"


def is_special(path: Path) -> bool:
    """Whether there is something of this name that is neither a regular file nor a folder."""
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):  # nothing is there, or nothing can be known of it
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _status(path: Path) -> os.stat_result | None:
    try:
        return os.stat(path)
    except FileNotFoundError:
        return None


def _new_beside(target: Path) -> Path:
    """A new, empty file with the permissions that new files have."""
    for _ in range(100):
        # Of a long name only a part: with what is added it would be too long.
        name = f".{target.stem[:50]}.{os.urandom(6).hex()}{target.suffix[:20]}"
        path = target.with_name(name)
        try:
            os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
        except FileExistsError:
            continue
        return path
    raise FileExistsError(errno.EEXIST, "no temporary name is free")


def _remove(folder: Path) -> None:
    import shutil  # takes its time, and is needed here only

    shutil.rmtree(folder, ignore_errors=True)


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _pour(path: Path, data: bytes) -> None:
    # Not to wait for somebody who reads from a pipe: that may be for ever.
    flags = os.O_WRONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
    try:
        handle = os.open(path, flags)
        os.set_blocking(handle, True)
        with open(handle, "wb") as file:
            file.write(data)
    except OSError as error:
        raise _unwritable(path, error) from None


def _unwritable(path: Path, error: OSError) -> InputError:
    reason = "nobody reads from it" if error.errno == errno.ENXIO else error.strerror or error
    return InputError(f"cannot be written: {reason}", place=str(path))
