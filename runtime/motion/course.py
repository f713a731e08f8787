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
from functools import cached_property
from itertools import pairwise

import numpy as np

from runtime.kernels import follow as kernel
from runtime.kernels.follow import TURNING
from runtime.robot.model import Floats, Ints, RobotModel

TICK = 0.05
"""Seconds between the rows of a motion."""

FINE = 10
"""So many samples a tick are averaged over."""

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

    @cached_property
    def packed(self) -> Floats:
        """The limits as kernels take them (5, d)."""
        d = len(self.velocity)
        within = np.array([np.full(d, -np.inf), np.full(d, np.inf)])
        rates = (self.velocity, self.acceleration, self.jerk)
        return np.array([*rates, *(within if self.within is None else self.within)])

    def excess(self, rows: Floats) -> float:
        """By which factor a motion in rows, at rest before and after, would have to be slower to
        keep the limits; up to 1 where it keeps them, infinite where it leaves its range."""
        found: float = kernel.over(rows, TICK, self.packed)
        return found

    def of(self, chosen: Ints) -> Limits:
        """Those of some of the coordinates."""
        within = None if self.within is None else self.within[:, chosen]
        return Limits(self.velocity[chosen], self.acceleration[chosen], self.jerk[chosen], within)

    def slower(self, factor: float) -> Limits:
        """Those of a motion that takes so many times as long."""
        rates = (self.velocity / factor, self.acceleration / factor**2, self.jerk / factor**3)
        return Limits(*rates, self.within)


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
    rows: Floats = kernel.course(np.ascontiguousarray(path), limits.packed, share, TICK, FINE)
    return rows


def line(span: Floats, limits: Limits) -> Floats:
    """Rows (m, d) from zero to `span` (d,), all coordinates in step."""
    # One kernel follows all paths, that of a single line too: each takes a while to load.
    ends = np.array([np.zeros(len(span)), span])
    if np.abs(span).max(initial=0.0) < kernel.SAME:
        return ends[:1]
    size = np.maximum(np.abs(span), kernel.SAME)
    rates = ((row / size).min() for row in (limits.velocity, limits.acceleration, limits.jerk))
    packed = np.array([[rate] for rate in rates] + [[-np.inf], [np.inf]])
    share = kernel.course(np.array([[0.0], [1.0]]), packed, TURNING, TICK, FINE)
    rows: Floats = share * span
    return rows


def with_stops(path: Floats, limits: Limits) -> Floats:
    """Rows of a motion along a path (p, d) with a stop at every way point: it is on the path
    everywhere."""
    rows: Floats = kernel.with_stops(np.ascontiguousarray(path), limits.packed, TICK, FINE)
    return rows


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
    summed: Floats = kernel.added(rows, more, start)
    return summed


def join(
    courses: Sequence[Floats], limits: Limits, free: Callable[[Floats], bool] | None = None
) -> tuple[Floats, list[int]]:
    """Motions one after the other, each beginning as early as the sum keeps the limits and, where
    that is asked, is `free`; and the tick at which each begins."""
    rows, starts = courses[0], [0]
    for more in courses[1:]:
        start = len(rows) - 1
        wanted = 1 if free is None else len(kernel.SHARES)
        tries = kernel.earlier(rows, more, starts[-1], limits.packed, TICK, wanted)
        for tried in tries.tolist():
            if free is None or free(add(rows, more, tried)[starts[-1] :]):
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
