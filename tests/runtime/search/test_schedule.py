"""In which order a subproblem is tried."""

from __future__ import annotations

from runtime.search.limits import Limits
from runtime.search.siw_r import schedule


def test_wider_searches_come_last_and_on_samples_of_middling_density() -> None:
    limits = Limits(k_max=3)
    order = list(schedule(limits, True))
    assert order[: limits.attempts] == [(attempt, 1) for attempt in range(limits.attempts)]
    wider = order[limits.attempts :]
    assert [k for _, k in wider] == [2, 3]
    assert all(0 < attempt < limits.attempts - 1 for attempt, _ in wider)
    assert list(schedule(limits, False)) == [(0, 1)]
