"""Checking again whenever a file changes: `sketchlang check --watch`."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator

PERIOD = 0.2
"""Seconds between two looks at the files."""

Stamps = dict[str, tuple[int, int] | None]


def stamps(paths: Iterable[str]) -> Stamps:
    """What tells that a file has changed: time and size, None where there is none."""
    found: Stamps = {}
    for path in paths:
        try:
            status = os.stat(path)
        except (OSError, ValueError):
            found[path] = None
        else:
            found[path] = status.st_mtime_ns, status.st_size
    return found


def ticks() -> Iterator[None]:
    """For ever, with a pause each time."""
    while True:
        time.sleep(PERIOD)
        yield


def watch(look: Callable[[], Iterable[str]], tick: Iterable[None]) -> None:
    """Look at once, and after every tick at which one of the files that were read has changed.

    `look` returns the paths of these files: an `include` that is new is watched as well.
    """
    seen = stamps(look())
    for _ in tick:
        if stamps(seen) != seen:
            # Taken before it is read: what is written meanwhile is seen at the next tick.
            before = stamps(seen)
            paths = list(look())
            seen = {path: before.get(path) or stamp for path, stamp in stamps(paths).items()}
