"""Whether base, arm and fingers, moving at once, keep their limits of speed, acceleration and jerk.

Way points are short times apart. The k-th divided difference of a coordinate at k + 1 of them,
times k!, is a mean of its k-th derivative over that time (Hermite-Genocchi, with a B-spline for
weight): a motion that passes the way points and keeps a limit has no divided difference beyond
it. Before the first and after the last way point the robot rests.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.judge.limits import CREEP, LIMIT_SLACK, SPEED_SLACK, TICK, finger_time
from runtime.robot.model import Ints, RobotModel
from runtime.world.poses import Floats

SHORTEST, LONGEST = 0.02, 0.1
"""Seconds between neighbouring way points: closer ones would drown in rounding, others could
hide a motion in between."""

SIDEWAYS = 0.01
"""Share of a step of the base by which one that cannot move sideways may miss its heading."""

NAMES = ("faster", "changes its speed faster", "changes its acceleration faster")

Means = tuple[Floats, Floats, Ints]
"""Means of a derivative (r, d), what rounding may do to them (r, 1), and the way points (r,) at
which the stretches begin."""

Fault = tuple[int, str]
"""A way point, and what is wrong there."""


class Underway:
    """A motion so far: its way points, and the actions that they belong to."""

    def __init__(self) -> None:
        self._rows: list[Floats] = []
        self._times: list[Floats] = []
        self._owners: list[int] = []

    def add(self, action: int, rows: Floats, times: Floats) -> None:
        """More of it: rows (k, 3 + n + 1) of base pose, joints and opening, the first of which is
        the last one that is there, at times (k,) from its start."""
        skip = 1 if self._rows else 0
        start = self._times[-1][-1] if self._times else 0.0
        self._rows.append(rows[skip:])
        self._times.append(start + times[skip:])
        self._owners += [action] * (len(rows) - skip)

    def fault(self, robot: RobotModel) -> tuple[int, str] | None:
        """The action in which a limit is passed, and how."""
        if not self._owners:
            return None
        rows, times = np.vstack(self._rows), np.concatenate(self._times)
        found = together_fault(robot, times, rows[:, :3], rows[:, 3:-1], rows[:, -1])
        return None if found is None else (self._owners[found[0]], found[1])


def together_fault(
    robot: RobotModel, times: Floats, base: Floats, path: Floats, openings: Floats
) -> Fault | None:
    """What is wrong with a motion from rest to rest: times (k,), base poses (k, 3), values of
    the planning joints (k, n), openings of the gripper (k,)."""
    beyond = np.maximum(robot.lower - path, path - robot.upper)
    if beyond.max() > LIMIT_SLACK:
        row, joint = np.unravel_index(int(beyond.argmax()), beyond.shape)
        return int(row), f"{robot.joints[joint]} leaves its limits by {beyond.max():.4f}"
    steps = np.diff(times)
    odd = np.flatnonzero((steps < SHORTEST - TICK) | (steps > LONGEST + TICK))
    if len(odd):
        return int(odd[0]), (
            f"way points are {steps[odd[0]]:.4f} s apart, not between {SHORTEST:g} and "
            f"{LONGEST:g} s"
        )
    return (
        _joint_fault(robot, times, path)
        or _base_fault(robot, times, base)
        or _finger_fault(robot, times, openings)
    )


def derivatives(times: Floats, values: Floats) -> list[Means]:
    """The first three derivatives of coordinates (k, d) that rest before and after."""
    if len(times) < 2:
        return []
    ahead, behind = times[1] - times[0], times[-1] - times[-2]
    t = np.concatenate(
        [times[0] - ahead * np.arange(3, 0, -1), times, times[-1] + behind * np.arange(1, 4)]
    )
    level = np.vstack([np.repeat(values[:1], 3, axis=0), values, np.repeat(values[-1:], 3, axis=0)])
    error = np.full((len(t), 1), TICK / 2)
    found = []
    for order in (1, 2, 3):
        span = (t[order:] - t[:-order])[:, None]
        # Times are rounded as well: a speed moves by so much for each second.
        off = error[1:] + error[:-1] + (np.abs(np.diff(level, axis=0)).max(axis=1, keepdims=True)
              * TICK / span if order == 1 else 0.0)  # fmt: skip
        level, error = order * np.diff(level, axis=0) / span, order * off / span
        first = np.clip(np.arange(len(level)) - 3, 0, len(times) - 1)
        found.append((level, error, first))
    return found


def _joint_fault(robot: RobotModel, times: Floats, path: Floats) -> Fault | None:
    limits = (robot.velocity, robot.acceleration, robot.jerk)
    for (means, rounding, first), limit, name in zip(
        derivatives(times, path), limits, NAMES, strict=False
    ):
        over = np.abs(means) - rounding - limit * SPEED_SLACK
        if over.max() > 0:
            row, joint = np.unravel_index(int(over.argmax()), over.shape)
            most = abs(float(means[row, joint]))
            return int(first[row]), (
                f"{robot.joints[joint]} {_is(name)} than its limit: "
                f"{most:.3g}, at most {limit[joint]:.3g}"
            )
    return None


def _is(name: str) -> str:
    return f"is {name}" if name == NAMES[0] else name


def _base_fault(robot: RobotModel, times: Floats, poses: Floats) -> Fault | None:
    base, moves = robot.base, np.diff(poses, axis=0)
    if base.type == "fixed":
        moved = np.flatnonzero(np.abs(moves).max(axis=1, initial=0.0) > CREEP)
        return (int(moved[0]), "the base moves, which is fixed") if len(moved) else None
    along = np.linalg.norm(moves[:, :2], axis=1)
    way = poses[:, :2]
    if base.type == "differential":
        middle = (poses[1:, 2] + poses[:-1, 2]) / 2
        aside = moves[:, 1] * np.cos(middle) - moves[:, 0] * np.sin(middle)
        # What a turn bends a way off its chord is of the second order; see SIDEWAYS.
        astray = np.flatnonzero(np.abs(aside) > CREEP + SIDEWAYS * along)
        if len(astray):
            said = "the base moves sideways, which a differential drive cannot"
            return int(astray[0]), said
        ahead = moves[:, 0] * np.cos(middle) + moves[:, 1] * np.sin(middle)
        way = np.concatenate([[0.0], np.cumsum(ahead)])[:, None]
    limits = (
        (way, (base.velocity, base.acceleration, base.jerk), "the base"),
        (
            poses[:, 2:],
            (base.angular_velocity, base.angular_acceleration, base.angular_jerk),
            "the base, turning,",
        ),
    )
    for values, most, what in limits:
        for (means, rounding, first), limit, name in zip(
            derivatives(times, values), most, NAMES, strict=False
        ):
            size = np.linalg.norm(means, axis=1)
            over = size - math.sqrt(2) * rounding[:, 0] - limit * SPEED_SLACK
            if over.max() > 0:
                row = int(over.argmax())
                return int(first[row]), (
                    f"{what} {_is(name)} than its limits: {size[row]:.3g}, at most {limit:.3g}"
                )
    return None


def _finger_fault(robot: RobotModel, times: Floats, openings: Floats) -> Fault | None:
    gripper = robot.gripper
    outside = (openings < gripper.min_opening - LIMIT_SLACK) | (
        openings > gripper.max_opening + LIMIT_SLACK
    )
    if outside.any():
        row = int(outside.argmax())
        return row, f"the gripper cannot open {openings[row]:.4f} m"
    for row in np.flatnonzero(np.abs(np.diff(openings)) > TICK).tolist():
        before, after = float(openings[row]), float(openings[row + 1])
        seconds = float(times[row + 1] - times[row]) + TICK
        if finger_time(robot, before, after) > seconds * SPEED_SLACK + 1e-4:
            return row, "the fingers are faster than their limit"
    return None
