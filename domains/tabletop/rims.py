"""Rims: walls of trays and boxes that are open above, which a hand takes from above."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.outlines import Slab
from domains.tabletop.pads import across
from runtime.world.body import Part
from runtime.world.packed import reach_along
from runtime.world.poses import Floats

if TYPE_CHECKING:
    from domains.tabletop.hand import Hand

PALM_AIR = 0.004
"""Metres left between the palm, or the tips of the fingers, and what they must not touch."""

HIGHEST = 0.001
"""Metres by which a part may end below the top and be one of its rims."""

DEPTH = 0.02
"""Metres below the top of a rim that the grasp centre is, where there is room."""

LEAST = 0.008
"""Metres that the fingers reach over a rim, at least."""


def rim_of(parts: Sequence[Part], tall: float, hand: Hand) -> float | None:
    """The height of the grasp centre at which a hand takes what rises highest of some parts, the
    tips of its fingers above all else; None where they would not reach it."""
    up = np.array([[0.0, 0.0, 1.0]])
    tops = [float(p.pose[2, 3] + reach_along(p.solid, up @ p.pose[:, :3])[0]) for p in parts]
    lower = [top for top in tops if top < tall - HIGHEST]
    deepest = max(max(lower, default=0.0) + PALM_AIR + hand.tip, tall - hand.back + PALM_AIR)
    height = max(deepest, tall - DEPTH)
    return height if height - hand.tip <= tall - LEAST else None


def outermost(
    outlines: Sequence[Floats], angles: Floats, low: Floats, high: Floats, beside: float
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Of outlines within stretches along some headings (k,) that which is furthest on the left:
    its width and its middle (k,), and whether fingers can take it: it is straight there, and
    `beside` metres are free on its inner side."""
    slabs = [Slab([outline], angles, low, high) for outline in outlines]
    width = np.array([slab.width for slab in slabs])
    middle = np.array([slab.middle for slab in slabs])
    held = np.array([across(slab) for slab in slabs])
    some = width > 0
    left = np.where(some, middle, -np.inf)
    chosen = left.argmax(axis=0)
    k = np.arange(len(angles))
    own_width, own_middle = width[chosen, k], np.where(some.any(axis=0), middle[chosen, k], 0.0)
    inner = own_middle - own_width / 2
    next_to = np.where(
        some & (np.arange(len(slabs))[:, None] != chosen), middle + width / 2, -np.inf
    ).max(axis=0)
    fits = some.any(axis=0) & held[chosen, k]
    fits &= inner - next_to >= beside
    return own_width, own_middle, fits
