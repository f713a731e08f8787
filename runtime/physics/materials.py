"""What physics needs to know that neither plan nor robot file say: friction and forces.

These are this project's own choices, not measurements of a robot (`docs/execution.md`).
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Materials:
    """Coefficients of friction (tangential, and torsional in metres), and the force of each
    finger in newtons."""

    friction: float = 0.7
    spinning: float = 0.002
    finger_force: float = 16.0

    @classmethod
    def of(cls, force: float | None) -> Materials:
        """Materials for fingers of some force, or of the usual one where that is not known."""
        return cls() if force is None else cls(finger_force=force)

    @property
    def holding_force(self) -> float:
        """Newtons that two fingers can hold by friction: a grasp breaks above it."""
        return 2 * self.friction * self.finger_force
