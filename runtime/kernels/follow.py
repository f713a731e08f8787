"""Rows of motions along paths, and sums of them, within the limits of every coordinate.

`limits` are rows of the highest velocity, acceleration and jerk and of the lowest and highest
value of each coordinate, (5, d).
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.compiled import njit
from runtime.kernels.course import averaged, excess, marks, samples, speeds

TRIES = 8
KEPT = 1.0005
"""Factor by which limits may be passed: rounding."""

ROUNDED = 1e-6
"""How far a value may be beyond its range (rad, m): rounding."""

TURNING, REST = 0.3, 0.9
"""What of the acceleration limits changes of direction may take, and what speeding up and
slowing down; together a little more than all of it, for they rarely come together."""

SAME = 1e-9
"""Way points that are nearer to each other than this are one."""

SHARES = np.array([0.5, 0.3, 0.15])
"""Of a motion the shares by which it may begin before the one before has ended, as tried."""


@njit(cache=True)
def over(rows, tick, limits):  # type: ignore[no-untyped-def]
    """By which factor a motion in rows (m, d) would have to be slower to keep the limits; up to 1
    where it keeps them, infinite where it leaves its range."""
    for i in range(rows.shape[0]):
        for k in range(rows.shape[1]):
            if rows[i, k] < limits[3, k] - ROUNDED or rows[i, k] > limits[4, k] + ROUNDED:
                return np.inf
    return excess(rows, tick, limits[0], limits[1], limits[2])


@njit(cache=True)
def follow(path, limits, share, tick, fine):  # type: ignore[no-untyped-def]
    """Rows (m, d), a tick apart, of a motion along a path (p, d) without sharp corners, from rest
    to rest, averaged over samples of which there are `fine` a tick; `share` of the accelerations
    is for changes of direction. And whether it keeps the limits."""
    d = path.shape[1]
    points = np.empty(path.shape)
    points[0] = path[0]
    count = 1
    for i in range(1, path.shape[0]):
        moved = 0.0
        for k in range(d):
            moved = max(moved, abs(path[i, k] - path[i - 1, k]))
        if moved > SAME:
            points[count] = path[i]
            count += 1
    points = points[:count]
    if count < 2:
        return points, True
    rest = 1.0 if count == 2 else REST
    seconds = 0.0
    for k in range(d):
        seconds = max(seconds, 2 * limits[1, k] / limits[2, k])
    window = max(1, math.ceil(seconds * fine / tick - 1e-6))
    slower = 1.0
    rows = points
    for _ in range(TRIES):
        velocity, acceleration = limits[0] / slower, limits[1] / slower**2
        turning = share * acceleration
        lengths, speed, fastest, hardest = speeds(
            points, velocity, rest * acceleration, turning, turning * (window * tick / fine)
        )
        times, peaks = marks(lengths, speed, fastest, hardest)
        sampled = samples(points, lengths, speed, hardest, times, peaks, tick / fine)
        rows = averaged(sampled, window, fine)
        factor = over(rows, tick, limits)
        if factor <= KEPT:
            return rows, True
        if factor == np.inf:
            break
        slower *= 1.001 * factor
    return rows, False


@njit(cache=True)
def line(span, limits, tick, fine):  # type: ignore[no-untyped-def]
    """Rows (m, d) from zero to `span` (d,), all coordinates in step."""
    d = span.shape[0]
    longest = 0.0
    for k in range(d):
        longest = max(longest, abs(span[k]))
    if longest < SAME:
        return np.zeros((1, d))
    along = np.empty((5, 1))
    along[:3] = np.inf
    along[3], along[4] = -np.inf, np.inf
    for k in range(d):
        size = max(abs(span[k]), 1e-9)
        for i in range(3):
            along[i, 0] = min(along[i, 0], limits[i, k] / size)
    ends = np.zeros((2, 1))
    ends[1, 0] = 1.0
    share, _ = follow(ends, along, TURNING, tick, fine)
    rows = np.empty((share.shape[0], d))
    for i in range(share.shape[0]):
        for k in range(d):
            rows[i, k] = share[i, 0] * span[k]
    return rows


@njit(cache=True)
def with_stops(path, limits, tick, fine):  # type: ignore[no-untyped-def]
    """Rows (m, d) along a path (p, d) with a stop at every way point."""
    rows = np.empty((256, path.shape[1]))
    rows[0] = path[0]
    count = 1
    for i in range(path.shape[0] - 1):
        part = line(path[i + 1] - path[i], limits, tick, fine)
        if count + part.shape[0] > rows.shape[0]:
            longer = np.empty((2 * (count + part.shape[0]), path.shape[1]))
            longer[:count] = rows[:count]
            rows = longer
        for j in range(1, part.shape[0]):
            for k in range(path.shape[1]):
                rows[count, k] = path[i, k] + part[j, k]
            count += 1
    return rows[:count].copy()


@njit(cache=True)
def course(path, limits, share, tick, fine):  # type: ignore[no-untyped-def]
    """Rows (m, d) along a path (p, d) without sharp corners, with stops where nothing else keeps
    the limits."""
    rows, kept = follow(path, limits, share, tick, fine)
    return rows if kept else with_stops(path, limits, tick, fine)


@njit(cache=True)
def added(rows, more, start):  # type: ignore[no-untyped-def]
    """The sum of a motion (m, d) and of another one that starts at a tick; negative starts are
    earlier than the first row."""
    count, other, d = rows.shape[0], more.shape[0], rows.shape[1]
    length = max(count, start + other)
    summed = np.empty((length, d))
    for i in range(length):
        at = min(i, count - 1)
        then = min(max(i - start, 0), other - 1)
        for k in range(d):
            summed[i, k] = rows[at, k] + more[then, k] - more[0, k]
    return summed


@njit(cache=True)
def earlier(rows, more, after, limits, tick, wanted):  # type: ignore[no-untyped-def]
    """The first few ticks (s,) at which a motion may begin before another one has ended, the
    earliest first, so that their sum keeps the limits; not before tick `after`."""
    latest = rows.shape[0] - 1
    earliest = max(after, latest - more.shape[0] + 1)
    starts = np.empty(SHARES.shape[0], dtype=np.int64)
    found = 0
    for share in SHARES:
        start = latest - int(share * min(more.shape[0], latest - after))
        if found == wanted:
            break
        if earliest <= start < latest and over(added(rows, more, start), tick, limits) <= KEPT:
            starts[found] = start
            found += 1
    return starts[:found]


@njit(cache=True)
def overlaid(leaving, straight, out, coming, start, limits, tick):  # type: ignore[no-untyped-def]
    """Rows of a motion with two more: one from tick `out` on, one from `start` on, which comes
    later as far as the sum does not keep the limits before the first is over; and that tick."""
    both = added(leaving, straight, out)
    rows = added(both, coming, start)
    while start < leaving.shape[0] - 1 and over(rows, tick, limits) > KEPT:
        start += 2
        rows = added(both, coming, start)
    return rows, start


@njit(cache=True)
def with_base(drive, arm, start):  # type: ignore[no-untyped-def]
    """Rows (m, b + n) of a base whose drive (k, b) begins at a tick and of an arm (m, n)."""
    count, b, n = arm.shape[0], drive.shape[1], arm.shape[1]
    rows = np.empty((count, b + n))
    for i in range(count):
        rows[i, :b] = drive[min(max(i - start, 0), drive.shape[0] - 1)]
        rows[i, b:] = arm[i]
    return rows
