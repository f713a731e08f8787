"""Which things are looked at where motions are put together."""

from __future__ import annotations

import numpy as np

from domains.tabletop.actions.schedule import near
from runtime.kernels.convex import boxes_only
from tests.runtime.reference import random_uprights


def test_whatever_reaches_into_a_rectangle_is_near(rng) -> None:
    """Long walls as well, whose middle is far away: against points all over each box."""
    inside = outside = far = 0
    grid = np.array([(a, b) for a in np.linspace(-1, 1, 41) for b in np.linspace(-1, 1, 41)])
    for _ in range(40):
        low = rng.uniform(-2, 1, 2)
        high = low + rng.uniform(0.2, 1.5, 2)
        rows = random_uprights(rng, 12, 3.0)
        rows[:6, 3] = rng.uniform(1.0, 4.0, 6)
        kept = {row.tobytes() for row in near(boxes_only(rows), low, high).rows}
        for row in rows:
            a, b = row[3] * row[6:8], row[4] * np.array([-row[7], row[6]])
            points = row[:2] + grid @ np.array([a, b])
            if np.all((points > low) & (points < high), axis=1).any():
                assert row.tobytes() in kept
                inside += 1
                far += np.any((row[:2] < low) | (row[:2] > high))
            outside += row.tobytes() not in kept
    assert inside
    assert outside
    assert far
