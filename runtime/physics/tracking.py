"""How far motors are from where they are sent."""

from __future__ import annotations

import numpy as np

from runtime.robot.model import Floats


class Tracking:
    """Root mean square and largest error of each motor: base x, y (m), heading (rad), then
    the planning joints (rad, or m where they slide)."""

    def __init__(self) -> None:
        self.count = 0
        self._squares: Floats = np.zeros(0)
        self._largest: Floats = np.zeros(0)

    def add(self, error: Floats) -> None:
        """Take the errors (3 + n,) of one moment."""
        if not self.count:
            self._squares, self._largest = np.zeros_like(error), np.zeros_like(error)
        self.count += 1
        self._squares += error**2
        self._largest = np.maximum(self._largest, np.abs(error))

    @property
    def rms(self) -> Floats:
        """Root mean squares (3 + n,)."""
        found: Floats = np.sqrt(self._squares / max(1, self.count))
        return found

    @property
    def largest(self) -> Floats:
        """Largest absolute errors (3 + n,)."""
        return self._largest
