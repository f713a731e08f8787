"""One case: a file in a folder of its own, read under a limit of time."""

from __future__ import annotations

import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.fuzz.targets import TARGETS

SECONDS = 20.0
"""Of processor time for one case: what takes longer hangs."""


class TooLongError(Exception):
    """A case took longer than it may."""


def tried(name: str, data: bytes) -> str | None:
    """Read the bytes of a file of a format; what is wrong with how that ends, or None."""
    target = TARGETS[name]
    with tempfile.TemporaryDirectory() as folder, _limit():
        path = Path(folder) / f"file{target.suffix}"
        path.write_bytes(data)
        return target.finding(path)


@contextmanager
def _limit() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TooLongError(f"took more than {SECONDS:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
