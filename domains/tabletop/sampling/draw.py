"""One drawing of samples: from which state, after how many failures, and how many."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from domains.tabletop.features.swept import HEADINGS, STEP
from domains.tabletop.state import Grasp, State

GRASPS = 4
PLACEMENTS = 7
BASES = 7
"""Published numbers of samples: grasps an object, placements and base poses a surface."""

DOUBT = 2
"""From this attempt on the features' estimate of what bars the way is no longer believed, and
every grasp, placement and base pose can be sampled; after it, with an object in the gripper,
other objects as well."""


@dataclass(frozen=True, eq=False)
class Draw:
    """Samples are drawn for the subproblem that starts in `state`; `attempt` counts its
    failures so far, and all randomness comes from `rng`."""

    state: State
    attempt: int
    rng: np.random.Generator

    @property
    def scale(self) -> int:
        """Samples are so many times as dense as at the first attempt."""
        return int(2**self.attempt)

    @property
    def doubting(self) -> bool:
        """Whether the features' estimate is no longer believed."""
        return self.attempt >= DOUBT

    @property
    def held(self) -> tuple[int, Grasp]:
        """The held object and how it is held, in a state in which one is."""
        assert self.state.held is not None
        assert self.state.grasp is not None
        return self.state.held, self.state.grasp

    def jitter(self) -> float:
        """A random turn within a step of headings, once the estimate is doubted."""
        return self.rng.uniform(-STEP / 2, STEP / 2) if self.doubting else 0.0


class OpenDraw(Draw):
    """A drawing that does not ask which ways are free now."""

    @property
    def doubting(self) -> bool:
        """The estimate speaks of the start only."""
        return True


def pick_headings(bits: int, number: int, rng: np.random.Generator) -> list[int]:
    """Up to `number` of the headings whose bits are set, spread around the circle."""
    headings = [k for k in range(HEADINGS) if (bits >> k) & 1]
    if len(headings) <= number:
        return headings
    start = rng.integers(len(headings))
    places = (start + np.arange(number) * len(headings) / number) % len(headings)
    return [headings[int(i)] for i in places]
