"""Smooth motions along a path: speeds, accelerations and jerks within their limits.

A path of way points is followed as fast as speeds and accelerations allow, and that motion is
averaged over a short time (a filter of finite impulse response: Biagiotti & Melchiorri 2012). A
mean of motions within limits is within these limits too, and its acceleration changes by no more
than twice the limit in the time that is averaged over, so the jerk is bounded. Around corners
the motion along the next line begins while that along the last one still ends: sums of motions
within limits, moved as near to each other as their sum keeps the limits. Rows are a tick apart.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from runtime.kernels import course as kernel
from runtime.robot.model import Floats, Ints, RobotModel

TICK = 0.05
"""Seconds between the rows of a motion."""

FINE = 10
"""So many samples a tick are averaged over."""

TURNING, REST = 0.3, 0.9
"""What of the acceleration limits changes of direction may take, and what speeding up and
slowing down; together a little more than all of it, for they rarely come together."""

TRIES = 8
KEPT = 1.0005
"""Factor by which limits may be passed: rounding."""

ROUNDED = 1e-6
"""How far a value may be beyond its range (rad, m): rounding."""

SHARP = math.cos(math.radians(20.0))
"""A path turns a corner where its direction changes by more than this."""


@dataclass(frozen=True, eq=False)
class Limits:
    """Speeds, accelerations and jerks (d,) of some coordinates, and the lowest and highest values
    (2, d) where there are some."""

    velocity: Floats
    acceleration: Floats
    jerk: Floats
    within: Floats | None = None

    @property
    def window(self) -> int:
        """Over how many samples a motion is averaged so that it keeps the jerks."""
        seconds = float((2 * self.acceleration / self.jerk).max())
        return max(1, math.ceil(seconds * FINE / TICK - 1e-6))

    def excess(self, rows: Floats) -> float:
        """By which factor a motion in rows, at rest before and after, would have to be slower to
        keep the limits; up to 1 where it keeps them, infinite where it leaves its range."""
        if self.within is not None:
            beyond = np.maximum(self.within[0] - rows, rows - self.within[1])
            if beyond.max(initial=0.0) > ROUNDED:
                return math.inf
        found: float = kernel.excess(rows, TICK, self.velocity, self.acceleration, self.jerk)
        return found

    def of(self, chosen: Ints) -> Limits:
        """Those of some of the coordinates."""
        within = None if self.within is None else self.within[:, chosen]
        return Limits(self.velocity[chosen], self.acceleration[chosen], self.jerk[chosen], within)

    def slower(self, factor: float) -> Limits:
        """Those of a motion that takes so many times as long."""
        rates = (self.velocity / factor, self.acceleration / factor**2, self.jerk / factor**3)
        return Limits(*rates, self.within)

    def along(self, span: Floats) -> Limits:
        """The limits (1,) of the share of a line (d,)."""
        size = np.maximum(np.abs(span), 1e-9)
        rows = (self.velocity, self.acceleration, self.jerk)
        return Limits(*(np.array([(row / size).min()]) for row in rows))


def arm_limits(robot: RobotModel) -> Limits:
    """The limits of the planning joints."""
    within = np.array([robot.lower, robot.upper])
    return Limits(robot.velocity, robot.acceleration, robot.jerk, within)


def base_limits(robot: RobotModel) -> Limits:
    """The limits of a base: of its speed and of its turning."""
    base = robot.base
    return Limits(
        np.array([base.velocity, base.angular_velocity]),
        np.array([base.acceleration, base.angular_acceleration]),
        np.array([base.jerk, base.angular_jerk]),
    )


def course(path: Floats, limits: Limits, share: float = TURNING) -> Floats:
    """Rows (m, d) of a motion along a path (p, d) without sharp corners, from rest to rest; changes
    of direction may take a `share` of the accelerations."""
    keep = np.concatenate([[True], np.abs(np.diff(path, axis=0)).max(axis=1) > 1e-9])
    path = np.ascontiguousarray(path[keep])
    if len(path) < 2:
        return path
    rest, slower = (1.0 if len(path) == 2 else REST), 1.0
    window = limits.window
    for _ in range(TRIES):
        v, a = limits.velocity / slower, limits.acceleration / slower**2
        turning = share * a
        lengths, speed, fastest, hardest = kernel.speeds(
            path, v, rest * a, turning, turning * (window * TICK / FINE)
        )
        times, peaks = kernel.marks(lengths, speed, fastest, hardest)
        sampled = kernel.samples(path, lengths, speed, hardest, times, peaks, TICK / FINE)
        rows: Floats = kernel.averaged(sampled, window, FINE)
        over = limits.excess(rows)
        if over <= KEPT:
            return rows
        if math.isinf(over):
            break
        slower *= 1.001 * over
    return with_stops(path, limits)


def line(span: Floats, limits: Limits) -> Floats:
    """Rows (m, d) from zero to `span` (d,), all coordinates in step."""
    if np.abs(span).max(initial=0.0) < 1e-9:
        return np.zeros((1, len(span)))
    share = course(np.array([[0.0], [1.0]]), limits.along(span))
    return share * span


def with_stops(path: Floats, limits: Limits) -> Floats:
    """Rows of a motion along a path (p, d) with a stop at every way point: it is on the path
    everywhere."""
    lines = (a + line(b - a, limits)[1:] for a, b in pairwise(path))
    return np.vstack([path[:1], *lines])


def stretches(path: Floats) -> list[Floats]:
    """A path (p, d) cut at its sharp corners."""
    steps = np.diff(path, axis=0)
    keep = np.concatenate([[True], np.linalg.norm(steps, axis=1) > 1e-9])
    path = path[keep]
    if len(path) < 3:
        return [path] if len(path) > 1 else []
    steps = np.diff(path, axis=0)
    steps /= np.linalg.norm(steps, axis=1)[:, None]
    corners = np.flatnonzero((steps[1:] * steps[:-1]).sum(axis=1) < SHARP) + 1
    ends = [0, *corners.tolist(), len(path) - 1]
    return [path[a : b + 1] for a, b in pairwise(ends)]


def add(rows: Floats, more: Floats, start: int) -> Floats:
    """The sum of a motion and of another one that starts at a tick; negative starts are earlier
    than the first row."""
    length = max(len(rows), start + len(more))
    held = rows[np.minimum(np.arange(length), len(rows) - 1)]
    added = more[np.clip(np.arange(length) - start, 0, len(more) - 1)] - more[0]
    summed: Floats = held + added
    return summed


def join(
    courses: Sequence[Floats], limits: Limits, free: Callable[[Floats], bool] | None = None
) -> tuple[Floats, list[int]]:
    """Motions one after the other, each beginning as early as the sum keeps the limits and, where
    that is asked, is `free`; and the tick at which each begins."""
    rows, starts = courses[0], [0]
    for more in courses[1:]:
        latest = len(rows) - 1
        earliest = max(starts[-1], latest - len(more) + 1)
        start = latest
        for share in (0.5, 0.3, 0.15):
            tried = latest - int(share * min(len(more), latest - starts[-1]))
            if tried < earliest or tried >= latest:
                continue
            joined = add(rows, more, tried)
            if limits.excess(joined) <= KEPT and (free is None or free(joined[starts[-1] :])):
                start = tried
                break
        rows = add(rows, more, start)
        starts.append(start)
    return rows, starts


def least_time(distance: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Seconds from rest to rest over a distance, with limits of speed, acceleration and jerk: the
    shortest there is (seven phases, closed form)."""
    if distance <= 0.0:
        return 0.0
    # Accelerating to full speed takes `ramp`, with or without a stretch of full acceleration.
    if velocity * jerk >= acceleration**2:
        ramp = velocity / acceleration + acceleration / jerk
    else:
        ramp = 2 * math.sqrt(velocity / jerk)
    if distance >= velocity * ramp:
        return distance / velocity + ramp
    if distance >= 2 * acceleration**3 / jerk**2:
        half = acceleration / (2 * jerk)
        return 2 * half + 2 * math.sqrt(half**2 + distance / acceleration)
    return 4.0 * math.cbrt(distance / (2 * jerk))
