"""Values over time, exact for motions with piecewise constant acceleration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from runtime.robot.model import Floats


@dataclass(frozen=True, eq=False)
class Track:
    """Values and their velocities (k, n) at times (k,), which rise strictly.

    In between, values follow the cubic polynomial with these values and velocities at both
    ends (Hermite): stretches of constant acceleration need two knots and lose nothing.
    Before the first and after the last knot, values stay.
    """

    times: Floats
    values: Floats
    velocities: Floats

    @property
    def width(self) -> int:
        """How many values there are at a time."""
        return int(self.values.shape[1])

    def at(self, times: Floats) -> tuple[Floats, Floats]:
        """Values and velocities (m, n) at times (m,)."""
        if len(self.times) == 1:
            still = np.repeat(self.values, len(times), axis=0)
            return still, np.zeros_like(still)
        after = np.clip(np.searchsorted(self.times, times, side="right"), 1, len(self.times) - 1)
        before = after - 1
        h = (self.times[after] - self.times[before])[:, None]
        s = np.clip((times - self.times[before])[:, None] / h, 0.0, 1.0)
        p, q = self.values[before], self.values[after]
        u, v = self.velocities[before] * h, self.velocities[after] * h
        a, b = 2 * (p - q) + u + v, 3 * (q - p) - 2 * u - v
        values = ((a * s + b) * s + u) * s + p
        velocities = ((3 * a * s + 2 * b) * s + u) / h
        outside = (times < self.times[0]) | (times > self.times[-1])
        velocities[outside] = 0.0
        return values, velocities


class TrackBuilder:
    """Collects the knots of a track; each stretch starts where the last one ended."""

    def __init__(self, value: Floats) -> None:
        self.times = [0.0]
        self.values = [np.asarray(value, dtype=np.float64)]
        self.velocities = [np.zeros(len(self.values[0]))]

    @property
    def value(self) -> Floats:
        """Where the track is now."""
        return self.values[-1]

    def rest(self, time: float) -> None:
        """Keep the value until a time."""
        self._knot(time, self.values[-1], np.zeros_like(self.values[-1]))

    def line(self, start: float, end: float, goal: Floats, ramp: float) -> None:
        """Go to a value on a straight line from rest to rest, with constant acceleration
        during the first and the last `ramp` (0 to 0.5) of the time."""
        if end <= start:
            return
        self.rest(start)
        origin, step, span = self.values[-1], goal - self.values[-1], end - start
        ramp = min(0.5, max(ramp, 1e-3))
        top = 1.0 / (1.0 - ramp)  # speed on the line [0, 1] of time [0, 1]
        climbed = 0.5 * top * ramp
        speed = step * top / span
        self._knot(start + ramp * span, origin + climbed * step, speed)
        if ramp < 0.5:
            self._knot(end - ramp * span, goal - climbed * step, speed)
        self._knot(end, goal, np.zeros_like(goal))

    def through(self, path: Floats, times: Floats) -> None:
        """Go through values (k, n) at times (k,), from rest to rest. Where the knots lie dense,
        as those of timed arm paths do, the parabola through each three gives the velocity."""
        keep = np.concatenate([[True], np.diff(times) > 1e-9])
        path, times = path[keep], times[keep]
        if len(times) < 2:
            return
        self.rest(float(times[0]))
        velocities = np.gradient(path, times, axis=0)
        velocities[0] = velocities[-1] = 0.0
        for time, value, velocity in zip(times[1:], path[1:], velocities[1:], strict=True):
            self._knot(float(time), value, velocity)

    def _knot(self, time: float, value: Floats, velocity: Floats) -> None:
        if time <= self.times[-1] + 1e-9:
            return
        self.times.append(time)
        self.values.append(value)
        self.velocities.append(velocity)

    def track(self) -> Track:
        """What was collected."""
        return Track(np.array(self.times), np.array(self.values), np.array(self.velocities))
