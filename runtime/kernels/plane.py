"""Distances in the floor plane: points and segments against upright boxes.

Boxes are packed as in `runtime.kernels.boxes`. `clearance[w]` is how far the axis of the
robot's base has to stay from box w, 0 for a box that the robot passes under or over.
"""

from __future__ import annotations

import math

import numpy as np

from runtime.kernels.compiled import njit

SLACK = 1e-9
"""Metres within which two ways to reckon a distance may differ."""


@njit(cache=True, inline="always")
def _local(box, x, y):  # type: ignore[no-untyped-def]
    dx = x - box[0]
    dy = y - box[1]
    return box[6] * dx + box[7] * dy, box[6] * dy - box[7] * dx


@njit(cache=True)
def point_distance(box, x, y):  # type: ignore[no-untyped-def]
    """Distance in the plane from a point to the footprint of a box, 0 inside."""
    lx, ly = _local(box, x, y)
    ex = max(abs(lx) - box[3], 0.0)
    ey = max(abs(ly) - box[4], 0.0)
    return math.sqrt(ex * ex + ey * ey)


@njit(cache=True)
def point_is_clear(boxes, clearance, x, y):  # type: ignore[no-untyped-def]
    """Whether a point keeps the clearance of every box."""
    for w in range(boxes.shape[0]):
        if clearance[w] > 0.0 and point_distance(boxes[w], x, y) < clearance[w]:
            return False
    return True


@njit(cache=True)
def segment_distance(box, x0, y0, x1, y1):  # type: ignore[no-untyped-def]
    """Distance in the plane from a segment to the footprint of a box, 0 where they meet."""
    ax, ay = _local(box, x0, y0)
    bx, by = _local(box, x1, y1)
    hx = box[3]
    hy = box[4]
    dx = bx - ax
    dy = by - ay
    # Clip the segment against the rectangle (slabs): a stretch left over means they meet.
    low = 0.0
    high = 1.0
    for axis in range(2):
        p = ax if axis == 0 else ay
        d = dx if axis == 0 else dy
        h = hx if axis == 0 else hy
        if abs(d) < 1e-12:
            if abs(p) > h:
                high = -1.0
        else:
            t0 = (-h - p) / d
            t1 = (h - p) / d
            low = max(low, min(t0, t1))
            high = min(high, max(t0, t1))
    if low <= high:
        return 0.0
    best = min(point_distance(box, x0, y0), point_distance(box, x1, y1))
    length = dx * dx + dy * dy
    for i in range(4):
        cx = hx if i % 2 == 0 else -hx
        cy = hy if i < 2 else -hy
        t = 0.0 if length < 1e-18 else ((cx - ax) * dx + (cy - ay) * dy) / length
        t = min(1.0, max(0.0, t))
        ex = ax + t * dx - cx
        ey = ay + t * dy - cy
        best = min(best, math.sqrt(ex * ex + ey * ey))
    return best


@njit(cache=True)
def is_far(box, clearance, x0, y0, x1, y1):  # type: ignore[no-untyped-def]
    """Whether already the circle around a box keeps the clearance from a segment: quick to say of
    most of many boxes."""
    dx = x1 - x0
    dy = y1 - y0
    ex = box[0] - x0
    ey = box[1] - y0
    length = dx * dx + dy * dy
    t = 0.0 if length < 1e-18 else min(1.0, max(0.0, (ex * dx + ey * dy) / length))
    ex -= t * dx
    ey -= t * dy
    reach = math.sqrt(box[3] * box[3] + box[4] * box[4]) + clearance + SLACK
    return ex * ex + ey * ey > reach * reach


@njit(cache=True)
def segment_is_clear(boxes, clearance, x0, y0, x1, y1):  # type: ignore[no-untyped-def]
    """Whether a segment keeps the clearance of every box."""
    for w in range(boxes.shape[0]):
        if clearance[w] <= 0.0 or is_far(boxes[w], clearance[w], x0, y0, x1, y1):
            continue
        if segment_distance(boxes[w], x0, y0, x1, y1) < clearance[w]:
            return False
    return True


CLEAR, PARTLY, BLOCKED = 0, 1, 2
"""Cells that are clear all over; those of which only the centre certainly is; and others."""


@njit(cache=True)
def grid(boxes, clearance, x0, y0, cell, rows, columns):  # type: ignore[no-untyped-def]
    """How clear the cells of a grid are: (rows, columns). Each box looks at those near it."""
    out = np.full((rows, columns), CLEAR, dtype=np.int8)
    corner = 0.7072 * cell
    for w in range(boxes.shape[0]):
        if clearance[w] <= 0.0:
            continue
        box = boxes[w]
        reach = clearance[w] + corner
        wide = abs(box[6]) * box[3] + abs(box[7]) * box[4] + reach
        deep = abs(box[7]) * box[3] + abs(box[6]) * box[4] + reach
        for i in range(
            max(0, math.floor((box[0] - wide - x0) / cell)),
            min(rows, math.ceil((box[0] + wide - x0) / cell)),
        ):
            for j in range(
                max(0, math.floor((box[1] - deep - y0) / cell)),
                min(columns, math.ceil((box[1] + deep - y0) / cell)),
            ):
                if out[i, j] == BLOCKED:
                    continue
                away = point_distance(box, x0 + (i + 0.5) * cell, y0 + (j + 0.5) * cell)
                if away < clearance[w]:
                    out[i, j] = BLOCKED
                elif away < reach:
                    out[i, j] = PARTLY
    return out


@njit(cache=True)
def connected(clear, i, j):  # type: ignore[no-untyped-def]
    """The cells (rows, columns) that hang together with cell (i, j), by their sides."""
    found = np.zeros_like(clear)
    if not clear[i, j]:
        return found
    pending = np.empty((clear.size, 2), dtype=np.int64)
    pending[0, 0] = i
    pending[0, 1] = j
    found[i, j] = True
    count = 1
    while count > 0:
        count -= 1
        a = pending[count, 0]
        b = pending[count, 1]
        for side in range(4):
            c = a + (1 if side == 0 else -1 if side == 1 else 0)
            d = b + (1 if side == 2 else -1 if side == 3 else 0)
            if (
                0 <= c < clear.shape[0]
                and 0 <= d < clear.shape[1]
                and clear[c, d]
                and not found[c, d]
            ):
                found[c, d] = True
                pending[count, 0] = c
                pending[count, 1] = d
                count += 1
    return found


NOWHERE, BESIDE, INSIDE = 0, 1, 2
"""Marks of cells: not in the room, in or beside it, and clear all over besides."""


@njit(cache=True)
def in_room(marks, x0, y0, cell, boxes, clearance, x, y):  # type: ignore[no-untyped-def]
    """Whether a position is clear and in or beside a cell of the room (`marked_cells`)."""
    i = math.floor((x - x0) / cell)
    j = math.floor((y - y0) / cell)
    if i < 0 or j < 0 or i >= marks.shape[0] or j >= marks.shape[1]:
        return False
    if marks[i, j] != BESIDE:
        return marks[i, j] == INSIDE
    return point_is_clear(boxes, clearance, x, y)


@njit(cache=True)
def marked_cells(room, clear):  # type: ignore[no-untyped-def]
    """What each cell is to a room, which is some cells of a `grid` (rows, columns): its edge runs
    through cells, so that their neighbours count as well."""
    out = np.full(room.shape, NOWHERE, dtype=np.int8)
    for i in range(room.shape[0]):
        for j in range(room.shape[1]):
            if room[i, j] or _is_beside(room, i, j):
                out[i, j] = INSIDE if clear[i, j] == CLEAR else BESIDE
    return out


@njit(cache=True)
def _is_beside(room, i, j):  # type: ignore[no-untyped-def]
    """Whether a cell or one of its neighbours is in the room."""
    for a in range(max(0, i - 1), min(room.shape[0], i + 2)):
        for b in range(max(0, j - 1), min(room.shape[1], j + 2)):
            if room[a, b]:
                return True
    return False
