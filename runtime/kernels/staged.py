"""Ways on which the joints do not move all at once: first some of them, then the others.

Where the straight line between two postures is barred, mostly one of these is free: the arm is
folded before the lift goes down, or turned before it is stretched. There are 2^n - 2 of them for
n joints, no random number decides, and what fails fails after a few tests. Joints that hardly move
anything go halfway first and halfway then: which of them comes first makes no difference, and each
would double the number of ways.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.advance import dense, first_hit
from runtime.kernels.arm import collides
from runtime.kernels.compiled import njit

HARDLY = 0.12
"""Metres that a joint moves parts at most, from start to goal, so that it counts as hardly moving
anything."""


@njit(cache=True)
def quickest_corner(  # type: ignore[no-untyped-def]
    chain, body, obstacles, lowest, margin, sweep, velocity, start, goal
):
    """The posture (n,) between the stages of the quickest free way from `start` to `goal` (n,) in
    two stages, and whether there is one. The time of a stage is that of its slowest joint. What
    a few postures do not show to be barred is tested as a whole, as by `first_hit`."""
    n = start.shape[0]
    frames = np.empty((n + 1, 3, 4))
    placed = np.empty((body.frame.shape[0], 3, 4))
    path = np.empty((3, n))
    path[0] = start
    path[1] = (start + goal) / 2
    path[2] = goal
    moving = np.flatnonzero(np.abs(goal - start) * sweep[n] > HARDLY)
    seconds = np.abs(goal - start) / velocity
    least = 0.0  # that joints take which are halfway at the corner
    for k in range(n):
        if abs(goal[k] - start[k]) * sweep[n, k] <= HARDLY:
            least = max(least, seconds[k] / 2)
    durations = _durations(seconds[moving], least)
    for first in np.argsort(durations, kind="mergesort"):
        if durations[first] == math.inf:
            break
        for bit in range(moving.shape[0]):
            k = moving[bit]
            path[1, k] = goal[k] if (first >> bit) & 1 else start[k]
        if not collides(
            chain, body, obstacles, margin, path[1], frames, placed
        ) and not _collides_grossly(chain, body, obstacles, margin, path, frames, placed):
            rows, _ = dense(path)
            if first_hit(chain, body, obstacles, lowest, margin, sweep, rows) < 0:
                return path[1], True
    return path[1], False


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
def _durations(seconds, least):  # type: ignore[no-untyped-def]
    """For every set of joints, as bits: how long it takes if these move first, then the others,
    and each stage takes so long at least."""
    out = np.empty(2 ** seconds.shape[0])
    for first in range(out.shape[0]):
        before = 0.0
        after = 0.0
        for k in range(seconds.shape[0]):
            if (first >> k) & 1:
                before = max(before, seconds[k])
            else:
                after = max(after, seconds[k])
        some = before > 0.0 and after > 0.0
        out[first] = max(before, least) + max(after, least) if some else math.inf
    return out
