"""Steps in the side of an object: fingers that lie over one touch only the wider part of it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from runtime.world.poses import Floats

STEP = 0.004
"""Metres by which the width has to change, along both sides, within the height of the fingers."""

TRIED = 0.002
"""Metres between the heights that are tried, ..."""

FURTHEST = 0.04
"""... and from the first one to the last."""

Section = Callable[[float, float], list[Floats]]
"""What of an object is between two heights, seen from above: outlines (n, 2)."""


def beside_steps(section: Section, height: float, pad: float, tall: float) -> float:
    """The height of a grasp centre next to a wanted one at which fingers, `pad` metres up and down
    from there, do not lie over a step of an object of some height; the wanted one where there is
    none."""
    if not _is_step(section, height, pad, tall):
        return height
    for k in range(1, round(FURTHEST / TRIED) + 1):
        for other in (height + k * TRIED, height - k * TRIED):
            inside = pad <= other <= tall - pad
            if inside and not _is_step(section, other, pad, tall):
                return other
    return height


def _is_step(section: Section, height: float, pad: float, tall: float) -> bool:
    ends = (max(0.0, height - pad), min(tall, height + pad))
    widths = [_widths(section(z, z)) for z in ends]
    return bool((np.abs(widths[0] - widths[1]) > STEP).all())


def _widths(outlines: list[Floats]) -> Floats:
    """How wide something is along x and y (2,); 0 for nothing."""
    if not outlines:
        return np.zeros(2)
    found: Floats = np.ptp(np.vstack(outlines), axis=0)
    return found
