"""Limits of time and memory, and how an analysis stops at one."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field


class LimitReachedError(Exception):
    """A limit was hit; `limit` says which, in words for the user."""

    def __init__(self, kind: str, limit: str) -> None:
        super().__init__(limit)
        self.kind = kind
        self.limit = limit


def peak_memory_mb() -> float:
    """Largest resident size of this process so far, 0 where the system does not tell."""
    try:
        import resource
    except ImportError:  # not a Unix
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20) if sys.platform == "darwin" else peak / 1024


@dataclass
class Budget:
    """What an analysis may use. `check` is called from its loops and raises at a limit.

    `seconds` counts from the making of the budget, `megabytes` is the size of the whole
    process; None is no limit.
    """

    seconds: float | None = None
    megabytes: float | None = None
    started: float = field(default_factory=time.perf_counter)
    base_mb: float = field(default_factory=peak_memory_mb)

    def check(self) -> None:
        """Raises `LimitReachedError` when time or memory is used up."""
        if self.seconds is not None and time.perf_counter() - self.started > self.seconds:
            raise LimitReachedError("time", f"time limit of {self.seconds:g} s")
        if self.megabytes is not None and peak_memory_mb() > self.megabytes:
            raise LimitReachedError("memory", f"memory limit of {self.megabytes:g} MB")

    def reserve(self, megabytes: float) -> None:
        """Raises `LimitReachedError` if this much on top of the start would be too much."""
        if self.megabytes is not None and self.base_mb + megabytes > self.megabytes:
            raise LimitReachedError("memory", f"memory limit of {self.megabytes:g} MB")
