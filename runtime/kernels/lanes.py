"""Lanes: how far straight back a robot drives until it can turn."""

from __future__ import annotations

import math

from runtime.kernels.arm import body_collides
from runtime.kernels.compiled import njit
from runtime.kernels.plane import point_is_clear


@njit(cache=True)
def way_back(body, placed, near, margin, step, steps, boxes, clearance, x, y, yaw):  # type: ignore[no-untyped-def]
    """Metres that a body has to be driven straight back from (x, y, yaw), in whole steps, until
    it keeps the `clearance` from every one of the boxes (w, 8); -1 where it meets one before,
    or more than `steps` are needed.

    `placed` (m, 3, 4) are its parts, and `near` the obstacles of the lane, in its own frame: it
    keeps the margin from them wherever it is tested.
    """
    c = math.cos(yaw)
    s = math.sin(yaw)
    ahead = near.rows[:, 0].copy()
    for k in range(steps):
        back = k * step
        near.rows[:, 0] = ahead + back
        if body_collides(body, placed, near, margin):
            return -1.0
        if point_is_clear(boxes, clearance, x - c * back, y - s * back):
            return back
    return -1.0
