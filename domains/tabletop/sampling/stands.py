"""Where the base stands for a grasp: candidates by numbers, and the first that has room."""

from __future__ import annotations

import math

from runtime.kernels.compiled import njit
from runtime.kernels.plane import in_room


@njit(cache=True)
def stand(wrist, centre, shoulder, bearing, reach, turn):  # type: ignore[no-untyped-def]
    """The base pose (x, y, heading) with the shoulder's axis `reach` behind the wrist (2,) along
    a bearing, that faces the centre of the grasp (2,) up to a turn. `shoulder` (2,) is the axis
    in the base frame."""
    hx = wrist[0] - reach * math.cos(bearing)
    hy = wrist[1] - reach * math.sin(bearing)
    facing = math.atan2(centre[1] - hy, centre[0] - hx) + turn
    c = math.cos(facing)
    s = math.sin(facing)
    return hx - c * shoulder[0] + s * shoulder[1], hy - s * shoulder[0] - c * shoulder[1], facing


@njit(cache=True)
def first_with_room(  # type: ignore[no-untyped-def]
    wrist, centre, shoulder, bearings, reaches, turns,
    marks, x0, y0, cell, boxes, clearance,
):  # fmt: skip
    """The first of some base poses at which the robot can turn (`runtime.motion.room`), or four
    numbers the first of which is negative: (number, x, y, heading)."""
    for i in range(bearings.shape[0]):
        x, y, facing = stand(wrist, centre, shoulder, bearings[i], reaches[i], turns[i])
        if in_room(marks, x0, y0, cell, boxes, clearance, x, y):
            return float(i), x, y, facing
    return -1.0, 0.0, 0.0, 0.0
