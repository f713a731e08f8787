"""Whether long things are also taken at their ends, from above.

Of two things that lie close side by side each is in the way of the other where a hand takes them
by their middle; what juts out past the other can still be taken at that end. That costs the
features as much as any other family of approaches, so it joins them only where at the start
something cannot be taken whatever is taken away first, and could be so.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from domains.tabletop.features.clearing import NEVER
from domains.tabletop.features.functions import arrangement
from domains.tabletop.features.swept import UNREACHABLE

if TYPE_CHECKING:
    from domains.tabletop.features.arrangement import Arrangement
    from domains.tabletop.world import TabletopWorld


def are_wanted(middles: TabletopWorld, ends: TabletopWorld) -> bool:
    """Whether things that bar each other at the start do so less where they may be taken at their
    ends. The worlds are the same scene without and with that."""
    placements = middles.initial.placements
    here = arrangement(middles, placements)  # that of the first state: it is asked for anyway
    if not _barred(here).any():
        return False
    stuck = _barred(here) & (here.costs >= NEVER)
    if not stuck.any():
        return False
    there = arrangement(ends, placements)
    return bool((stuck & (there.costs < NEVER)).any())


def _barred(here: Arrangement) -> NDArray[np.bool_]:
    """Objects that the robot could take, were it not for others (n,)."""
    fewest = np.min([picks.counts.min(axis=1) for picks in here.picks.values()], axis=0)
    found: NDArray[np.bool_] = (fewest > 0) & (fewest < UNREACHABLE) & (here.present > 0)
    return found
