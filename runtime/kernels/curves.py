"""Curves in the plane on which a base that cannot move sideways drives from pose to pose."""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.compiled import njit
from runtime.kernels.course import excess, marks, speeds

POINTS = 24
"""Way points of a curve while it is looked for."""

DENSE = 128
"""Way points of a curve when it is followed."""


@njit(cache=True)
def curve(x0, y0, yaw0, x1, y1, yaw1, way, first, last, out):  # type: ignore[no-untyped-def]
    """Write poses (k, 3) along a cubic Hermite curve from pose to pose, forwards where `way`
    is 1, backwards where it is -1; `first` and `last` are the lengths of its tangents in metres.
    Headings are those of the curve, not wrapped. False where it has a cusp, or ends turned away.
    """
    ax, ay = way * first * math.cos(yaw0), way * first * math.sin(yaw0)
    bx, by = way * last * math.cos(yaw1), way * last * math.sin(yaw1)
    before = yaw0
    count = out.shape[0]
    for i in range(count):
        t = i / (count - 1)
        h10, h01, h11 = t * (1 - t) ** 2, t * t * (3 - 2 * t), t * t * (t - 1)
        out[i, 0] = x0 + (x1 - x0) * h01 + ax * h10 + bx * h11
        out[i, 1] = y0 + (y1 - y0) * h01 + ay * h10 + by * h11
        dx = 6 * t * (1 - t) * (x1 - x0) + (1 - t) * (1 - 3 * t) * ax + t * (3 * t - 2) * bx
        dy = 6 * t * (1 - t) * (y1 - y0) + (1 - t) * (1 - 3 * t) * ay + t * (3 * t - 2) * by
        if dx * dx + dy * dy < 1e-8:
            return False
        turn = math.atan2(way * dy, way * dx) - before
        turn -= 2 * math.pi * round(turn / (2 * math.pi))
        if abs(turn) > 0.8:
            return False
        before += turn
        out[i, 2] = before
    off = out[count - 1, 2] - yaw1
    return abs(off - 2 * math.pi * round(off / (2 * math.pi))) < 1e-3


@njit(cache=True)
def travelled(poses, way):  # type: ignore[no-untyped-def]
    """The way driven, negative backwards, and the heading at each of some poses (k, 2)."""
    out = np.empty((poses.shape[0], 2))
    out[0, 0] = 0.0
    out[0, 1] = poses[0, 2]
    for i in range(1, poses.shape[0]):
        dx = poses[i, 0] - poses[i - 1, 0]
        dy = poses[i, 1] - poses[i - 1, 1]
        out[i, 0] = out[i - 1, 0] + way * math.sqrt(dx * dx + dy * dy)
        out[i, 1] = poses[i, 2]
    return out


@njit(cache=True)
def driven(rows):  # type: ignore[no-untyped-def]
    """The way driven along the heading, and the heading, at each of some poses (m, 3): (m, 2)."""
    out = np.empty((rows.shape[0], 2))
    out[0, 0] = 0.0
    out[0, 1] = rows[0, 2]
    for i in range(1, rows.shape[0]):
        middle = (rows[i, 2] + rows[i - 1, 2]) / 2
        dx, dy = rows[i, 0] - rows[i - 1, 0], rows[i, 1] - rows[i - 1, 1]
        out[i, 0] = out[i - 1, 0] + dx * math.cos(middle) + dy * math.sin(middle)
        out[i, 1] = rows[i, 2]
    return out


@njit(cache=True)
def way_points(a, b, way, size):  # type: ignore[no-untyped-def]
    """The way driven and the heading (k, 2) along the curve from pose to pose with tangents of
    `size` metres."""
    poses = np.empty((DENSE, 3))
    curve(a[0], a[1], a[2], b[0], b[1], b[2], way, size, size, poses)
    return travelled(poses, way)


@njit(cache=True)
def on_curve(a, b, pull, points, rows, limits, tick):  # type: ignore[no-untyped-def]
    """Poses (m, 3) where so much of a curve is driven, with headings (m, 2), of its way `points`
    (k, 2); and by which factor they would have to be slower to keep the limits, as for
    `runtime.kernels.follow`, where they are measured: from row to row."""
    poses = _on_curve(a, b, pull, points, rows)
    return poses, excess(driven(poses), tick, limits[0], limits[1], limits[2])


@njit(cache=True)
def _on_curve(a, b, pull, points, rows):  # type: ignore[no-untyped-def]
    """Poses (m, 3) where so much of a curve with way `points` (k, 2) is driven."""
    out = np.empty((rows.shape[0], 3))
    last = points.shape[0] - 1
    at = 0
    for i in range(rows.shape[0]):
        driven_here = abs(rows[i, 0])
        while at < last and abs(points[at + 1, 0]) < driven_here:
            at += 1
        while at > 0 and abs(points[at, 0]) > driven_here:
            at -= 1
        share = 1.0
        if at < last:
            low, high = abs(points[at, 0]), abs(points[at + 1, 0])
            share = (at + (driven_here - low) / max(high - low, 1e-12)) / last
        t = min(1.0, max(0.0, share))
        h10, h01, h11 = t * (1 - t) ** 2, t * t * (3 - 2 * t), t * t * (t - 1)
        out[i, 0] = a[0] + (b[0] - a[0]) * h01
        out[i, 0] += pull * (math.cos(a[2]) * h10 + math.cos(b[2]) * h11)
        out[i, 1] = a[1] + (b[1] - a[1]) * h01
        out[i, 1] += pull * (math.sin(a[2]) * h10 + math.sin(b[2]) * h11)
        out[i, 2] = rows[i, 1]
    return out


@njit(cache=True)
def duration(poses, way, velocity, acceleration, turning):  # type: ignore[no-untyped-def]
    """About how long a curve takes."""
    lengths, speed, fastest, hardest = speeds(
        travelled(poses, way), velocity, acceleration, turning, np.full(2, np.inf)
    )
    times, _ = marks(lengths, speed, fastest, hardest)
    return times[-1]


@njit(cache=True)
def survey(start, goal, tangents, cusps, velocity, acceleration, turning, boxes, clearance):  # type: ignore[no-untyped-def]
    """All curves from pose to pose that are tried: those of one piece, and those of two with a
    cusp in between, a little way off from the start or from the goal.

    Returns durations (m,), infinite for none, and what tells a curve: rows (m, 6) of the
    direction of the first piece, its tangents as a share of its chord, 1 where there is a second
    piece, and the cusp's x, y, heading. Only curves whose poses are clear of the boxes count.
    """
    total = 2 * tangents.shape[0] + 12 * cusps.shape[0]
    times = np.full(total, np.inf)
    told = np.zeros((total, 6))
    poses = np.empty((POINTS, 3))
    dx, dy = goal[0] - start[0], goal[1] - start[1]
    chord = math.sqrt(dx * dx + dy * dy)
    row = 0
    for way in (1.0, -1.0):
        for k in range(tangents.shape[0]):
            size = tangents[k] * chord
            found = chord > 1e-3 and curve(
                start[0], start[1], start[2], goal[0], goal[1], goal[2], way, size, size, poses
            )
            if found and _is_clear(poses, boxes, clearance):
                times[row] = duration(poses, way, velocity, acceleration, turning)
            told[row, 0] = way
            told[row, 1] = tangents[k]
            row += 1
    for near in (0, 1):
        pose = start if near == 0 else goal
        for way in (1.0, -1.0):  # of the first piece
            for k in range(cusps.shape[0]):
                cx = pose[0] + way * cusps[k] * math.cos(pose[2])
                cy = pose[1] + way * cusps[k] * math.sin(pose[2])
                other = goal if near == 0 else start
                # The heading at the cusp in which the other pose is straight ahead or behind.
                facing = math.atan2(other[1] - cy, other[0] - cx)
                if (near == 0 and way > 0) or (near == 1 and way < 0):
                    facing += math.pi
                turn = facing - pose[2]
                turn -= 2 * math.pi * round(turn / (2 * math.pi))
                for part in range(3):
                    yaw = pose[2] + turn * (0.4 + 0.3 * part)
                    side = turn * (0.4 + 0.3 * part) / 2
                    mx = pose[0] + way * cusps[k] * math.cos(pose[2] + side)
                    my = pose[1] + way * cusps[k] * math.sin(pose[2] + side)
                    told[row, 0] = way
                    told[row, 1] = 1.0
                    told[row, 2] = 1.0
                    told[row, 3], told[row, 4], told[row, 5] = mx, my, yaw
                    one = math.sqrt((mx - start[0]) ** 2 + (my - start[1]) ** 2)
                    two = math.sqrt((mx - goal[0]) ** 2 + (my - goal[1]) ** 2)
                    if (
                        one > 1e-2
                        and two > 1e-2
                        and curve(start[0], start[1], start[2], mx, my, yaw, way, one, one, poses)
                        and _is_clear(poses, boxes, clearance)
                    ):
                        took = duration(poses, way, velocity, acceleration, turning)
                        if curve(
                            mx, my, yaw, goal[0], goal[1], goal[2], -way, two, two, poses
                        ) and _is_clear(poses, boxes, clearance):
                            times[row] = took + duration(
                                poses, -way, velocity, acceleration, turning
                            )
                    row += 1
    return times, told


@njit(cache=True)
def _is_clear(poses, boxes, clearance):  # type: ignore[no-untyped-def]
    """Whether no pose comes nearer to an upright box (w, 8) than its clearance (w,)."""
    for i in range(poses.shape[0]):
        for w in range(boxes.shape[0]):
            if clearance[w] <= 0.0:
                continue
            dx = poses[i, 0] - boxes[w, 0]
            dy = poses[i, 1] - boxes[w, 1]
            ex = max(abs(boxes[w, 6] * dx + boxes[w, 7] * dy) - boxes[w, 3], 0.0)
            ey = max(abs(boxes[w, 6] * dy - boxes[w, 7] * dx) - boxes[w, 4], 0.0)
            if ex * ex + ey * ey < clearance[w] * clearance[w]:
                return False
    return True
