"""Ways on which the joints do not move all at once: first some of them, then the others.

Where the straight line between two postures is barred, mostly one of these is free: the arm is
folded before the lift goes down, or turned before it is stretched. There are 2^n - 2 of them for
n joints, no random number decides, and what fails fails after a few tests.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from runtime.kernels.advance import path_collides
from runtime.kernels.arm import collides


@njit(cache=True)
def quickest_staged(chain, body, obstacles, margin, sweep, velocity, start, goal):  # type: ignore[no-untyped-def]
    """The joints, as bits, that move first on the quickest free way from `start` to `goal` (n,)
    in two stages; 0 where none is free. The time of a stage is that of its slowest joint."""
    n = start.shape[0]
    frames = np.empty((n + 1, 3, 4))
    placed = np.empty((body.frame.shape[0], 3, 4))
    path = np.empty((3, n))
    path[0] = start
    path[2] = goal
    seconds = np.abs(goal - start) / velocity
    durations = _durations(seconds)
    for first in np.argsort(durations, kind="mergesort"):
        if durations[first] == math.inf:
            break
        for k in range(n):
            path[1, k] = goal[k] if (first >> k) & 1 else start[k]
        if (
            not collides(chain, body, obstacles, margin, path[1], frames, placed)
            and not _collides_grossly(chain, body, obstacles, margin, path, frames, placed)
            and path_collides(chain, body, obstacles, margin, sweep, path) < 0
        ):
            return first
    return 0


@njit(cache=True)
def _collides_grossly(chain, body, obstacles, margin, path, frames, placed):  # type: ignore[no-untyped-def]
    """Whether one of a few postures on the lines of a path is not free: of all lines the middle,
    then the quarters."""
    for parts in (2, 4):
        for j in range(1, parts, 2):
            for k in range(path.shape[0] - 1):
                q = path[k] + (j / parts) * (path[k + 1] - path[k])
                if collides(chain, body, obstacles, margin, q, frames, placed):
                    return True
    return False


@njit(cache=True)
def _durations(seconds):  # type: ignore[no-untyped-def]
    """For every set of joints, as bits: how long it takes if these move first, then the others."""
    out = np.empty(2 ** seconds.shape[0])
    for first in range(out.shape[0]):
        before = 0.0
        after = 0.0
        for k in range(seconds.shape[0]):
            if (first >> k) & 1:
                before = max(before, seconds[k])
            else:
                after = max(after, seconds[k])
        out[first] = before + after if before > 0.0 and after > 0.0 else math.inf
    return out
