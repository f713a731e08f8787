"""The garbage collector, kept from what lives for ever."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def spared() -> Iterator[None]:
    """What exists on entry is not gone through by the garbage collector inside.

    Compiled kernels and libraries are hundreds of thousands of objects; one full collection
    takes 0.1 s, as long as a small plan. Afterwards everything is as before: objects that
    stayed frozen until the interpreter ends would be reported as leaks by native modules.
    """
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
