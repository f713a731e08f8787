"""Limits of time and memory, and how an analysis stops at one."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field, replace

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


class WorkDoneError(Exception):
    """The steps that an attempt was given are used up: it is time to try something else."""


@dataclass
class Budget:
    """What an analysis may use. `check` is called from its loops and raises at a limit.

    `seconds` counts from the making of the budget, `megabytes` is the size of the whole
    process; None is no limit. `steps` are for one attempt of several, see `attempt`: they
    do not depend on the machine, so the same sketch always gets the same proof.
    """

    seconds: float | None = None
    megabytes: float | None = None
    started: float = field(default_factory=time.perf_counter)
    base_mb: float = 0.0
    steps: int | None = None
    _look_at: float = 0.0  # when to look at the memory again

    def __post_init__(self) -> None:
        # Asking the system takes as long as a small proof.
        if self.megabytes is not None and not self.base_mb:
            self.base_mb = peak_memory_mb()

    def check(self) -> None:
        """Raises `LimitReachedError` when time or memory is used up."""
        now = time.perf_counter()
        if self.seconds is not None and now - self.started > self.seconds:
            raise LimitReachedError("time", f"time limit of {self.seconds:g} s")
        if self.megabytes is not None and now > self._look_at:
            self._look_at = now + LOOK_S
            if peak_memory_mb() > self.megabytes:
                raise LimitReachedError("memory", f"memory limit of {self.megabytes:g} MB")

    def attempt(self, steps: int) -> Budget:
        """The same limits for an attempt that may take so many steps."""
        return replace(self, steps=steps)

    def extended(self, seconds: float) -> Budget:
        """The same limits, but with so many seconds from now on, if there is a limit of time."""
        if self.seconds is None:
            return self
        return replace(self, seconds=seconds, started=time.perf_counter())

    def within(self, seconds: float) -> Budget:
        """The same limits, but with at most so many seconds from now on."""
        left = self.left()
        return replace(
            self,
            seconds=seconds if left is None else max(0.0, min(seconds, left)),
            started=time.perf_counter(),
        )

    def spend(self, steps: int) -> None:
        """Raises `WorkDoneError` when the steps of an attempt are used up."""
        if self.steps is not None:
            self.steps -= steps
            if self.steps < 0:
                raise WorkDoneError

    def left(self) -> float | None:
        """Seconds that are left, None without a limit."""
        if self.seconds is None:
            return None
        return self.seconds - (time.perf_counter() - self.started)

    def reserve(self, megabytes: float) -> None:
        """Raises `LimitReachedError` if this much on top of the start would be too much."""
        if self.megabytes is not None and self.base_mb + megabytes > self.megabytes:
            raise LimitReachedError("memory", f"memory limit of {self.megabytes:g} MB")
