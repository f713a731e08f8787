"""Counts and times of the three steps of the executability function X."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

STEPS = ("in_arm_workspace", "inverse_kinematics", "motion_plan")


@dataclass
class Step:
    """How often a step was asked, how often it said yes, and how long it took (s)."""

    calls: int = 0
    successes: int = 0
    time_s: float = 0.0

    @contextmanager
    def timed(self) -> Iterator[None]:
        """Add the time of a block to this step."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.time_s += time.perf_counter() - start

    def record(self, successes: int, calls: int = 1) -> None:
        """Count questions and how many were answered with yes."""
        self.calls += calls
        self.successes += successes


@dataclass
class Profile:
    """The profile of X over a run (paper, Table 2)."""

    in_arm_workspace: Step = field(default_factory=Step)
    inverse_kinematics: Step = field(default_factory=Step)
    motion_plan: Step = field(default_factory=Step)

    def as_dict(self) -> dict[str, dict[str, float]]:
        """For `run --json`."""
        return {
            name: {
                "calls": step.calls,
                "successes": step.successes,
                "time_s": round(step.time_s, 6),
            }
            for name, step in ((name, getattr(self, name)) for name in STEPS)
        }

    def rejections(self) -> dict[str, int]:
        """How many candidates died at each step."""
        return {
            name: step.calls - step.successes
            for name, step in ((name, getattr(self, name)) for name in STEPS)
        }
