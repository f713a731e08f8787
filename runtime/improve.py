"""How long a plan is improved after it was found, and who can do it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from runtime.search.siw_r import Outcome
from sketchlang.compile import CompiledSketch

Told = Callable[[int, float], None]
"""Called with the number of changes tried and the execution time (s) each time that a plan is
better than all before."""


@dataclass
class Improvement:
    """Until so many `seconds` are over or so many `steps`, changes of the plan, were tried: with
    steps alone the same seed gives the same plan. `tried` and `seconds_taken` are what it took."""

    seconds: float = 0.0
    steps: int | None = None
    tried: int = 0
    seconds_taken: float = 0.0
    _start: float = field(default_factory=time.perf_counter)

    @property
    def wanted(self) -> bool:
        """Whether anything is to be improved."""
        return self.seconds > 0 or bool(self.steps)

    def restart(self) -> None:
        """The clock starts."""
        self._start, self.tried = time.perf_counter(), 0

    def goes_on(self) -> bool:
        """Whether another change may be tried."""
        self.seconds_taken = time.perf_counter() - self._start
        if self.steps is not None and self.tried >= self.steps:
            return False
        return self.seconds <= 0 or self.seconds_taken < self.seconds


@runtime_checkable
class Improvable(Protocol):
    """A problem whose plans can be improved."""

    def improve(
        self, sketch: CompiledSketch, outcome: Outcome, improvement: Improvement, told: Told
    ) -> Outcome:
        """A solved outcome that takes less time to carry out, or the same one; a run of the
        sketch as well. Ends early at a KeyboardInterrupt, with the best so far."""
        ...
