"""Where compiled kernels are kept: beside the code, or in the user's cache folder, or, in a
container whose user has no home and did not install the package, in a folder of this user for
temporary files. Where none of them can be written they are compiled anew each time.
"""

from __future__ import annotations

import hashlib
import logging
import os
import stat
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

FOLDER = "NUMBA_CACHE_DIR"
"""Environment variable that names a folder to Numba."""


@cache
def folder(package: Path) -> Path | None:
    """The folder for compiled kernels, which says so if it is none of the usual ones; None where
    there is none. `package` is the folder of the package."""
    named = os.environ.get(FOLDER)
    beside = package / "__pycache__"
    for usual in (Path(named) if named else beside, _in_home(package)):
        if usual is not None and can_write(usual):
            return usual
    log = logging.getLogger("sketchlang")
    for place in (tempfile.gettempdir, lambda: "/dev/shm", lambda: "/var/tmp"):
        with suppress(OSError):
            found = own_folder(Path(place()))
            log.warning("compiled kernels are kept in %s (%s names another place)", found, FOLDER)
            return found
    log.warning("no folder for compiled kernels: every start takes some 20 s (set %s)", FOLDER)
    return None


def can_write(folder: Path) -> bool:
    """Whether files can be made in a folder, which is made if it is missing."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def own_folder(within: Path) -> Path:
    """A folder that belongs to this user alone: what is in it is loaded as code.

    Raises:
        OSError: it cannot be made or written, or there is one that others can write.
    """
    folder = within / f"sketchlang-kernels-{os.getuid()}"
    with suppress(FileExistsError):
        folder.mkdir(0o700)
    found = folder.lstat()
    private = stat.S_ISDIR(found.st_mode) and not found.st_mode & 0o077
    if not private or found.st_uid != os.getuid() or not can_write(folder):
        raise PermissionError(f"{folder} is not for this user alone")
    return folder


def _in_home(package: Path) -> Path | None:
    """The folder of one installation in the user's cache folder."""
    cache = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if not os.path.isabs(cache):  # without a home, `~` stays `~`
        return None
    return Path(cache) / "sketchlang" / hashlib.sha256(str(package).encode()).hexdigest()[:16]
