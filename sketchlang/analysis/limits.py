"""Limits of time and memory, and how an analysis stops at one."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field

LOOK_S = 0.01
"""Memory is looked at this often: asking the system takes 30 us."""


class LimitReachedError(Exception):
    """A limit was hit; `limit` says which, in words for the user."""

    def __init__(self, kind: str, limit: str) -> None:
        super().__init__(limit)
        self.kind = kind
        self.limit = limit


def peak_memory_mb() -> float:
    """Largest resident size of this process so far in MiB, 0 where the system does not tell."""
    try:
        # `getrusage` would count what a parent used before it started this program.
        with open("/proc/self/status", "rb") as status:
            for line in status:
                if line.startswith(b"VmHWM:"):
                    return int(line.split()[1]) / 1024
    except OSError:  # not Linux
        pass
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
    _look_at: float = 0.0  # when to look at the memory again

    def check(self) -> None:
        """Raises `LimitReachedError` when time or memory is used up."""
        now = time.perf_counter()
        if self.seconds is not None and now - self.started > self.seconds:
            raise LimitReachedError("time", f"time limit of {self.seconds:g} s")
        if self.megabytes is not None and now > self._look_at:
            self._look_at = now + LOOK_S
            if peak_memory_mb() > self.megabytes:
                raise LimitReachedError("memory", f"memory limit of {self.megabytes:g} MB")

    def reserve(self, megabytes: float) -> None:
        """Raises `LimitReachedError` if this much on top of the start would be too much."""
        if self.megabytes is not None and self.base_mb + megabytes > self.megabytes:
            raise LimitReachedError("memory", f"memory limit of {self.megabytes:g} MB")
