"""The garbage collector, kept from what lives for ever."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

GROWTH = 15_000
"""Objects by which a process may grow before all of them are gone through: about 8 MB."""


class _Last:
    """How many objects there were when all of them were gone through last; 0: never yet."""

    objects = 0


@contextmanager
def spared() -> Iterator[None]:
    """What exists on entry is not gone through by the garbage collector inside.

    Compiled kernels and libraries are hundreds of thousands of objects; one full collection
    takes 0.1 s, as long as a small plan. Afterwards everything is as before: objects that
    stayed frozen until the interpreter ends would be reported as leaks by native modules.

    What was frozen counts as old, and Python's collector looks at the old only when many young
    objects have become old by themselves. So a process that plans again and again collects
    here, after the clock has stopped, whenever it has grown.
    """
    gc.freeze()
    try:
        yield
    finally:
        gc.freeze()  # all there is now: only what is frozen can be counted quickly
        objects = gc.get_freeze_count()
        gc.unfreeze()
        if not _Last.objects:
            _Last.objects = objects
        elif objects > _Last.objects + GROWTH:
            gc.collect()
            _Last.objects = len(gc.get_objects())
