"""Footprints of upright boxes, packed as in `runtime.kernels.boxes`."""

from __future__ import annotations

from runtime.world.poses import Floats


def footprints_meet(a: Floats, b: Floats, play: float) -> bool:
    """Whether the footprints of two upright boxes (8,) are less than `play` metres apart along
    every side of either (separating axes); where it is negative, whether they overlap by more."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    for box in (a, b):
        for ux, uy in ((box[6], box[7]), (-box[7], box[6])):
            reach = sum(
                r[3] * abs(ux * r[6] + uy * r[7]) + r[4] * abs(uy * r[6] - ux * r[7])
                for r in (a, b)
            )
            if abs(dx * ux + dy * uy) >= reach + play:
                return False
    return True
