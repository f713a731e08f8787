"""Where compiled kernels are kept.

Numba keeps them beside the code or in the user's cache folder, and fails where it can write to
neither: in a container whose user has no home and did not install the package. Then they go to a
folder of this user for temporary files, or are compiled anew each time.
"""

from __future__ import annotations

import logging
import os
import stat
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

FOLDER = "NUMBA_CACHE_DIR"
"""Environment variable that names a folder to Numba."""


def prepare(package: Path) -> None:
    """Find a folder for compiled kernels before they are imported, and say so if it is none of
    the usual ones. `package` is the folder of the package."""
    if os.environ.get(FOLDER) or can_write(package / "__pycache__") or _home_serves():
        return
    log = logging.getLogger("sketchlang")
    for place in (tempfile.gettempdir, lambda: "/dev/shm", lambda: "/var/tmp"):
        with suppress(OSError):
            folder = own_folder(Path(place()))
            _use(folder)
            log.warning("compiled kernels are kept in %s (%s names another place)", folder, FOLDER)
            return
    _compile_anew()
    log.warning("no folder for compiled kernels: every start takes some 20 s (set %s)", FOLDER)


class _Compiled:
    """Whether this process had to compile a kernel."""

    some = False


def has_compiled() -> bool:
    """Whether this process had to compile a kernel: those that it has not asked for yet may not
    be kept anywhere either."""
    return _Compiled.some


def announce() -> None:
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


def _home_serves() -> bool:
    cache = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    # Without a home, `~` stays `~`: Numba would make a folder of this name where it stands.
    return os.path.isabs(cache) and can_write(Path(cache))


def _use(folder: Path) -> None:
    os.environ[FOLDER] = str(folder)
    if "numba" in sys.modules:  # it has read the environment already
        from numba.core import config

        config.CACHE_DIR = str(folder)


def _compile_anew() -> None:
    from numba.core.dispatcher import Dispatcher

    # Numba has no other way to say that nothing shall be kept.
    Dispatcher.enable_caching = lambda self: None  # type: ignore[method-assign]
