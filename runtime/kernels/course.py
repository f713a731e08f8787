"""How fast a path of way points can be followed, and where one is then at each tick.

The speed along the path is bounded by the velocities of its coordinates, at the way points by
what their accelerations can turn there, and in between by speeding up and slowing down as hard
as the tightest coordinate allows: one pass forwards and one backwards, as in time-optimal path
parametrisation (Bobrow et al. 1985, Pham 2014).
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.compiled import njit

TINY = 1e-9


@njit(cache=True)
def speeds(path, velocity, acceleration, turning, jump):  # type: ignore[no-untyped-def]
    """For a path (p, d) the lengths of its lines (p - 1,), the speeds at its way points (p,), the
    first and the last 0, and the most speed and acceleration on each line (p - 1,).

    A way point is passed so slowly that its turn takes no more than the accelerations `turning`
    (d,) on the way to the next one, and that no speed changes by more than its `jump` (d,).
    """
    count, d = path.shape
    lengths = np.zeros(count - 1)
    fastest = np.full(count - 1, np.inf)
    hardest = np.full(count - 1, np.inf)
    direction = np.zeros((count - 1, d))
    for i in range(count - 1):
        total = 0.0
        for k in range(d):
            step = path[i + 1, k] - path[i, k]
            direction[i, k] = step
            total += step * step
        lengths[i] = math.sqrt(total)
        for k in range(d):
            direction[i, k] /= max(lengths[i], TINY)
            size = abs(direction[i, k])
            if size > TINY:
                fastest[i] = min(fastest[i], velocity[k] / size)
                hardest[i] = min(hardest[i], acceleration[k] / size)
    speed = np.zeros(count)
    for i in range(1, count - 1):
        room = min(lengths[i - 1], lengths[i])
        turned = np.inf
        jumped = np.inf
        for k in range(d):
            turn = abs(direction[i, k] - direction[i - 1, k])
            if turn > TINY:
                turned = min(turned, math.sqrt(turning[k] * room / turn))
                jumped = min(jumped, jump[k] / turn)
        speed[i] = min(turned, jumped, fastest[i - 1], fastest[i])
    for i in range(count - 1):
        reached = math.sqrt(speed[i] * speed[i] + 2 * hardest[i] * lengths[i])
        speed[i + 1] = min(speed[i + 1], reached)
    for i in range(count - 2, -1, -1):
        reached = math.sqrt(speed[i + 1] * speed[i + 1] + 2 * hardest[i] * lengths[i])
        speed[i] = min(speed[i], reached)
    return lengths, speed, fastest, hardest


@njit(cache=True)
def marks(lengths, speed, fastest, hardest):  # type: ignore[no-untyped-def]
    """Times (p,) at the way points, and the highest speed on each line (p - 1,)."""
    count = lengths.shape[0]
    times = np.zeros(count + 1)
    peaks = np.zeros(count)
    for i in range(count):
        first = speed[i]
        last = speed[i + 1]
        top = math.sqrt((2 * hardest[i] * lengths[i] + first * first + last * last) / 2)
        top = max(min(fastest[i], top), first, last, TINY)
        covered = (2 * top * top - first * first - last * last) / (2 * hardest[i])
        level = max(0.0, lengths[i] - covered) / top
        times[i + 1] = times[i] + (2 * top - first - last) / hardest[i] + level
        peaks[i] = top
    return times, peaks


@njit(cache=True)
def samples(path, lengths, speed, hardest, times, peaks, tick):  # type: ignore[no-untyped-def]
    """The path at every tick (m, d), from its start to the first tick after its end."""
    d = path.shape[1]
    count = math.ceil(times[-1] / tick - 1e-9) + 1
    out = np.empty((count, d))
    line = 0
    for j in range(count):
        t = min(j * tick, times[-1])
        while line < lengths.shape[0] - 1 and t > times[line + 1]:
            line += 1
        now = t - times[line]
        left = times[line + 1] - t
        up = (peaks[line] - speed[line]) / hardest[line]
        down = (peaks[line] - speed[line + 1]) / hardest[line]
        if now <= up:
            way = speed[line] * now + hardest[line] * now * now / 2
        elif left <= down:
            way = lengths[line] - (speed[line + 1] * left + hardest[line] * left * left / 2)
        else:
            climbed = (peaks[line] ** 2 - speed[line] ** 2) / (2 * hardest[line])
            way = climbed + peaks[line] * (now - up)
        share = min(1.0, max(0.0, way / max(lengths[line], TINY)))
        for k in range(d):
            out[j, k] = path[line, k] + share * (path[line + 1, k] - path[line, k])
    for k in range(d):
        out[count - 1, k] = path[-1, k]
    return out


@njit(cache=True)
def averaged(fine, window, stride):  # type: ignore[no-untyped-def]
    """The mean of the last `window` rows at every `stride`-th row, at rest before the first and
    after the last: so many rows that the last is the last of `fine` (m, d)."""
    count, d = fine.shape
    total = count - 1 + window
    rows = math.ceil(total / stride) + 1
    out = np.empty((rows, d))
    for k in range(d):
        # The sum over rows j - window < i <= j, kept up as j goes on.
        summed = window * fine[0, k]
        at = 0
        for r in range(rows):
            goal = r * stride
            while at < goal:
                at += 1
                summed += fine[min(at, count - 1), k]
                summed -= fine[min(max(at - window, 0), count - 1), k]
            out[r, k] = summed / window
        out[0, k] = fine[0, k]
        out[rows - 1, k] = fine[count - 1, k]
    return out


@njit(cache=True)
def excess(rows, tick, velocity, acceleration, jerk):  # type: ignore[no-untyped-def]
    """By which factor a motion, at rest before and after, would have to be slower to keep the
    limits of its coordinates: 1 or less where it keeps them."""
    count, d = rows.shape
    most = 0.0
    for k in range(d):
        for i in range(-3, count):
            a = rows[min(max(i, 0), count - 1), k]
            b = rows[min(max(i + 1, 0), count - 1), k]
            c = rows[min(max(i + 2, 0), count - 1), k]
            e = rows[min(max(i + 3, 0), count - 1), k]
            most = max(most, abs(b - a) / tick / velocity[k])
            most = max(most, math.sqrt(abs(c - 2 * b + a) / (tick * tick) / acceleration[k]))
            most = max(most, (abs(e - 3 * c + 3 * b - a) / tick**3 / jerk[k]) ** (1 / 3))
    return most
