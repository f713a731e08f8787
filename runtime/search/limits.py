"""Time and patience of a search."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace


class OutOfTimeError(Exception):
    """The time given to a search is over."""


class OutOfPatienceError(Exception):
    """A subproblem has taken as many candidates as it may."""


class DrawnBadlyError(Exception):
    """X has refused as many candidates of one attempt at a subproblem as it may."""


HASTE = 4
"""How many times less patience there is with a subproblem that a run has gone back to."""


@dataclass
class Limits:
    """`timeout` in seconds from the start; `k_max` bounds the width of IW(k); `attempts`
    is how often a subproblem is sampled before it is given up. It is given up, too, after so
    many `rejections` of X, or so many nodes `generated` where its actions are sampled, and after
    a quarter of them (`blind`) if not one of them was a subgoal. An attempt ends after so many
    `refusals` of X: samples that are bad are often all bad, and others are better. A run that gets
    stuck goes back at most so many times (`retreats`), and has a part of that patience then, one of
    `HASTE`. Counts and not times, so that the same seed gives the same plan on every machine."""

    timeout: float | None = None
    k_max: int = 2
    attempts: int = 5
    rejections: int = 200
    refusals: int = 50
    generated: int = 40_000
    blind: int = 10_000
    retreats: int = 6
    start: float = field(default_factory=time.perf_counter)

    def hasty(self) -> Limits:
        """The same with less patience, and on the same clock."""
        return replace(
            self,
            rejections=self.rejections // HASTE,
            generated=self.generated // HASTE,
            blind=self.blind // HASTE,
        )

    def restart(self) -> None:
        """Start the clock anew."""
        self.start = time.perf_counter()

    def elapsed(self) -> float:
        """Seconds since the start."""
        return time.perf_counter() - self.start

    def check(self) -> None:
        """Raise `OutOfTimeError` where the time is over."""
        if self.timeout is not None and self.elapsed() > self.timeout:
            raise OutOfTimeError
