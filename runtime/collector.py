"""The garbage collector, kept from what lives for ever."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

GROWTH = 50_000
"""Blocks of memory by which a process may grow before all objects are gone through: some 8 MB."""


class _Last:
    """How many blocks there were when all objects were gone through last; 0: never yet."""

    blocks = 0


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
        gc.unfreeze()
        blocks = sys.getallocatedblocks()  # objects are counted a hundred times slower
        if not _Last.blocks or blocks < _Last.blocks:  # or fewer since then
            _Last.blocks = blocks
        elif blocks > _Last.blocks + GROWTH:
            gc.collect()
            _Last.blocks = sys.getallocatedblocks()
