"""The shortest way in the plane around boxes, by way points: A*.

A line between two way points is tested for clearance only when it is the most promising one left,
so that few of the many lines ever are (lazy A*: Cohen, Phillips & Likhachev 2014).
"""

from __future__ import annotations

import math
from heapq import heappop, heappush

import numpy as np

from runtime.kernels.compiled import njit
from runtime.kernels.plane import segment_is_clear

NOT_YET = -1


@njit(cache=True)
def shortest_way(boxes, clearance, points):  # type: ignore[no-untyped-def]
    """Numbers of the points (k, 2) along the shortest way from the second last to the last one of
    them, both included, that keeps the clearance of every box; none where there is no way."""
    count = points.shape[0]
    start = count - 2
    goal = count - 1
    before = np.full(count, NOT_YET)
    ahead = np.empty(count)
    for j in range(count):
        ahead[j] = math.hypot(points[goal, 0] - points[j, 0], points[goal, 1] - points[j, 1])
    lines = [(ahead[start], 0.0, start, start)]  # length of the whole way at least, so far, line
    while len(lines) > 0:
        _, length, i, j = heappop(lines)
        if before[j] != NOT_YET:
            continue
        x = points[j, 0]
        y = points[j, 1]
        if i != j and not segment_is_clear(boxes, clearance, points[i, 0], points[i, 1], x, y):
            continue
        before[j] = i
        if j == goal:
            break
        for k in range(count):
            if before[k] == NOT_YET:
                through = length + math.hypot(points[k, 0] - x, points[k, 1] - y)
                heappush(lines, (through + ahead[k], through, j, k))
    steps = 0
    if before[goal] != NOT_YET:
        j = goal
        steps = 1
        while j != start:
            j = before[j]
            steps += 1
    way = np.empty(steps, dtype=np.int64)
    j = goal
    for step in range(steps - 1, -1, -1):
        way[step] = j
        j = before[j]
    return way
