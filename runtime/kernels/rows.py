"""Collision test of a motion that is given in many short steps.

As `path_collides`, but what is known of a part at one row is used at the next ones: a part whose
gap to everything is g is looked at again only when it may have moved by that much.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from runtime.kernels.arm import (
    collides,
    forward,
    free_of_boxes,
    free_of_each_other,
    free_of_solids,
    place_boxes,
    segment_collides,
    solids_free_of_each_other,
)

AHEAD = 8.0
"""For so many steps ahead, at its pace then, it is asked whether a part stays free."""

GLANCE = 8
"""Every so many rows something that touches grossly is looked for first."""


@njit(cache=True)
def first_hit(chain, body, obstacles, margin, sweep, rows):  # type: ignore[no-untyped-def]
    """The number of a row of a motion (k, n), the first where a look at some does not find one,
    after which it comes within the margin of something; or -1: then all of it keeps half the
    margin, in between rows as well."""
    count, n = rows.shape
    frame, half, radius, pairs = body.frame, body.half, body.radius, body.pairs
    shape, boxes = body.shape, obstacles.rows
    plain = not np.any(obstacles.shape >= 0)
    m = frame.shape[0]
    items = m + pairs.shape[0]
    frames = np.empty((n + 1, 3, 4))
    placed = np.empty((m, 3, 4))
    speed, until = np.empty(items), np.empty(items)
    left, step = np.zeros(items), np.zeros(items)
    moves = np.empty(n)
    for i in range(0, count, GLANCE):
        if collides(chain, body, obstacles, margin, rows[i], frames, placed):
            return i
    for i in range(count - 1):
        for j in range(n):
            moves[j] = abs(rows[i + 1, j] - rows[i, j])
        fresh = False
        ask = False
        for b in range(m):
            step[b] = 0.0
            for j in range(frame[b]):
                step[b] += sweep[frame[b], j] * moves[j]
            ask = ask or left[b] < step[b]
        for k in range(pairs.shape[0]):
            one, other = frame[pairs[k, 0]], frame[pairs[k, 1]]
            step[m + k] = 0.0
            for j in range(min(one, other), max(one, other)):
                step[m + k] += sweep[max(one, other), j] * moves[j]
            ask = ask or left[m + k] < step[m + k]
        slow = False
        if ask:
            forward(chain.origins, chain.prismatic, rows[i], frames)
            place_boxes(frames, frame, body.pose, placed)
            fresh = True
        for item in range(items):
            if left[item] < step[item] and fresh:
                ahead = AHEAD * step[item]
                # With a speed of one the time that something stays free is a distance.
                if item < m and plain and shape[item] < 0:
                    free = free_of_boxes(
                        placed[item], half[item], radius[item], boxes, margin, 1.0, ahead
                    )
                elif item < m:
                    free = free_of_solids(body, item, placed[item], obstacles, margin, 1.0, ahead)
                else:
                    a, b = pairs[item - m, 0], pairs[item - m, 1]
                    if shape[a] < 0 and shape[b] < 0:
                        free = free_of_each_other(
                            placed[a], half[a], radius[a], placed[b], half[b], radius[b],
                            margin, 1.0, ahead,
                        )  # fmt: skip
                    else:
                        free = solids_free_of_each_other(
                            body, a, placed[a], b, placed[b], margin, 1.0, ahead
                        )
                if free < 0.0:
                    return i
                left[item] = free
            if left[item] < step[item]:
                slow = True
            left[item] -= step[item]
        if slow and segment_collides(
            chain, body, obstacles, margin, sweep, rows[i], rows[i + 1] - rows[i],
            i == count - 2, frames, placed, speed, until,
        ):  # fmt: skip
            return i
    return -1
