"""Ways of the base from pose to pose, the quickest first, as rows of poses a tick apart.

A differential base drives along curves, forwards or backwards, with a cusp in between where that
is quicker than turning around; else it turns on the spot, drives straight, and turns again. A
holonomic one turns while it drives.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from runtime.angles import wrap
from runtime.kernels import curves
from runtime.kernels.follow import KEPT, TRIES
from runtime.motion.course import TICK, Limits, base_limits, course, line, with_stops
from runtime.motion.roads import Stand
from runtime.robot.model import Floats, RobotModel

TANGENTS = np.array([0.4, 0.7, 1.0, 1.5])
"""Lengths of the tangents of curves, as shares of the chord."""

CUSPS = np.array([0.3, 0.5, 0.8])
"""Metres of cusps from the start or the goal of a drive."""

TURNING = 0.8
"""What of the acceleration limits changes of curvature may take."""

CHOICES = 3
"""Curves that are offered."""


def drives(
    robot: RobotModel,
    start: Stand,
    goal: Stand,
    known: Floats,
    turns: bool,
    boxes: Floats,
    clearance: Floats,
) -> list[Floats]:
    """Drives as rows (m, 3) of x, y and heading, unwrapped, the quickest first. Poses `known`
    (k, 3) are a way that is known to be free; where the base `turns` at both ends, it may turn
    on the spot all along it. Curves keep `clearance` (w,) from upright boxes (w, 8). The last
    drive is on the known way."""
    limits = base_limits(robot)
    if robot.base.type == "holonomic":
        return [_sliding(known, start, goal, limits)]
    if turns:
        known = _least_turns(known, start, goal)
    surely = _turning(known, limits)
    found = [surely]
    if turns and math.hypot(goal[0] - start[0], goal[1] - start[1]) > 0.05:
        found += _curves(start, goal, limits, boxes, clearance)
    quicker = sorted((d for d in found if len(d) <= len(surely)), key=len)
    return [*(d for d in quicker if d is not surely), surely]


def _curves(
    start: Stand, goal: Stand, limits: Limits, boxes: Floats, clearance: Floats
) -> list[Floats]:
    times, told = curves.survey(
        np.array(start), np.array(goal), TANGENTS, CUSPS, limits.velocity, limits.acceleration,
        TURNING * limits.acceleration, boxes, clearance,
    )  # fmt: skip
    best = [row for row in np.argsort(times)[:CHOICES] if np.isfinite(times[row])]
    return [_followed(start, goal, told[row].tolist(), limits) for row in best]


def _followed(start: Stand, goal: Stand, told: list[float], limits: Limits) -> Floats:
    """Rows (m, 3) along a curve of the survey."""
    way, share, cusped, x, y, yaw = told
    ends = [start, (x, y, yaw), goal] if cusped else [start, goal]
    rows: list[Floats] = []
    heading = start[2]
    for a, b in pairwise(ends):
        size = share * math.hypot(b[0] - a[0], b[1] - a[1])
        piece = _along((a[0], a[1], heading), b, way, size, limits)
        rows.append(piece[min(1, len(rows)) :])
        heading, way = float(piece[-1, 2]), -way
    return np.vstack(rows)


def _along(a: Stand, b: Stand, way: float, size: float, limits: Limits) -> Floats:
    """Rows (m, 3) along a curve, within the limits where they are measured: from row to row."""
    points, slower = curves.way_points(a, b, way, size), 1.0
    for _ in range(TRIES):
        followed = course(points, limits.slower(slower), TURNING)
        rows, over = curves.on_curve(a, b, way * size, points, followed, limits.packed, TICK)
        if over <= KEPT:
            break
        slower *= over
    return rows  # type: ignore[no-any-return]


def _turning(poses: Floats, limits: Limits) -> Floats:
    """Rows of turns on the spot and straight lines, with stops in between."""
    rows = [poses[:1]]
    for a, b in pairwise(poses):
        if abs(b[2] - a[2]) > 1e-9:
            turn = line(np.array([b[2] - a[2]]), _one(limits, 1))
            rows.append(a + turn[1:] * [0.0, 0.0, 1.0])
        if np.abs(b[:2] - a[:2]).max() > 1e-9:
            share = line(np.array([math.hypot(*(b[:2] - a[:2]))]), _one(limits, 0))
            step = np.array([*(b[:2] - a[:2]), 0.0]) / float(share[-1, 0])
            rows.append([*a[:2], b[2]] + share[1:] * step)
    return np.vstack(rows)


def _one(limits: Limits, k: int) -> Limits:
    return limits.of(np.array([k]))


def _least_turns(points: Floats, start: Stand, goal: Stand) -> Floats:
    """Poses of a way with each line driven forwards or backwards, so that the turns take as
    little as they can."""
    xy = [points[0, :2]]
    for point in points[1:, :2]:
        if math.hypot(*(point - xy[-1])) > 1e-9:
            xy.append(point)
    bearings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(xy)]
    # For each line and both ways to drive it: turns so far, and the headings that lead there.
    best: list[tuple[float, list[float]]] = [(0.0, [start[2]])]
    for bearing in [*bearings, None]:
        ends = [goal[2]] if bearing is None else [bearing, bearing + math.pi]
        nearest = []
        for end in ends:
            options = [
                (turned + abs(wrap(end - way[-1])), [*way, way[-1] + wrap(end - way[-1])])
                for turned, way in best
            ]
            nearest.append(min(options, key=lambda option: option[0]))
        best = nearest
    headings = best[0][1]
    poses = [(*xy[0], start[2])]
    for i in range(len(bearings)):
        poses += [(*xy[i], headings[i + 1]), (*xy[i + 1], headings[i + 1])]
    poses.append((*xy[-1], headings[-1]))
    return np.array(poses)


def _sliding(points: Floats, start: Stand, goal: Stand, limits: Limits) -> Floats:
    """Rows of a base that drives in any direction, and turns while it does."""
    xy = points[:, :2]
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(xy, axis=0), axis=1))])
    turn = wrap(goal[2] - start[2])
    way = with_stops(np.unique(lengths)[:, None], _one(limits, 0))
    spin = line(np.array([turn]), _one(limits, 1))
    count = max(len(way), len(spin))
    at = way[np.minimum(np.arange(count), len(way) - 1), 0]
    yaw = start[2] + spin[np.minimum(np.arange(count), len(spin) - 1), 0]
    keep = np.concatenate([[True], np.diff(lengths) > 1e-12])
    x, y = (np.interp(at, lengths[keep], xy[keep, k]) for k in (0, 1))
    return np.column_stack([x, y, yaw])
