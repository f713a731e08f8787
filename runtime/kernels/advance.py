"""Collision test of motions: rows of configurations, a straight line from each to the next.

Every part has a question for each obstacle, and every pair of parts has one. A question about a
stretch of the motion looks at its middle: a part whose gap to something is g cannot touch it before
it has moved by g, and `sweep[f, i]` bounds how far a part of frame f moves for one unit of joint i.
What that does not settle is cut in two, so most questions end after a look or two, and only things
that come near each other are looked at row by row, and in between (`runtime.kernels.between`). All
questions are taken to the same depth before one of them goes deeper: what touches grossly is found
early.

Arrays are taken out of their tuples once, for that costs more than a look.
"""

from __future__ import annotations

import numpy as np

from runtime.kernels.arm import CLOSE, forward, place_boxes
from runtime.kernels.between import (
    ends_show,
    gap_of_parts,
    gap_of_solids,
    gap_to_box,
    line_is_free,
)
from runtime.kernels.boxes import distance_squared, pose_vs_pose, pose_vs_upright
from runtime.kernels.compiled import njit

STRETCH = 0.3
"""Metres that parts of the last frame move, at most, in a stretch with which questions begin."""

GLANCE = 8
"""Every so many rows, or twice as many, something that touches grossly is looked for first."""

FINE = 0.05
"""Radians, or metres, of joints between the rows that a path is made of."""


@njit(cache=True)
def first_hit(chain, body, obstacles, lowest, margin, sweep, rows):  # type: ignore[no-untyped-def]
    """The number of a row of a motion (k, n) near which something comes within the margin; or -1:
    then all of it keeps half the margin, in between rows as well. Obstacle w concerns the
    parts of frames from `lowest[w]` on, `lowest` (w,)."""
    count, n = rows.shape
    travel = np.zeros((count, n))
    for i in range(1, count):
        for j in range(n):
            travel[i, j] = travel[i - 1, j] + abs(rows[i, j] - rows[i - 1, j])
    frames = np.empty((n + 1, 3, 4))
    placed = np.empty((count, body.frame.shape[0], 3, 4))
    known = np.zeros(count, dtype=np.bool_)
    # A glance at every so many rows, the middle first: what is not free mostly touches grossly.
    step = _above(count)
    while step > GLANCE // 2:
        for row in range(step, count, 2 * step):
            if not known[row]:
                _place(chain, body, rows[row], frames, placed[row])
                known[row] = True
                if _touches(body, obstacles, lowest, placed[row], margin):
                    return row
        step //= 2
    asked = np.empty((256, 4), dtype=np.int64)  # the two of a question, and the rows it is about
    number = 0
    low = 0
    while True:
        high = _stretch_from(low, travel, sweep)
        middle = (low + high) // 2
        if not known[middle]:
            _place(chain, body, rows[middle], frames, placed[middle])
            known[middle] = True
        asked, number = _open_to_boxes(
            body, obstacles, lowest, margin, sweep, travel, placed[middle], low, high, asked, number
        )
        if number >= 0:
            asked, number = _open_between_parts(
                body, obstacles, margin, sweep, travel, placed[middle], low, high, asked, number
            )
        if number < 0:
            return middle
        low = high
        if low >= count - 1:
            break
    return _first_of(
        chain, body, obstacles, margin, sweep, rows, travel, frames, placed, known, asked, number
    )


@njit(cache=True)
def _open_to_boxes(  # type: ignore[no-untyped-def]
    body, obstacles, lowest, margin, sweep, travel, poses, low, high, asked, number
):
    """The questions, and how many, with those about parts and obstacles that the middle of a
    stretch, where parts are at poses (m, 3, 4), leaves open; -1 for contact there."""
    frame, half, radius, shape = body.frame, body.half, body.radius, body.shape
    boxes, shapes = obstacles.rows, obstacles.shape
    middle = (low + high) // 2
    moves = np.empty(sweep.shape[0])
    for f in range(sweep.shape[0]):
        moves[f] = _half_way(sweep, travel, 0, f, low, middle, high)
    for b in range(boxes.shape[0]):
        x, y, z = boxes[b, 0], boxes[b, 1], boxes[b, 2]
        hx, hy, hz, c, s = boxes[b, 3], boxes[b, 4], boxes[b, 5], boxes[b, 6], boxes[b, 7]
        for a in range(frame.shape[0]):
            if frame[a] < lowest[b]:
                continue
            moved = moves[frame[a]]
            reach = radius[a] + moved + margin
            if distance_squared(poses, a, x, y, z, hx, hy, hz, c, s) > reach * reach:
                continue
            gap = gap_to_box(poses, half, radius, boxes, a, b, margin, moved + margin)
            if gap < CLOSE and (shape[a] >= 0 or shapes[b] >= 0):
                gap = gap_of_solids(body, obstacles, poses, a, b, margin, moved + margin)
            if gap < 0.0:
                return asked, -1
            if gap - 0.5 * margin < moved:
                asked = _noted(asked, number, a, b, low, high)
                number += 1
    return asked, number


@njit(cache=True)
def _open_between_parts(  # type: ignore[no-untyped-def]
    body, obstacles, margin, sweep, travel, poses, low, high, asked, number
):
    """The same for pairs of parts."""
    frame, half, radius, shape, pairs = body.frame, body.half, body.radius, body.shape, body.pairs
    middle = (low + high) // 2
    count = sweep.shape[0]
    moves = np.zeros((count, count))
    for first in range(count):
        for last in range(first + 1, count):
            moves[first, last] = _half_way(sweep, travel, first, last, low, middle, high)
    for pair in range(pairs.shape[0]):
        a, b = pairs[pair, 0], pairs[pair, 1]
        if frame[a] > frame[b]:
            a, b = b, a
        dx = poses[a, 0, 3] - poses[b, 0, 3]
        dy = poses[a, 1, 3] - poses[b, 1, 3]
        dz = poses[a, 2, 3] - poses[b, 2, 3]
        moved = moves[frame[a], frame[b]]
        reach = radius[a] + radius[b] + moved + margin
        if dx * dx + dy * dy + dz * dz > reach * reach:
            continue
        gap = gap_of_parts(poses, half, radius, a, b, margin, moved + margin)
        if gap < CLOSE and (shape[a] >= 0 or shape[b] >= 0):
            gap = gap_of_solids(body, obstacles, poses, a, -1 - b, margin, moved + margin)
        if gap < 0.0:
            return asked, -1
        if gap - 0.5 * margin < moved:
            asked = _noted(asked, number, a, -1 - b, low, high)
            number += 1
    return asked, number


@njit(cache=True)
def _first_of(  # type: ignore[no-untyped-def]
    chain, body, obstacles, margin, sweep, rows, travel, frames, placed, known, asked, number
):
    """The row at which the first of some open questions finds contact, or -1."""
    frame, half, radius, shape = body.frame, body.half, body.radius, body.shape
    boxes, shapes = obstacles.rows, obstacles.shape
    rel = np.empty((2, 3, 4))
    at = 0
    while at < number:
        a, b, low, high = asked[at, 0], asked[at, 1], asked[at, 2], asked[at, 3]
        at += 1
        middle = (low + high) // 2
        if b >= 0:
            first, last = 0, frame[a]
            exact = shape[a] < 0 and shapes[b] < 0
        else:
            first, last = frame[a], frame[-1 - b]
            exact = shape[a] < 0 and shape[-1 - b] < 0
        for one, other in ((low, middle), (middle, high)):
            if one == other:
                continue
            if other - one == 1:
                for row in range(one, other + 1):
                    if not known[row]:
                        _place(chain, body, rows[row], frames, placed[row])
                        known[row] = True
                if not ends_show(
                    chain.prismatic, sweep, half, boxes, a, b, first, last, rows[one], rows[other],
                    placed[one], placed[other], margin, rel,
                ) and not line_is_free(
                    chain, body, obstacles, sweep, a, b, first, last, rows[one], rows[other],
                    placed[one], placed[other], margin,
                ):  # fmt: skip
                    return one
                continue
            between = (one + other) // 2
            poses = placed[between]
            if not known[between]:
                _place(chain, body, rows[between], frames, poses)
                known[between] = True
            moved = _half_way(sweep, travel, first, last, one, between, other)
            if b >= 0:
                gap = gap_to_box(poses, half, radius, boxes, a, b, margin, moved + margin)
            else:
                gap = gap_of_parts(poses, half, radius, a, -1 - b, margin, moved + margin)
            if not exact and gap < CLOSE:
                gap = gap_of_solids(body, obstacles, poses, a, b, margin, moved + margin)
            if gap < 0.0:
                return between
            if gap - 0.5 * margin < moved:
                asked = _noted(asked, number, a, b, one, other)
                number += 1
    return -1


@njit(cache=True)
def _above(count):  # type: ignore[no-untyped-def]
    """The largest power of two below half of a number, or 1."""
    step = 1
    while 4 * step < count:
        step *= 2
    return step


@njit(cache=True)
def _touches(body, obstacles, lowest, poses, margin):  # type: ignore[no-untyped-def]
    """Whether parts at their poses (m, 3, 4) come within the margin of something."""
    frame, half, radius, shape, pairs = body.frame, body.half, body.radius, body.shape, body.pairs
    boxes, shapes = obstacles.rows, obstacles.shape
    for b in range(boxes.shape[0]):
        x, y, z, c, s = boxes[b, 0], boxes[b, 1], boxes[b, 2], boxes[b, 6], boxes[b, 7]
        hx, hy, hz = boxes[b, 3] + margin, boxes[b, 4] + margin, boxes[b, 5] + margin
        for a in range(frame.shape[0]):
            if (
                frame[a] >= lowest[b]
                and distance_squared(poses, a, x, y, z, hx, hy, hz, c, s) <= radius[a] * radius[a]
                and pose_vs_upright(poses[a], half[a], radius[a], boxes[b], margin)
                and (
                    (shape[a] < 0 and shapes[b] < 0)
                    or gap_of_solids(body, obstacles, poses, a, b, margin, margin) < 0.0
                )
            ):
                return True
    for pair in range(pairs.shape[0]):
        a, b = pairs[pair, 0], pairs[pair, 1]
        dx = poses[a, 0, 3] - poses[b, 0, 3]
        dy = poses[a, 1, 3] - poses[b, 1, 3]
        dz = poses[a, 2, 3] - poses[b, 2, 3]
        reach = radius[a] + radius[b] + margin
        if (
            dx * dx + dy * dy + dz * dz < reach * reach
            and pose_vs_pose(poses[a], half[a], poses[b], half[b], margin)
            and (
                (shape[a] < 0 and shape[b] < 0)
                or gap_of_solids(body, obstacles, poses, a, -1 - b, margin, margin) < 0.0
            )
        ):
            return True
    return False


@njit(cache=True)
def _stretch_from(low, travel, sweep):  # type: ignore[no-untyped-def]
    """The last row of the stretch that begins at a row."""
    count, n = travel.shape
    high = min(low + 1, count - 1)
    while high < count - 1:
        moved = 0.0
        for j in range(n):
            moved += sweep[n, j] * (travel[high + 1, j] - travel[low, j])
        if moved > STRETCH:
            break
        high += 1
    return high


@njit(cache=True)
def _half_way(sweep, travel, first, last, low, middle, high):  # type: ignore[no-untyped-def]
    """How far a part of frame `last` moves, as seen from frame `first`, from the middle of a
    stretch to its ends, at most."""
    before = 0.0
    after = 0.0
    for j in range(first, last):
        before += sweep[last, j] * (travel[middle, j] - travel[low, j])
        after += sweep[last, j] * (travel[high, j] - travel[middle, j])
    return max(before, after)


@njit(cache=True)
def _place(chain, body, q, frames, poses):  # type: ignore[no-untyped-def]
    """Write the poses (m, 3, 4) of all parts at a configuration (n,)."""
    forward(chain.origins, chain.prismatic, q, frames)
    place_boxes(frames, body.frame, body.pose, poses)


@njit(cache=True)
def _noted(asked, number, a, b, low, high):  # type: ignore[no-untyped-def]
    """The list of questions with one more, in a longer table where it is full."""
    if number == asked.shape[0]:
        longer = np.empty((2 * number, 4), dtype=np.int64)
        longer[:number] = asked
        asked = longer
    asked[number, 0] = a
    asked[number, 1] = b
    asked[number, 2] = low
    asked[number, 3] = high
    return asked


@njit(cache=True)
def dense(path):  # type: ignore[no-untyped-def]
    """Rows (k, n), near each other, on the lines of a path (p, n) of two points or more, and the
    line that each is on (k,)."""
    p, n = path.shape
    pieces = np.ones(p - 1, dtype=np.int64)
    for i in range(p - 1):
        longest = 0.0
        for j in range(n):
            longest = max(longest, abs(path[i + 1, j] - path[i, j]))
        pieces[i] = max(1, int(np.ceil(longest / FINE)))
    count = pieces.sum() + 1
    rows = np.empty((count, n))
    line = np.empty(count, dtype=np.int64)
    at = 0
    for i in range(p - 1):
        for piece in range(pieces[i]):
            share = piece / pieces[i]
            for j in range(n):
                rows[at, j] = path[i, j] + share * (path[i + 1, j] - path[i, j])
            line[at] = i
            at += 1
    for j in range(n):
        rows[at, j] = path[p - 1, j]
    line[at] = p - 2
    return rows, line
