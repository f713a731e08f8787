"""The features' estimate of free headings against collision-aware inverse kinematics."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.estimates import compare
from domains.tabletop.problem import TabletopProblem
from tests.tabletop.tasks import ON_RIGHT, stick, task
from tests.tabletop.test_features import random_sticks


@pytest.mark.parametrize(("seed", "count"), [(1, 2), (2, 5)])
def test_the_estimate_mostly_agrees_with_what_is_reachable(
    tmp_path, record_property, seed, count
) -> None:
    """How often it errs on larger scenes, and which way: `python -m benchmarks.estimates`."""
    rng = np.random.default_rng(seed)
    sticks = [stick(f"o{i}", x, y) for i, (x, y) in enumerate(random_sticks(rng, count))]
    the = task(tmp_path, *sticks, ON_RIGHT.format("o0"))
    counts = compare(TabletopProblem(the, 0), rng)
    total = sum(counts.values())
    optimistic, pessimistic = counts[True, False], counts[False, True]
    record_property("headings", total)
    record_property("optimistic", optimistic)
    record_property("pessimistic", pessimistic)
    assert counts[True, True]
    assert total > 20
    assert optimistic <= 0.1 * total
    assert pessimistic <= 0.15 * total
